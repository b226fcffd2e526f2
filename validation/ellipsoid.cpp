// SPDX-License-Identifier: GPL-3.0-or-later
// The same terrain measured on degrees and on an equal-area plane. Lambert's azimuthal plane about the terrain's middle
// keeps areas exactly and, within 20 km, lengths to 5e-6, so every measure must agree but for the cells that happen to
// be taken. Each bound below is derived from the cells (how it is said beside it), none from the result.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <numbers>

#include "series.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/core/statistics.hpp"
#include "thalweg/io/geodesy.hpp"
#include "thalweg/io/polygonize.hpp"
#include "thalweg/io/raster_file.hpp"
#include "thalweg/study/measure.hpp"
#include "thalweg/study/outlet.hpp"

using namespace thalweg;
using namespace thalweg::validation;

namespace {

constexpr double radians = std::numbers::pi / 180, nodata = std::numeric_limits<double>::quiet_NaN();

/// Where a terrain is cut into cells: of `degrees`, or of as many metres on the plane as such a cell has in the middle.
struct Frame {
    io::LocalPlane middle;
    double degrees;
    Index rows, cols;
    Point shift = {0, 0};  ///< of the cells, in cells
};

Raster on_degrees(const Frame& f) {
    Raster raster;
    const double west = f.middle.longitude_deg + (f.shift.x - 0.5 * f.cols) * f.degrees;
    const double north = f.middle.latitude_deg + (f.shift.y + 0.5 * f.rows) * f.degrees;
    raster.grid = io::geographic_grid(f.rows, f.cols, north, f.degrees, f.degrees);
    raster.placement = {.west = west,
                        .north = north,
                        .cell_width = f.degrees,
                        .cell_height = f.degrees,
                        .crs_wkt = "",
                        .geographic = true};
    raster.values.assign(raster.grid.size(), nodata);
    return raster;
}

Raster on_plane(const Frame& f) {
    const Grid there = io::geographic_grid(3, 1, f.middle.latitude_deg + 1.5 * f.degrees, f.degrees, f.degrees);
    const double width = there.east_west[1], height = 0.5 * (there.north_south[0] + there.north_south[1]);
    Raster raster;
    raster.grid = plane_grid(f.rows, f.cols, width, height);
    raster.placement = {.west = (f.shift.x - 0.5 * f.cols) * width,
                        .north = (f.shift.y + 0.5 * f.rows) * height,
                        .cell_width = width,
                        .cell_height = height,
                        .crs_wkt = f.middle.crs_wkt(),
                        .geographic = false};
    raster.values.assign(raster.grid.size(), nodata);
    return raster;
}

std::vector<Point> centers(const Raster& raster) {
    std::vector<Point> points;
    for (Index cell = 0; cell < raster.grid.size(); ++cell) {
        points.push_back(raster.placement.center(raster.grid.row(cell), raster.grid.col(cell)));
    }
    return points;
}

/// Heights of height(x, y) on the plane about the frame's middle.
template <class Height>
void raise(Raster& raster, const Frame& f, Height height) {
    std::vector<Point> at = centers(raster);
    if (raster.placement.geographic) at = io::to_plane(f.middle, at);
    for (Index cell = 0; cell < raster.grid.size(); ++cell) raster.values[cell] = height(at[cell].x, at[cell].y);
}

template <class Height>
std::array<Raster, 2> both(const Frame& f, Height height) {
    std::array<Raster, 2> rasters{on_degrees(f), on_plane(f)};
    for (Raster& raster : rasters) raise(raster, f, height);
    return rasters;
}

double diagonal_m(const Raster& raster) { return raster.grid.diagonal[raster.grid.rows / 2]; }

study::MeasureOptions whole(double channel_area_m2) {
    study::MeasureOptions options;
    options.channel_area_m2 = channel_area_m2;
    options.edge_basins = terrain::EdgeBasins::keep;
    return options;
}

/// A solid of revolution, h = 1 − r^power: its relative area above h is (1 − h)^(2/power).
struct Dome {
    const char* name;
    double power, integral;
};

double out_of_bound(double off, double bound) { return std::abs(off) / bound; }

// ---- A valley whose profile follows S = ks·A^(−θ), A = width × distance from the divide.

constexpr double valley_width_m = 600, valley_length_m = 20000, side_slope = 0.15, theta = 0.45, reference_area = 1e6;
constexpr double valley_relief_m = 600, threshold_m2 = valley_width_m * 2000;

/// ∫ (A0/A)^θ ds between two distances from the divide.
double chi_between(double from, double to) {
    const double p = 1 - theta;
    return std::pow(reference_area / valley_width_m, theta) * (std::pow(to, p) - std::pow(from, p)) / p;
}

double valley_ks() { return valley_relief_m / chi_between(0, valley_length_m) * std::pow(reference_area, theta); }

double valley_height(double x, double y, double azimuth_deg) {
    const double a = azimuth_deg * radians;
    const double s = x * std::sin(a) + y * std::cos(a) + 0.5 * valley_length_m;
    const double t = x * std::cos(a) - y * std::sin(a);
    if (s < 0 || s > valley_length_m || std::abs(t) > 0.5 * valley_width_m) return nodata;
    return valley_ks() * std::pow(reference_area, -theta) * chi_between(s, valley_length_m) + side_slope * std::abs(t);
}

/// Length of the shortest way over cells along a unit of a straight line.
double lattice_factor(const Raster& raster, double azimuth_deg) {
    const double dx = raster.grid.east_west[raster.grid.rows / 2], dy = raster.grid.north_south[raster.grid.rows / 2];
    const double across = std::abs(std::sin(azimuth_deg * radians)) / dx;
    const double down = std::abs(std::cos(azimuth_deg * radians)) / dy;
    const double diagonal = std::min(across, down);
    return diagonal * std::hypot(dx, dy) + (across - diagonal) * dx + (down - diagonal) * dy;
}

struct Trunk {
    double length_m = 0, chi_m = 0, drop_m = 0, ksn = 0, area_m2 = 0;
};

/// From the node of largest χ down to its base.
Trunk trunk_of(const study::RasterMeasurement& m) {
    const auto& chi = m.statistics.chi;
    const auto head = static_cast<Index>(std::ranges::max_element(chi.chi_m) - chi.chi_m.begin());
    Trunk trunk{.chi_m = chi.chi_m[head], .ksn = chi.ksn_median};
    Index row = head;
    for (; chi.profile.below[row] != none; row = chi.profile.below[row]) trunk.length_m += chi.profile.length_m[row];
    trunk.drop_m = chi.profile.elevation_m[head] - chi.profile.elevation_m[row];
    trunk.area_m2 = chi.profile.area_m2[row];
    return trunk;
}

// ---- Real terrain.

/// Heights between the cells of a geographic DEM, bilinear; NaN beyond the middles of its outer cells and at voids.
double height_at(const Raster& dem, Point lon_lat) {
    const double c = (lon_lat.x - dem.placement.west) / dem.placement.cell_width - 0.5;
    const double r = (dem.placement.north - lon_lat.y) / dem.placement.cell_height - 0.5;
    if (!(c >= 0) || !(r >= 0) || c >= dem.grid.cols - 1.0 || r >= dem.grid.rows - 1.0) return nodata;
    const auto col = static_cast<Index>(c), row = static_cast<Index>(r);
    const double u = c - col, v = r - row;
    const double* z = dem.values.data() + std::size_t{row} * dem.grid.cols + col;
    return (1 - v) * ((1 - u) * z[0] + u * z[1]) + v * ((1 - u) * z[dem.grid.cols] + u * z[dem.grid.cols + 1]);
}

void resample(Raster& raster, const Frame& f, const Raster& dem) {
    std::vector<Point> at = centers(raster);
    if (!raster.placement.geographic) at = io::from_plane(f.middle, at);
    for (Index cell = 0; cell < raster.grid.size(); ++cell) raster.values[cell] = height_at(dem, at[cell]);
}

/// In the middle of the largest river's longest piece without tributaries: small changes of the cells do not move an
/// outlet there across a junction.
Point outlet_in_a_long_link(const Raster& dem, const study::RasterMeasurement& m) {
    const auto& network = m.statistics.network;
    Index best = none;
    for (Index link = 0; link < network.size(); ++link) {
        const bool is_long = network.nodes_of(link).size() >= 16;
        if (is_long && (best == none || network.area_m2[link] > network.area_m2[best])) best = link;
    }
    REQUIRE(best != none);
    const auto nodes = network.nodes_of(best);
    const Index node = nodes[nodes.size() / 2];
    return dem.placement.center(dem.grid.row(node), dem.grid.col(node));
}

using Numbers = std::map<std::string, double>;

Numbers measured(const Raster& raster, Point outlet, double channel_area_m2) {
    study::MeasureOptions options = whole(channel_area_m2);
    const auto cut = study::catchment_above(raster, {.at = outlet, .snap_m = 2 * diagonal_m(raster)}, options);
    options.catchment_outlet = cut.outlet;
    const auto m = study::measure_raster(cut.raster, options);
    const auto& s = m.statistics;
    double drop = 0, length = 0;
    for (Index link = 0; link < s.network.size(); ++link) {
        drop += s.network.drop_m[link];
        length += s.network.length_m[link];
    }
    return {{"area", m.area_m2},
            {"mean height", s.hypsometry.mean_m},
            {"hypsometric integral", s.hypsometry.integral},
            {"length of channels", s.channels.total_length_m},
            {"drainage density", s.channels.drainage_density_per_m},
            {"slope of channels", drop / length},
            {"longest chi", *std::ranges::max_element(s.chi.chi_m)},
            {"ksn", s.chi.ksn_median},
            {"theta", s.slope_area.theta.value},
            {"slope at 10 km2", s.slope_area.ks.value * std::pow(1e7, -s.slope_area.theta.value)}};
}

struct RealDem {
    std::filesystem::path path;
    double channel_area_m2;
};

std::vector<RealDem> real_dems() {
    std::vector<RealDem> dems{{THALWEG_SOURCE_DIR "/validation/data/jacksboro.tif", 4e5}};
    const char* folder = std::getenv("THALWEG_DEM_DIR");
    for (const char* file : {"zion_srtm_3arcsec.tif", "front_range_srtmgl3.asc"}) {
        const std::filesystem::path path = std::filesystem::path(folder ? folder : "") / file;
        if (folder != nullptr && std::filesystem::exists(path)) dems.push_back({path, 4e5});
    }
    return dems;
}

/// Area of rings of cells in degrees by GeographicLib, with a vertex at every cell, and what geodesics leave out at
/// most: between two points L apart on a parallel a geodesic bulges by L³·tan φ/(12·R) towards the pole.
struct Enclosed {
    double area_m2 = 0, uncertain_m2 = 0, plane_m2 = 0;
};

Polygon with_cell_vertices(const Polygon& ring, double cell_width) {
    Polygon fine;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Point a = ring[i], b = ring[(i + 1) % ring.size()];
        const int pieces = std::max(1, static_cast<int>(std::lround(std::abs(b.x - a.x) / cell_width)));
        for (int k = 0; k < pieces; ++k)
            fine.push_back({a.x + (b.x - a.x) * k / pieces, a.y + (b.y - a.y) * k / pieces});
    }
    return fine;
}

