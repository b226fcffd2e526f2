// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "support/drawn_catchment.hpp"
#include "support/temp_folder.hpp"
#include "thalweg/io/geodesy.hpp"
#include "thalweg/io/raster_file.hpp"
#include "thalweg/study/domain.hpp"
#include "thalweg/study/simulate.hpp"

using namespace thalweg;
using namespace thalweg::study;
using test::TempFolder;

namespace {

Experiment on_square(MeshKind mesh, Index nodes = 2500) {
    Experiment e;
    e.domain.size_m = {10000, 10000};
    e.domain.nodes = nodes;
    e.domain.mesh = mesh;
    e.river.k = 1e-5;
    e.river.m = 0.5;
    e.time.solver = Solver::steady;
    return e;
}

constexpr MeshKind meshes[] = {MeshKind::tin, MeshKind::raster};

std::string geojson(const std::string& type, const std::string& coordinates) {
    return R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":{"type":")" + type +
           R"(","coordinates":)" + coordinates + "}}]}";
}

const char* holed =
    "[[[0,0],[30000,2000],[33000,20000],[20000,31000],[16000,22000],[3000,26000],[0,0]],"
    "[[12000,8000],[14000,14000],[20000,12000],[17000,7000],[12000,8000]]]";

std::string refusal(const Experiment& e) {
    return test::error_of([&] { make_domain(e, Messages{}); });
}

bool says(const std::string& text, const std::string& part) {
    INFO(text);
    CHECK(test::is_sentence(text));
    return text.find(part) != std::string::npos;
}

std::vector<std::uint8_t> outlets_of(const Domain& d) {
    std::vector<std::uint8_t> outlets;
    for (const Boundary b : d.setting.boundary) outlets.push_back(b == Boundary::base_level);
    return outlets;
}

double cell_sum(const Domain& d) {
    double sum = 0;
    std::visit(
        [&](const auto& topology) {
            for (Index node = 0; node < topology.size(); ++node) {
                if (!std::isnan(d.start.elevation_m[node])) sum += topology.area(node);
            }
        },
        d.topology);
    return sum;
}

Index inside(const Domain& d) {
    return static_cast<Index>(std::count_if(d.start.elevation_m.begin(), d.start.elevation_m.end(),
                                            [](double height) { return !std::isnan(height); }));
}

}  // namespace

TEST_CASE("A drawn polygon with a hole is a domain for every mesh and pattern, its count met within 2 %") {
    const TempFolder temp;
    Experiment e = on_square(MeshKind::tin);
    e.domain.size_m.clear();
    e.domain.outline = temp.text("o.geojson", geojson("Polygon", holed));
    // Shoelace by hand: 2·A of the outer ring 1451e6, of the hole 68e6.
    const double area = (1451e6 - 68e6) / 2;
    for (const Index nodes : {400u, 1500u, 6000u}) {
        e.domain.nodes = nodes;
        for (int kind = 0; kind < 4; ++kind) {
            e.domain.mesh = kind == 3 ? MeshKind::raster : MeshKind::tin;
            e.domain.points.reset();
            if (kind < 3) e.domain.points = static_cast<mesh::PointPattern>(kind);
            INFO(nodes << " " << kind);
            const Domain d = make_domain(e, Messages{});
            CHECK(std::abs(inside(d) - static_cast<double>(nodes)) <= 0.02 * nodes);
            CHECK(std::abs(cell_sum(d) / d.area_m2 - 1) < 1e-12);
            CHECK(d.area_m2 == Approx(area).epsilon(kind == 3 ? 0.05 : 1e-12));
            CHECK(d.placement.crs_wkt.empty());
            const auto outlets = outlets_of(d);
            if (const Mesh* tin = std::get_if<Mesh>(&d.topology)) CHECK(outlets == tin->on_outline);
            CHECK(std::count(outlets.begin(), outlets.end(), 1) > 30);
        }
    }
}

TEST_CASE("An outline in degrees becomes metres on a plane of equal areas, and results have its coordinate system") {
    const TempFolder temp;
    Experiment e = on_square(MeshKind::tin);
    e.domain.size_m.clear();
    e.domain.outline =
        temp.text("o.geojson", geojson("Polygon", "[[[7.0,46.0],[7.4,46.05],[7.3,46.4],[7.05,46.3],[7.0,46.0]]]"));
    const double area = io::geodesic_area({{7.0, 46.0}, {7.4, 46.05}, {7.3, 46.4}, {7.05, 46.3}});
    for (const MeshKind mesh : meshes) {
        e.domain.mesh = mesh;
        const Domain d = make_domain(e, Messages{});
        CHECK(d.area_m2 == Approx(area).epsilon(mesh == MeshKind::tin ? 1e-4 : 0.03));
        CHECK(d.placement.crs_wkt.find("Azimuthal") != std::string::npos);
    }
}

