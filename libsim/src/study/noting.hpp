// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "thalweg/study/analyze.hpp"

namespace thalweg::study {

/// The same messages, whose warnings are put on a list as well, for they stand in a summary's notes too. The list must
/// outlive what is returned.
inline Messages noting(Messages messages, std::vector<std::string>& notes) {
    messages.warning = [warning = messages.warning, &notes](const std::string& text) {
        notes.push_back(text);
        warning(text);
    };
    return messages;
}

/// The same messages, whose warnings and reports say first what they are about.
inline Messages about(const std::string& what, Messages messages) {
    const auto saying = [&what](const auto& say) {
        return [what, say](const std::string& text) { say(what + ": " + text); };
    };
    messages.warning = saying(messages.warning);
    messages.report = saying(messages.report);
    return messages;
}

}  // namespace thalweg::study