double shoelace(const std::vector<Point>& ring) {
    double doubled = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Point &a = ring[i], &b = ring[(i + 1) % ring.size()];
        doubled += (a.x - ring[0].x) * (b.y - ring[0].y) - (b.x - ring[0].x) * (a.y - ring[0].y);
    }
    return std::abs(doubled) / 2;
}

Enclosed enclosed(const MultiPolygon& parts, const Raster& raster, const io::LocalPlane& plane) {
    Enclosed sum;
    const auto add = [&](const Polygon& ring, double sign) {
        const Polygon fine = with_cell_vertices(ring, raster.placement.cell_width);
        sum.area_m2 += sign * io::geodesic_area(fine);
        sum.plane_m2 += sign * shoelace(io::to_plane(plane, fine));
        for (std::size_t i = 0; i < fine.size(); ++i) {
            const Point &a = fine[i], &b = fine[(i + 1) % fine.size()];
            if (a.y != b.y) continue;
            const double length = std::abs(b.x - a.x) * radians * 6.4e6 * std::cos(a.y * radians);
            sum.uncertain_m2 += std::pow(length, 3) * std::abs(std::tan(a.y * radians)) / (12 * 6.35e6);
        }
    };
    for (const PolygonPart& part : parts) {
        add(part.outer, 1);
        for (const Polygon& hole : part.holes) add(hole, -1);
    }
    return sum;
}

}  // namespace