TEST_CASE("Outlines that are no single polygon are refused with what to do") {
    const TempFolder temp;
    Experiment e = on_square(MeshKind::tin);
    e.domain.size_m.clear();
    const auto refused = [&](const std::string& text) {
        e.domain.outline = temp.text("o.geojson", text);
        return refusal(e);
    };
    CHECK(says(refused(geojson("MultiPolygon",
                               "[[[[0,0],[9000,0],[0,9000],[0,0]]],[[[20000,0],[29000,0],[20000,9000],[20000,0]]]]")),
               "holds 2 polygons"));
    CHECK(says(refused(geojson("LineString", "[[0,0],[9000,0],[0,9000]]")), "holds 0 polygons"));
    CHECK(says(refused(geojson("Polygon", "[[[0,0],[9000,9000],[9000,0],[0,9000],[0,0]]]")), "outline"));
    for (const MeshKind mesh : meshes) {
        e.domain.mesh = mesh;
        const auto with_hole = [&](const std::string& hole) {
            return refused(geojson("Polygon", "[[[0,0],[9000,0],[9000,9000],[0,9000],[0,0]]," + hole + "]"));
        };
        CHECK(says(with_hole("[[-1000,3000],[2000,3000],[2000,5000],[-1000,3000]]"), "touch or cross"));
        CHECK(says(with_hole("[[0,3000],[2000,3000],[2000,5000],[0,3000]]"), "touch or cross"));
        CHECK(says(with_hole("[[11000,3000],[12000,3000],[12000,5000],[11000,3000]]"), "lies outside the outline"));
    }
    CHECK(says(refused("{}"), "o.geojson"));
    e.domain.outline = temp / "missing.gpkg";
    CHECK(says(refusal(e), "missing.gpkg"));
    e.domain.size_m = {1000, 1000};
    CHECK(says(refusal(e), "exclude each other"));
}

TEST_CASE("A raster's number of cells is met within 2 % by whole rows and columns") {
    for (const auto& [width, height] : {std::pair{10000.0, 10000.0}, {30000.0, 10000.0}, {7000.0, 11000.0}}) {
        for (Index nodes = 100; nodes < 20000; nodes = nodes * 9 / 7 + 1) {
            Experiment e = on_square(MeshKind::raster, nodes);
            e.domain.size_m = {width, height};
            const Grid grid = std::get<Grid>(make_domain(e, Messages{}).topology);
            INFO(width << " x " << height << ": " << nodes);
            CHECK(std::abs(grid.size() - static_cast<double>(nodes)) <= 0.02 * nodes);
            CHECK(std::abs(std::log(grid.east_west[0] / grid.north_south[0])) <
                  0.45);  // 129 cells are 6 rows of 21, not 7 of 19
        }
    }
}

TEST_CASE("Rectangles too small, too large or too narrow for numbers are refused") {
    for (const MeshKind mesh : meshes) {
        Experiment e = on_square(mesh, 400);
        e.domain.size_m = {1e-300, 1e-300};
        CHECK(says(refusal(e), "domain.size_m"));
        e.domain.size_m = {1e300, 1e300};
        CHECK(says(refusal(e), "domain.size_m"));
    }
    Experiment e = on_square(MeshKind::raster, 400);
    e.domain.size_m = {1, 1e40};
    CHECK(says(refusal(e), "too narrow"));
}

TEST_CASE("Named sides of a rectangle are its four, corners belonging to two") {
    for (const MeshKind mesh : meshes) {
        Experiment e = on_square(mesh);
        for (const Side side : {Side::north, Side::east, Side::south, Side::west}) {
            e.outlets = Outlets{OutletRule::sides, {side}};
            const Domain d = make_domain(e, Messages{});
            const double half = mesh == MeshKind::raster ? 100 : 0;  // cells of 200 m
            for (std::size_t i = 0; i < d.positions_m.size(); ++i) {
                const Point& p = d.positions_m[i];
                const bool on_side = side == Side::north   ? p.y > 10000 - half - 1
                                     : side == Side::east  ? p.x > 10000 - half - 1
                                     : side == Side::south ? p.y < half + 1
                                                           : p.x < half + 1;
                REQUIRE((d.setting.boundary[i] == Boundary::base_level) == on_side);
            }
        }
        e.outlets = Outlets{OutletRule::sides, {Side::northeast}};
        CHECK(says(refusal(e), "northeast"));
        e.outlets = Outlets{OutletRule::dem};
        CHECK(says(refusal(e), "domain.dem"));
    }
}

