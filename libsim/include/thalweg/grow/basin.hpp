// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "thalweg/core/error.hpp"
#include "thalweg/core/point.hpp"

namespace thalweg::grow {

/// Where a network grows: a basin and its main stream, from which all others branch.
struct Basin {
    Polygon outline;                ///< any simple polygon, either orientation, m
    Point outlet;                   ///< lower end of the trunk, on the outline, m
    Point source;                   ///< upper end of the trunk, inside, m
    double base_level_m = 0;        ///< elevation of the outlet
    std::vector<Point> bends = {};  ///< of the trunk, from the outlet to the source, inside, m; none: it is straight
};

/// What is wrong with a trunk, and at which of its places (`trunk_of`).
enum class TrunkFault : std::uint8_t {
    piece_leaves,   ///< the piece from that place on leaves the basin
    piece_crosses,  ///< the piece from that place on crosses an earlier one
    bend            ///< it bends there too sharply, or where it leaves a tributary no room
};

struct TrunkError : Error {
    TrunkError(TrunkFault fault_found, std::size_t at, const std::string& message)
        : Error(message), fault(fault_found), place(at) {}
    TrunkFault fault;
    std::size_t place;
};

/// The trunk from the outlet over its bends to the source.
std::vector<Point> trunk_of(const Basin&);

/// The point of a closed outline that is nearest to `p`. No two neighbouring corners may be the same.
Point nearest_on_outline(const Polygon& outline, const Point& p);

/// The basin with its outline counter-clockwise and without repeated corners, and the outlet put onto the outline
/// (where it may lie off by a millionth of the basin's size). Throws Error for an outline that is not a simple polygon
/// of positive area, an outlet off it, a source that is not inside, a trunk that leaves the basin, crosses itself or
/// turns back by more than 120° at once, or a base level that is not finite.
Basin checked_basin(const Basin&);

}  // namespace thalweg::grow