TEST_CASE("Domes on degrees have the area and hypsometry that they have on an equal-area plane", "[ellipsoid]") {
    constexpr double radius = 15000, height = 1000;
    Categories over_bound;
    for (const Dome& dome : {Dome{"cone", 1, 1.0 / 3}, Dome{"paraboloid", 2, 0.5}}) {
        for (const double latitude : {0.0, 45.0, -60.0, 75.0}) {
            const double degrees = 0.001;
            const auto cells = [&](double metres_per_degree) {
                return 2 * static_cast<Index>(1.05 * radius / (metres_per_degree * degrees)) + 1;
            };
            const Frame f{.middle = {10, latitude},
                          .degrees = degrees,
                          .rows = cells(110500),
                          .cols = cells(111000 * std::cos(latitude * radians))};
            const auto surface = [&](double x, double y) {
                const double r = std::hypot(x, y) / radius;
                return r > 1 ? nodata : height * (1 - std::pow(r, dome.power));
            };
            for (const Raster& raster : both(f, surface)) {
                const auto m = study::measure_raster(raster, whole(1e8));
                const double area = std::numbers::pi * radius * radius;
                const double cell = raster.grid.cell_area[f.rows / 2];
                // A cell on the rim counts whole or not at all: off by a share that is even between −1/2 and 1/2.
                const double rim_cells = 8 * radius / std::sqrt(cell);
                const double area_bound = 4 * cell * std::sqrt(rim_cells / 12);
                // The lowest cell lies within a diagonal of the rim; the mean goes with the area; the rest is the
                // midpoint rule's.
                const double lowest = 1 - std::pow(1 - diagonal_m(raster) / radius, dome.power);
                const double integral_bound = (1 - dome.integral) * lowest + dome.integral * area_bound / area +
                                              std::pow(diagonal_m(raster) / radius, 2);
                const std::string on = raster.placement.geographic ? "degrees" : "plane";
                fmt::print("{:10} at {:3.0f}, on {:7}: area {:+.1e} off (bound {:.1e}), integral {:+.1e} ({:.1e})\n",
                           dome.name, latitude, on, m.area_m2 / area - 1, area_bound / area,
                           m.statistics.hypsometry.integral - dome.integral, integral_bound);
                CHECK(std::abs(m.area_m2 - area) < area_bound);
                CHECK(std::abs(m.statistics.hypsometry.integral - dome.integral) < integral_bound);
                over_bound.add(fmt::format("{} area, {}", dome.name, on), out_of_bound(m.area_m2 - area, area_bound));
                over_bound.add(fmt::format("{} integral, {}", dome.name, on),
                               out_of_bound(m.statistics.hypsometry.integral - dome.integral, integral_bound));
            }
        }
    }
    write_series("ellipsoid_domes", over_bound);
}