TEST_CASE("The sides of a polygon are the sectors of its outward normals, also those of a hole") {
    const TempFolder temp;
    Experiment e = on_square(MeshKind::tin);
    e.domain.size_m.clear();
    // A diamond faces the four corners of the sky; so does, the other way round, the hole in it.
    e.domain.outline = temp.text("o.geojson", geojson("Polygon",
                                                      "[[[0,-9000],[9000,0],[0,9000],[-9000,0],[0,-9000]],"
                                                      "[[0,-2000],[-2000,0],[0,2000],[2000,0],[0,-2000]]]"));
    for (const MeshKind mesh : meshes) {
        e.domain.mesh = mesh;
        e.outlets = Outlets{OutletRule::sides, {Side::northeast}};
        const Domain d = make_domain(e, Messages{});
        int outer = 0, hole = 0;
        for (std::size_t i = 0; i < d.positions_m.size(); ++i) {
            if (d.setting.boundary[i] != Boundary::base_level) continue;
            const Point& p = d.positions_m[i];
            const bool far = p.x + p.y > 8000, near = p.x + p.y < -1400 && p.x + p.y > -3000;
            REQUIRE((far || near));
            ++(far ? outer : hole);
        }
        CHECK(outer > 15);
        CHECK(hole > 3);
        e.outlets = Outlets{OutletRule::sides, {Side::north}};
        CHECK(says(refusal(e), "north"));
    }
}

TEST_CASE("Outlets below a share of the largest uplift are those of the rim alone") {
    for (const MeshKind mesh : meshes) {
        Experiment e = on_square(mesh);
        e.uplift.pattern = evolve::Pattern::gradient;  // rising northwards
        e.outlets = Outlets{OutletRule::uplift_below, {}, 0.33};
        const Domain d = make_domain(e, Messages{});
        Experiment all = e;
        all.outlets = Outlets{};
        const auto rim = outlets_of(make_domain(all, Messages{}));
        const double largest = *std::max_element(d.setting.uplift_m_per_yr.begin(), d.setting.uplift_m_per_yr.end());
        for (std::size_t i = 0; i < rim.size(); ++i) {
            const bool low = d.setting.uplift_m_per_yr[i] < 0.33 * largest;
            REQUIRE((d.setting.boundary[i] == Boundary::base_level) == (rim[i] && low));
        }
        e.uplift.pattern = evolve::Pattern::constant;
        CHECK(says(refusal(e), "uplift"));
    }
}

TEST_CASE("A picture is stretched over the domain, north up, and scaled so that its largest value is the rate") {
    const TempFolder temp;
    // Four columns from 0 to 200 in the northern row, all 100 in the southern one.
    const auto file = temp.text("u.pgm", "P2\n4 2\n255\n0 50 100 200\n100 100 100 100\n");
    for (const MeshKind mesh : meshes) {
        Experiment e = on_square(mesh);
        e.uplift.rate_m_per_yr = 2e-3;
        e.uplift.field = file;
        const Domain d = make_domain(e, Messages{});
        for (std::size_t i = 0; i < d.positions_m.size(); ++i) {
            const Point& p = d.positions_m[i];
            // Linear between the cells' centres, level beyond: x at 1250, 3750, 6250, 8750; y at 2500 and 7500.
            const double x = std::clamp(p.x, 1250.0, 8750.0), y = std::clamp(p.y, 2500.0, 7500.0);
            const double north = x < 3750   ? 50 * (x - 1250) / 2500
                                 : x < 6250 ? 50 + 50 * (x - 3750) / 2500
                                            : 100 + 100 * (x - 6250) / 2500;
            const double value = 100 + (north - 100) * (y - 2500) / 5000;
            REQUIRE(d.setting.uplift_m_per_yr[i] == Approx(2e-3 * value / 200).margin(1e-15));
        }
    }
}

