// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include "thalweg/core/error.hpp"
#include "thalweg/core/index.hpp"

namespace thalweg::terrain {

/// Throws Error unless there is one value of each array per node.
inline void check_sizes(Index nodes, std::size_t first, std::size_t second) {
    if (first == nodes && second == nodes) return;
    throw Error(
        fmt::format("a terrain of {} nodes needs as many values of each kind, not {} and {}", nodes, first, second));
}

}  // namespace thalweg::terrain