TEST_CASE("A valley on degrees has the length, chi and ksn that it has on an equal-area plane", "[ellipsoid]") {
    Categories over_bound;
    for (const double latitude : {45.0, -60.0}) {
        for (const double azimuth : {0.0, 90.0, 50.0}) {
            const double degrees = 0.0005;
            // Odd numbers: an axis between two rows of cells would be two rivers.
            const auto cells = [&](double metres_per_degree) {
                return 2 * static_cast<Index>(0.55 * valley_length_m / (metres_per_degree * degrees)) + 1;
            };
            const Frame f{.middle = {-70, latitude},
                          .degrees = degrees,
                          .rows = cells(110900),
                          .cols = cells(111000 * std::cos(latitude * radians))};
            std::array<Trunk, 2> trunks;
            const auto rasters = both(f, [&](double x, double y) { return valley_height(x, y, azimuth); });
            for (int i = 0; i < 2; ++i) {
                const Raster& raster = rasters[i];
                const auto m = study::measure_raster(raster, whole(threshold_m2));
                const Trunk trunk = trunks[i] = trunk_of(m);
                const double factor = lattice_factor(raster, azimuth), diagonal = diagonal_m(raster);
                // Water from the sides reaches the axis at most so far up or down the valley: D8 turns it by half the
                // widest angle between two neighbours, and the valley's own slope turns it too.
                const double head = threshold_m2 / valley_width_m;
                const double dx = raster.grid.east_west[f.rows / 2], dy = raster.grid.north_south[f.rows / 2];
                const double turn = std::max(std::atan2(dx, dy), std::atan2(dy, dx)) / 2;
                const double slope_there = valley_ks() * std::pow(threshold_m2, -theta);
                const double offset =
                    0.5 * valley_width_m * std::tan(turn + std::atan(slope_there / side_slope)) + 2 * diagonal;
                const double least = factor * chi_between(head + offset, valley_length_m + offset) -
                                     std::pow(reference_area / threshold_m2, theta) * diagonal;
                const double most = factor * chi_between(head - offset, valley_length_m - offset) +
                                    std::pow(reference_area / threshold_m2, theta) * diagonal;
                // Heights along the axis: a cell beside it stands up to half a diagonal up the side.
                const double steepness = trunk.drop_m / trunk.chi_m * std::pow(reference_area, theta) / valley_ks();
                const double uneven = side_slope * diagonal / trunk.drop_m;
                const double area_off = std::pow(1 + offset / head, theta);
                fmt::print(
                    "valley at {:3.0f}, azimuth {:2.0f}, {:7}: length {:.0f} (line {:.0f} × {:.4f}), chi {:.1f} "
                    "({:.1f} to "
                    "{:.1f}), ksn·factor/ks {:.4f}, median {:.4f}\n",
                    latitude, azimuth, raster.placement.geographic ? "degrees" : "plane", trunk.length_m,
                    valley_length_m - head, factor, trunk.chi_m, least, most, steepness * factor,
                    trunk.ksn * factor / valley_ks());
                CHECK(std::abs(trunk.length_m - factor * (valley_length_m - head)) < factor * offset + 2 * diagonal);
                CHECK(trunk.chi_m > least);
                CHECK(trunk.chi_m < most);
                CHECK(steepness * factor < area_off * (1 + uneven));
                CHECK(steepness * factor > (1 - uneven) / area_off);
            }
            // The same lattice but for the meridians' convergence: it turns the valley's ends by so much, which costs
            // that share of its length in steps aside, and a cell at either end.
            const double convergence = std::abs(std::sin(latitude * radians)) * 0.5 * f.cols * degrees * radians;
            const double bound = 2 * convergence + 3 * diagonal_m(rasters[1]) / (valley_length_m - 2000);
            // χ weighs the upper cells up to (length/head)^θ times as much.
            const double upper = std::pow(valley_length_m * valley_width_m / threshold_m2, theta);
            const double length_off = trunks[0].length_m / trunks[1].length_m - 1;
            const double chi_off = trunks[0].chi_m / trunks[1].chi_m - 1;
            fmt::print("    degrees over plane: length {:+.1e} (bound {:.1e}), chi {:+.1e}\n", length_off, bound,
                       chi_off);
            CHECK(std::abs(length_off) < bound);
            CHECK(std::abs(chi_off) < upper * bound);
            CHECK(std::abs(trunks[0].area_m2 / trunks[1].area_m2 - 1) < bound);
            const std::string name = fmt::format("at {:.0f}, azimuth {:.0f}", latitude, azimuth);
            over_bound.add(name, out_of_bound(length_off, bound));
            over_bound.add(name, out_of_bound(chi_off, upper * bound));
        }
    }
    write_series("ellipsoid_valleys", over_bound);
}

