// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/io/geodesy.hpp"

#include <GeographicLib/Ellipsoid.hpp>
#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/PolygonArea.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <numeric>

#include "thalweg/core/error.hpp"

using namespace thalweg;

namespace {

constexpr double radians = std::numbers::pi / 180;

double total_area(const Grid& grid) {
    return grid.cols * std::accumulate(grid.cell_area.begin(), grid.cell_area.end(), 0.0);
}

/// A quad of parallels and meridians as a geodesic polygon with many points along the parallels.
double polygon_area(double west, double east, double south, double north, int points,
                    const GeographicLib::Geodesic& earth = GeographicLib::Geodesic::WGS84()) {
    GeographicLib::PolygonArea ring(earth);
    for (int i = 0; i <= points; ++i) ring.AddPoint(south, west + (east - west) * i / points);
    for (int i = points; i >= 0; --i) ring.AddPoint(north, west + (east - west) * i / points);
    double perimeter = 0;
    double area = 0;
    ring.Compute(false, true, perimeter, area);
    return area;
}

}  // namespace

TEST_CASE("the cells of a geographic grid add up to the quad of parallels and meridians", "[geodesy]") {
    struct Case {
        Index rows, cols;
        double west, north, dlon, dlat;
    };
    for (const Case& c : {Case{3, 4, 10, 61, 0.5, 1}, Case{1201, 1201, 1, 43, 1 / 1200.0, 1 / 1200.0},
                          Case{100, 120, -79, 36.25, 1 / 10800.0, 1 / 10800.0}, Case{20, 10, 0, 10, 1, 1},
                          Case{5, 5, 100, -85, 0.2, 1}}) {
        const Grid grid = io::geographic_grid(c.rows, c.cols, c.north, c.dlon, c.dlat);
        const double expected =
            polygon_area(c.west, c.west + c.cols * c.dlon, c.north - c.rows * c.dlat, c.north, 40000);
        CHECK(total_area(grid) == Approx(expected).epsilon(1e-9));
    }
}

TEST_CASE("the cells of the whole earth add up to the ellipsoid", "[geodesy]") {
    CHECK(total_area(io::geographic_grid(180, 360, 90, 1, 1)) ==
          Approx(GeographicLib::Geodesic::WGS84().EllipsoidArea()).epsilon(1e-14));
    CHECK(total_area(io::geographic_grid(1, 4, 90, 90, 180)) ==
          Approx(GeographicLib::Geodesic::WGS84().EllipsoidArea()).epsilon(1e-12));
    const double radius = 3389500;
    CHECK(total_area(io::geographic_grid(18, 36, 90, 10, 10, radius, 0)) ==
          Approx(4 * std::numbers::pi * radius * radius).epsilon(1e-14));
}

TEST_CASE("cell areas agree with the authalic latitude's closed form on other ellipsoids", "[geodesy]") {
    for (const double f : {1 / 294.978698214, 1 / 298.257222101, 0.0, 0.01}) {
        const double a = 6378206.4;
        const GeographicLib::Ellipsoid earth(a, f);
        const Grid grid = io::geographic_grid(8, 1, 80, 1, 20, a, f);
        for (int row = 0; row < 8; ++row) {
            const auto xi = [&](double latitude) { return std::sin(earth.AuthalicLatitude(latitude) * radians); };
            const double north = 80 - 20 * row;
            const double expected = earth.Area() / (4 * std::numbers::pi) * radians * (xi(north) - xi(north - 20));
            CHECK(grid.cell_area[row] == Approx(expected).epsilon(1e-12));
        }
    }
}

TEST_CASE("tiny cells lose no digits: a row of them adds up to one large cell", "[geodesy]") {
    const double size = 1e-5;
    const Grid fine = io::geographic_grid(1000, 1, 40 + 1000 * size, size, size);
    const Grid coarse = io::geographic_grid(1, 1, 40 + 1000 * size, size, 1000 * size);
    CHECK(total_area(fine) == Approx(coarse.cell_area[0]).epsilon(1e-9));
    // Neighbouring rows differ by tan(latitude)·size, not by rounding noise.
    const double slope = (fine.cell_area[501] - fine.cell_area[500]) / fine.cell_area[500];
    CHECK(slope == Approx(std::tan(40.005 * radians) * size * radians).epsilon(0.02));
}

