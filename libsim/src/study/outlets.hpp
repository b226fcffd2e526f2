// SPDX-License-Identifier: GPL-3.0-or-later
// Private: which nodes of a domain's rim are outlets.
#pragma once

#include <span>
#include <vector>

#include "thalweg/core/point.hpp"
#include "thalweg/core/topology.hpp"
#include "thalweg/study/parameters.hpp"

namespace thalweg::study {

/// What is known of a domain where its outlets are chosen.
struct Rim {
    std::vector<Boundary> boundary;  ///< `open` on the rim, `interior` inside
    std::vector<Polygon> rings;      ///< outer ring counter-clockwise, holes clockwise, on the plane
    Index dem_outlet = none;         ///< node of a DEM's own outlet, if there is one
};

/// Side that the outline faces along its edge a → b: the sector that holds the normal pointing out of the domain.
Side facing(const Point& a, const Point& b);

/// `base_level` at the outlets, `interior` elsewhere. A node of the rim lies on the sides of the outline's edges
/// nearest to it, a corner thus on two. Throws Error where the rule finds no outlet.
std::vector<Boundary> choose_outlets(const Outlets&, const Rim&, std::span<const Point> plane_m,
                                     std::span<const double> uplift);

}  // namespace thalweg::study