TEST_CASE("Basins of a geographic DEM are as large as the geodesic polygons round their cells", "[ellipsoid]") {
    for (const RealDem& dem : real_dems()) {
        INFO(dem.path);
        const Raster raster = io::read_raster(dem.path).raster;
        study::MeasureOptions options;
        options.channel_area_m2 = dem.channel_area_m2;
        const auto m = study::measure_raster(raster, options);
        const auto& s = m.statistics;
        const Point middle = raster.placement.center(raster.grid.rows / 2, raster.grid.cols / 2);
        const auto outlines = io::cell_outlines(raster, s.basin_of, static_cast<Index>(s.basins.size()));
        double worst = 0, worst_on_plane = 0;
        REQUIRE(s.basins.size() > 3);
        for (std::size_t b = 0; b < s.basins.size(); ++b) {
            const Enclosed polygon = enclosed(outlines[b], raster, {middle.x, middle.y});
            const double area = s.basins[b].basin.area_m2;
            // Sums of rounding besides: GeographicLib's ring areas are good to 0.1 m² or so on the whole earth.
            const double bound = polygon.uncertain_m2 + 0.2;
            CHECK(std::abs(area - polygon.area_m2) < bound);
            // On the plane the chord of a parallel leaves out as much again, its curve being that of a cone.
            CHECK(std::abs(area - polygon.plane_m2) < 2 * bound);
            worst = std::max(worst, std::abs(area / polygon.area_m2 - 1));
            worst_on_plane = std::max(worst_on_plane, std::abs(area / polygon.plane_m2 - 1));
        }
        fmt::print("{}: {} basins, areas off by {:.1e} of the geodesic polygons', {:.1e} of the equal-area plane's\n",
                   dem.path.filename().string(), s.basins.size(), worst, worst_on_plane);
    }
}