TEST_CASE("lengths between cell centres are geodesics", "[geodesy]") {
    SECTION("a quarter meridian is 10 001 965.729 m long") {
        const Grid grid = io::geographic_grid(90 * 4, 1, 90, 1, 0.25);
        double sum = std::accumulate(grid.north_south.begin(), grid.north_south.end(), 0.0);
        GeographicLib::Ellipsoid earth = GeographicLib::Ellipsoid::WGS84();
        CHECK(earth.QuarterMeridian() == Approx(10001965.729).epsilon(1e-10));
        sum += earth.QuarterMeridian() - earth.MeridianDistance(89.875) + earth.MeridianDistance(0.125);
        CHECK(sum == Approx(10001965.729).epsilon(1e-10));
    }
    SECTION("on a sphere they are great circles") {
        const double radius = 6371000;
        const Grid grid = io::geographic_grid(10, 3, 70, 2, 3, radius, 0);
        const auto circle = [&](double lat_a, double lat_b, double dlon) {
            const double s =
                std::pow(std::sin((lat_b - lat_a) * radians / 2), 2) +
                std::cos(lat_a * radians) * std::cos(lat_b * radians) * std::pow(std::sin(dlon * radians / 2), 2);
            return 2 * radius * std::asin(std::sqrt(s));
        };
        for (int row = 0; row < 10; ++row) {
            const double here = 70 - 3 * (row + 0.5);
            CHECK(grid.east_west[row] == Approx(circle(here, here, 2)).epsilon(1e-12));
            if (row == 9) break;
            CHECK(grid.north_south[row] == Approx(circle(here, here - 3, 0)).epsilon(1e-12));
            CHECK(grid.diagonal[row] == Approx(circle(here, here - 3, 2)).epsilon(1e-12));
        }
    }
    SECTION("on the equator a degree is a/57.3") {
        const Grid grid = io::geographic_grid(1, 2, 0.5, 1, 1);
        CHECK(grid.east_west[0] == Approx(6378137 * radians).epsilon(1e-13));
    }
}

TEST_CASE("grids that cannot lie on the earth are refused", "[geodesy]") {
    CHECK_THROWS_AS(io::geographic_grid(10, 10, 91, 1, 1), Error);
    CHECK_THROWS_AS(io::geographic_grid(10, 10, -85, 1, 1), Error);
    CHECK_THROWS_AS(io::geographic_grid(10, 400, 50, 1, 1), Error);
    CHECK_THROWS_AS(io::geographic_grid(10, 10, 50, 0, 1), Error);
    CHECK_THROWS_AS(io::geographic_grid(10, 10, 50, 1, NAN), Error);
    CHECK_THROWS_AS(io::geographic_grid(0, 10, 50, 1, 1), Error);
    CHECK_THROWS_AS(io::geographic_grid(70000, 70000, 50, 1e-3, 1e-3), Error);
}

TEST_CASE("the area of a ring is that of its geodesics, whichever way it runs", "[geodesy]") {
    const double octant = GeographicLib::Geodesic::WGS84().EllipsoidArea() / 8;
    CHECK(io::geodesic_area({{0, 0}, {90, 0}, {90, 90}}) == Approx(octant).epsilon(1e-12));
    CHECK(io::geodesic_area({{90, 90}, {90, 0}, {0, 0}}) == Approx(octant).epsilon(1e-12));
    CHECK(io::geodesic_area({{359.5, 10}, {0.5, 10}, {0.5, 11}, {359.5, 11}}) ==
          Approx(io::geodesic_area({{-0.5, 10}, {0.5, 10}, {0.5, 11}, {-0.5, 11}})).epsilon(1e-12));
}

TEST_CASE("a local plane keeps areas, has its origin at its centre and can be left again", "[geodesy]") {
    const io::LocalPlane plane{.longitude_deg = -78.65, .latitude_deg = 36.6};
    const std::vector<Point> special = io::to_plane(plane, {{-78.65, 36.6}, {-78.65, 36.7}, {-78.55, 36.6}});
    CHECK(std::hypot(special[0].x, special[0].y) < 1e-6);
    CHECK(std::abs(special[1].x) < 1e-6);
    CHECK(special[1].y == Approx(11097).epsilon(1e-3));
    CHECK(special[2].x == Approx(8949).epsilon(1e-3));

    std::vector<Point> ring;
    for (int i = 0; i < 4000; ++i) {
        const double angle = 2 * std::numbers::pi * i / 4000;
        ring.push_back({-78.65 + 0.3 * std::cos(angle), 36.6 + 0.2 * std::sin(angle)});
    }
    const std::vector<Point> flat = io::to_plane(plane, ring);
    double doubled = 0;
    for (std::size_t i = 0; i < flat.size(); ++i) {
        const Point& a = flat[i];
        const Point& b = flat[(i + 1) % flat.size()];
        doubled += a.x * b.y - b.x * a.y;
    }
    CHECK(doubled / 2 == Approx(io::geodesic_area(ring)).epsilon(1e-7));

    const std::vector<Point> back = io::from_plane(plane, flat);
    for (std::size_t i = 0; i < ring.size(); i += 100) {
        CHECK(back[i].x == Approx(ring[i].x).margin(1e-10));
        CHECK(back[i].y == Approx(ring[i].y).margin(1e-10));
    }
    CHECK(plane.crs_wkt().find("Lambert_Azimuthal_Equal_Area") != std::string::npos);
    CHECK(io::to_plane(plane, {}).empty());
}
