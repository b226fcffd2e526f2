// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/surface/hillshade.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace thalweg;

namespace {

/// A plane that rises by `east` and `north` metres per metre.
Raster plane(double east, double north) {
    Raster r{plane_grid(5, 6, 30, 20), {}, {}};
    for (Index node = 0; node < r.grid.size(); ++node) {
        r.values.push_back(100 + east * 30 * r.grid.col(node) - north * 20 * r.grid.row(node));
    }
    return r;
}

constexpr double half_root = 0.70710678118654752;

}  // namespace

TEST_CASE("A plane throws back the cosine between its normal and a sun in the north-west") {
    const Index middle = 2 * 6 + 3;
    CHECK(surface::hillshade(plane(0, 0))[middle] == Approx(half_root));
    // Slopes of 45° that face the sun and turn away from it: light falls square on the one, along the other.
    CHECK(surface::hillshade(plane(half_root, -half_root))[middle] == Approx(1));
    CHECK(surface::hillshade(plane(-half_root, half_root))[middle] == Approx(0).margin(1e-12));
    CHECK(surface::hillshade(plane(-2, 2))[middle] == 0);  // in its own shadow
    // Rising to the north-east: the sun is seen along the slope, only the steepness dims it.
    CHECK(surface::hillshade(plane(1, 1))[middle] == Approx(half_root / std::sqrt(3)));
}

TEST_CASE("Holes stay holes, and what lies beside one is lit as if the hole were level with it") {
    Raster r = plane(0, 0);
    r.values[8] = std::numeric_limits<double>::quiet_NaN();
    const auto shade = surface::hillshade(r);
    for (Index node = 0; node < r.grid.size(); ++node) {
        if (node == 8) {
            CHECK(std::isnan(shade[node]));
        } else {
            CHECK(shade[node] == Approx(half_root));
        }
    }
    Raster row{plane_grid(1, 4, 10, 10), {}, {1, 2, 3, 4}};
    CHECK(surface::hillshade(row).size() == 4);
}