TEST_CASE("Rivers of a geographic DEM are as long as between the same places on an equal-area plane", "[ellipsoid]") {
    for (const RealDem& dem : real_dems()) {
        INFO(dem.path);
        const Raster raster = io::read_raster(dem.path).raster;
        const auto profile = study::measure_raster(raster, whole(dem.channel_area_m2)).statistics.chi.profile;
        const Point middle = raster.placement.center(raster.grid.rows / 2, raster.grid.cols / 2);
        const auto place = [&](Index node) {
            return raster.placement.center(raster.grid.row(node), raster.grid.col(node));
        };
        std::vector<Point> ends;
        for (Index i = 0; i < profile.size(); ++i) {
            if (profile.below[i] == none) continue;
            ends.push_back(place(profile.node[i]));
            ends.push_back(place(profile.node[profile.below[i]]));
        }
        ends = io::to_plane({middle.x, middle.y}, ends);
        double worst = 0, farthest = 0;
        std::size_t step = 0;
        for (Index i = 0; i < profile.size(); ++i) {
            if (profile.below[i] == none) continue;
            const Point &a = ends[2 * step], &b = ends[2 * step + 1];
            worst = std::max(worst, std::abs(profile.length_m[i] / std::hypot(a.x - b.x, a.y - b.y) - 1));
            farthest = std::max(farthest, std::hypot(a.x, a.y));
            ++step;
        }
        // At c radians from its middle the plane stretches lengths by up to 1/cos(c/2) and, since authalic latitudes
        // are not geographic ones, by up to e²/6·sin 2φ·c.
        const double c = farthest / 6.35e6;
        const double bound =
            1 / std::cos(0.5 * c) - 1 + 0.00669438 / 6 * std::abs(std::sin(2 * middle.y * radians)) * c;
        fmt::print("{}: {} steps, lengths off by {:.2e} at most (bound {:.2e})\n", dem.path.filename().string(), step,
                   worst, bound);
        CHECK(step > 1000);
        CHECK(worst < bound);
    }
}

TEST_CASE("A real catchment on degrees measures as on an equal-area plane", "[ellipsoid]") {
    constexpr int placements = 8;
    Categories over_bound;
    for (const RealDem& dem : real_dems()) {
        const Raster raster = io::read_raster(dem.path).raster;
        const auto m = study::measure_raster(raster, whole(dem.channel_area_m2));
        const Point outlet = outlet_in_a_long_link(raster, m);
        const Placement& p = raster.placement;
        const Point middle = p.center(raster.grid.rows / 2, raster.grid.cols / 2);
        Frame f{.middle = {middle.x, middle.y},
                .degrees = p.cell_width,
                .rows = raster.grid.rows + 8,
                .cols = raster.grid.cols + 8};
        REQUIRE(p.cell_height == Approx(p.cell_width));
        std::map<std::string, std::vector<double>> differences;
        Random random(1, 7);
        for (int i = 0; i < placements; ++i) {
            f.shift = {random.uniform(), random.uniform()};
            Raster degrees = on_degrees(f), plane = on_plane(f);
            resample(degrees, f, raster);
            resample(plane, f, raster);
            const Numbers a = measured(degrees, outlet, dem.channel_area_m2);
            const Numbers b = measured(plane, io::to_plane(f.middle, {outlet})[0], dem.channel_area_m2);
            for (const auto& [name, value] : a) differences[name].push_back(std::log(value / b.at(name)));
        }
        for (const auto& [name, values] : differences) {
            // Two rasters of one terrain differ by which cells were taken; over several placements that cancels, and
            // what is left must lie within five standard errors (one in 1600 by chance) and the plane's own distortion.
            const double error = standard_deviation(values) / std::sqrt(placements);
            const double distortion = 2e-5;
            fmt::print("{:24} {:22} degrees over plane: {:+.2e}, standard error {:.1e}\n", dem.path.filename().string(),
                       name, mean(values), error);
            INFO(dem.path << ": " << name);
            CHECK(std::abs(mean(values)) < 5 * error + distortion);
            CHECK(error < 0.02);  // else the comparison would say nothing
            over_bound.add(name, out_of_bound(mean(values), 5 * error + distortion));
        }
    }
    write_series("ellipsoid_catchments", over_bound);
}