TEST_CASE("Pattern, picture and lines multiply, for rain as for uplift; k_field scales k") {
    const TempFolder temp;
    const auto picture = temp.text("u.pgm", "P2\n2 1\n255\n100 200\n");
    const auto rivers = temp.text("r.geojson", geojson("LineString", "[[5000,-1000],[5000,11000]]"));
    for (const MeshKind mesh : meshes) {
        Experiment e = on_square(mesh);
        e.rainfall.maximum = 3;
        e.rainfall.pattern = evolve::Pattern::gradient;
        e.rainfall.field = picture;
        e.rainfall.lines = {rivers};
        e.rainfall.lines_width_m = {4000};
        e.rainfall.lines_value = {0.5};
        e.river.k_field = picture;
        const Domain d = make_domain(e, Messages{});
        for (std::size_t i = 0; i < d.positions_m.size(); ++i) {
            const Point& p = d.positions_m[i];
            const double shade = 0.5 + 0.5 * (std::clamp(p.x, 2500.0, 7500.0) - 2500) / 5000;
            const double t = std::abs(p.x - 5000) / 2000;
            const double line = t < 1 ? 1 - 0.5 * (1 - t * t) * (1 - t * t) : 1;
            REQUIRE(d.setting.rainfall[i] == Approx(3 * p.y / 10000 * shade * line).margin(1e-12));
            REQUIRE(d.setting.relative_erodibility[i] == Approx(shade).epsilon(1e-12));
        }
        CHECK(make_domain(on_square(mesh), Messages{}).setting.relative_erodibility.empty());
    }
}

TEST_CASE("Rivers and ridges may have a width and a value each") {
    const TempFolder temp;
    Experiment e = on_square(MeshKind::raster, 10000);
    e.uplift.rate_m_per_yr = 1;
    e.uplift.lines = {temp.text("a.geojson", geojson("LineString", "[[2000,2000],[2000,8000]]")),
                      temp.text("b.geojson", geojson("LineString", "[[8000,2000],[8000,8000]]"))};
    e.uplift.lines_width_m = {1000};
    e.uplift.lines_value = {0, 2};
    const Domain d = make_domain(e, Messages{});
    const auto at = [&](double x, double y) {
        std::size_t best = 0;
        const auto off = [&](std::size_t i) { return std::hypot(d.positions_m[i].x - x, d.positions_m[i].y - y); };
        for (std::size_t i = 0; i < d.positions_m.size(); ++i) best = off(i) < off(best) ? i : best;
        return d.setting.uplift_m_per_yr[best];
    };
    CHECK(at(2000, 5000) < 0.02);
    CHECK(at(8000, 5000) > 0.98);
    CHECK(at(5000, 5000) == 0.5);
    e.uplift.lines_value = {0, 2, 3};
    CHECK(says(refusal(e), "lines_value"));
    e.uplift.lines_value = {};
    CHECK(says(refusal(e), "lines_value"));
    e.uplift.lines_value = {1};
    e.uplift.lines = {temp.text("far.geojson", geojson("LineString", "[[90000,0],[90000,9]]"))};
    CHECK(says(refusal(e), "comes near"));
    e.uplift.lines = {temp.text("area.geojson", geojson("Polygon", holed))};
    CHECK(says(refusal(e), "no lines"));
    e.uplift.lines = {};
    CHECK(says(refusal(e), "need uplift.lines"));
}

TEST_CASE("Pictures that cannot be uplift, rain or rock are refused in one sentence") {
    const TempFolder temp;
    Experiment e = on_square(MeshKind::tin, 200);
    const auto with = [&](const std::vector<double>& values, const std::string& crs) {
        Raster raster{plane_grid(2, 2, 5000, 5000),
                      {.west = 0, .north = 10000, .cell_width = 5000, .cell_height = 5000, .crs_wkt = crs},
                      values};
        io::write_raster(temp / "u.tif", raster.grid, raster.placement, raster.values, {});
        e.uplift.field = temp / "u.tif";
        return refusal(e);
    };
    const double nan = std::nan("");
    CHECK(with({1, 2, 3, 4}, "").empty());
    CHECK(says(with({1, 2, 3, nan}, ""), "nodes: it must cover"));
    CHECK(says(with({nan, nan, nan, nan}, ""), "no data"));
    CHECK(says(with({1, -2, 3, 4}, ""), "negative"));
    CHECK(says(with({0, 0, 0, 0}, ""), "zero everywhere"));
    e.uplift.field = temp.text("u.pgm", "");
    CHECK(says(refusal(e), "empty"));
    e.uplift.field = temp / "missing.png";
    CHECK(says(refusal(e), "does not exist"));
    e.uplift.field.reset();
    e.river.k_field = temp.text("k.pgm", "P2\n2 2\n255\n1 2 3");
    CHECK(says(refusal(e), "3 values"));
}

