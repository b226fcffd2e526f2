// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>

namespace thalweg {

/// Number of a node, link or cell. 32 bits halve the memory traffic of every algorithm; sizes are checked on reading.
using Index = std::uint32_t;

/// "No such node": the receiver of an outlet, the downstream link of a river mouth.
inline constexpr Index none = std::numeric_limits<Index>::max();

}  // namespace thalweg