TEST_CASE(
    "On the map a raster is placed by its coordinates, whatever its coordinate system; without one it is refused") {
    const TempFolder temp;
    Raster drawn = support::drawn_catchment();
    drawn.placement.west = 500000;
    drawn.placement.north = 4e6;
    io::write_raster(temp / "dem.tif", drawn.grid, drawn.placement, drawn.values, {});
    const Raster dem = io::read_raster(temp / "dem.tif", {.crs = "EPSG:32611"}).raster;
    MeasureOptions options;
    options.channel_area_m2 = 200;
    const Catchment c = largest_complete_catchment(dem, options);
    // A map in degrees whose value is the longitude: −117 at x = 500 000 of zone 11.
    Raster map{plane_grid(200, 200, 1, 1),
               {.west = -117.001,
                .north = 36.2,
                .cell_width = 0.00001,
                .cell_height = 0.001,
                .crs_wkt = "",
                .geographic = true},
               {}};
    for (Index i = 0; i < map.grid.size(); ++i) map.values.push_back(1 + (map.grid.col(i) + 0.5) / 200);
    const auto wkt = [](const std::string& epsg, const TempFolder& folder, Raster r) {
        io::write_raster(folder / "tmp.tif", r.grid, r.placement, r.values, {});
        return io::read_raster(folder / "tmp.tif", {.crs = epsg}).raster.placement.crs_wkt;
    };
    map.placement.crs_wkt = wkt("EPSG:4326", temp, map);
    io::write_raster(temp / "map.tif", map.grid, map.placement, map.values, {});
    Experiment e;
    e.river.k = 1e-5;
    e.river.m = 0.5;
    e.uplift.rate_m_per_yr = 2;
    e.uplift.field = temp / "map.tif";
    for (const MeshKind mesh : meshes) {
        e.domain.mesh = mesh;
        e.domain.nodes.reset();
        if (mesh == MeshKind::tin) e.domain.nodes = 300;
        const Domain d = make_domain(e, c);
        for (std::size_t i = 0; i < d.positions_m.size(); ++i) {
            if (std::isnan(d.start.elevation_m[i])) continue;
            // One metre is 1/90 163 degrees of longitude there.
            const double x =
                mesh == MeshKind::tin ? d.positions_m[i].x : c.raster.placement.center(0, static_cast<Index>(i) % 7).x;
            const double longitude = -117 + (x - 500000) / 90163.0 * 0.9996;
            const double share = 1 + (longitude + 117.001) / 0.002;
            REQUIRE(d.setting.uplift_m_per_yr[i] == Approx(2 * share / (1 + 199.5 / 200)).epsilon(2e-3));
        }
    }
    map.placement.crs_wkt.clear();
    io::write_raster(temp / "nowhere.tif", map.grid, map.placement, map.values, {});
    e.uplift.field = temp / "nowhere.tif";
    CHECK(says(test::error_of([&] { make_domain(e, c); }), "no coordinate system"));
}

TEST_CASE("The land may start from a raster's heights, or a constant with noise on it; outlets keep what they have") {
    const TempFolder temp;
    const auto file = temp.text("h.pgm", "P2\n2 1\n1000\n100 500\n");
    for (const MeshKind mesh : meshes) {
        Experiment e = on_square(mesh);
        e.initial.elevation = file;
        const Domain d = make_domain(e, Messages{});
        for (std::size_t i = 0; i < d.positions_m.size(); ++i) {
            const double x = std::clamp(d.positions_m[i].x, 2500.0, 7500.0);
            REQUIRE(d.start.elevation_m[i] == Approx(100 + 400 * (x - 2500) / 5000));
        }
        e.initial.constant_m = 5;
        CHECK(says(refusal(e), "exclude each other"));
        e.initial.elevation.reset();
        const Domain flat = make_domain(e, Messages{});
        for (std::size_t i = 0; i < flat.positions_m.size(); ++i) {
            const double height = flat.start.elevation_m[i];
            if (flat.setting.boundary[i] == Boundary::base_level)
                REQUIRE(height == 0);
            else
                REQUIRE((height >= 5 && height <= 5.01));
        }
    }
}

TEST_CASE("Simulations come to their steady state under every pattern, on a TIN and on a raster") {
    const TempFolder temp;
    int run = 0;
    for (const MeshKind mesh : meshes) {
        for (const auto& [word, pattern] : words(evolve::Pattern{})) {
            INFO(word);
            Experiment e = on_square(mesh, 400);
            e.uplift.pattern = pattern;
            const auto folder = temp / std::to_string(run++);
            std::filesystem::create_directory(folder);
            const auto s = nlohmann::json::parse(simulate(e, folder, {}));
            CHECK(s["converged"].get<bool>());
            CHECK(s["elevation_max_m"].get<double>() > 10);
            CHECK(std::filesystem::exists(folder / "elevation.tif"));
        }
    }
}
