// SPDX-License-Identifier: GPL-3.0-or-later
// What simulate writes for other programs: heightfields, heightmap, meshes.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/temp_folder.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/io/raster_file.hpp"
#include "thalweg/study/simulate.hpp"

using namespace thalweg;
using namespace thalweg::study;
using test::bytes_of;
using test::error_of;
using test::is_sentence;
using test::TempFolder;
using Json = nlohmann::json;

namespace {

const std::filesystem::path jacksboro = THALWEG_SOURCE_DIR "/validation/data/jacksboro.tif";

Experiment island(MeshKind mesh, Index nodes) {
    Experiment e;
    e.domain.size_m = {20000, 16000};
    e.domain.nodes = nodes;
    e.domain.mesh = mesh;
    e.river.k = 2e-5;
    e.river.m = 0.5;
    e.time.solver = Solver::steady;
    if (mesh == MeshKind::tin) e.output.resolution = 100;
    return e;
}

Json simulated(const Experiment& e, const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    return Json::parse(simulate(e, folder, {}));
}

std::vector<double> heights_in(const std::filesystem::path& folder) {
    return io::read_raster(folder / "elevation.tif").raster.values;
}

struct ObjFile {
    std::vector<std::array<double, 3>> vertices;
    std::size_t triangles = 0;
};

ObjFile read_obj(const std::filesystem::path& path) {
    ObjFile file;
    std::istringstream lines(bytes_of(path));
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string kind;
        std::array<double, 3> v{};
        if (!(words >> kind)) continue;
        if (kind == "f") ++file.triangles;
        if (kind == "v" && words >> v[0] >> v[1] >> v[2]) file.vertices.push_back(v);
    }
    return file;
}

}  // namespace

TEST_CASE("The three interpolations differ, agree in the large, and smoothing lowers the peaks") {
    const TempFolder temp;
    Experiment e = island(MeshKind::tin, 3000);
    const Json summary = simulated(e, temp / "linear");
    const std::vector<double> linear = heights_in(temp / "linear");
    e.output.interpolation = Interpolation::natural;
    simulated(e, temp / "natural");
    e.output.interpolation = Interpolation::gaussian;
    simulated(e, temp / "gaussian");
    e.output.sigma_cells = 0.01;
    simulated(e, temp / "narrow");
    const double highest = summary["elevation_max_m"].get<double>();
    for (const char* kind : {"natural", "gaussian", "narrow"}) {
        INFO(kind);
        const std::vector<double> other = heights_in(temp / kind);
        REQUIRE(other.size() == linear.size());
        double difference = 0;
        for (std::size_t i = 0; i < other.size(); ++i) difference += std::abs(other[i] - linear[i]);
        difference /= static_cast<double>(other.size());
        CHECK(difference > 0);
        CHECK(difference < 0.05 * highest);
        CHECK(*std::max_element(other.begin(), other.end()) <= highest);
    }
    const auto peak = [&](const char* kind) {
        const auto values = heights_in(temp / kind);
        return *std::max_element(values.begin(), values.end());
    };
    CHECK(peak("gaussian") < 0.98 * peak("narrow"));
}

TEST_CASE("The heightmap's scale gives back the heights of elevation.tif") {
    const TempFolder temp;
    Experiment e = island(MeshKind::raster, 3000);
    e.output.heightmap = HeightmapFile::png;
    const Json summary = simulated(e, temp / "out");
    const Json& scale = summary["heightmap"];
    CHECK(scale["file"] == "elevation.png");
    CHECK(scale["nodata_count"] == 0);
    const std::vector<double> heights = heights_in(temp / "out");
    const auto [lowest, highest] = std::minmax_element(heights.begin(), heights.end());
    const double step = scale["metres_per_count"], offset = scale["offset_m"];
    CHECK(offset + step == Approx(*lowest).margin(1e-9));
    CHECK(offset + 65535 * step == Approx(*highest));
    CHECK(std::filesystem::exists(temp / "out/elevation.wld"));
}

TEST_CASE("A TIN's mesh file holds its nodes and their heights, relative to the origin that the summary names") {
    const TempFolder temp;
    Experiment e = island(MeshKind::tin, 2000);
    e.output.mesh_file = MeshFile::obj;
    const Json summary = simulated(e, temp / "out");
    const Json& mesh = summary["meshes"][0];
    const ObjFile file = read_obj(temp / "out/mesh.obj");
    CHECK(mesh["file"] == "mesh.obj");
    CHECK(mesh["closed"] == false);
    CHECK(file.vertices.size() == summary["nodes"]);
    CHECK(file.vertices.size() == mesh["vertices"]);
    CHECK(file.triangles == mesh["triangles"]);
    double highest = 0;
    for (const auto& v : file.vertices) {
        highest = std::max(highest, v[2]);
        CHECK((v[0] + mesh["origin_x"].get<double>() >= -1e-4 && v[0] + mesh["origin_x"].get<double>() <= 20000.0001));
        CHECK((v[1] + mesh["origin_y"].get<double>() >= -1e-4 && v[1] + mesh["origin_y"].get<double>() <= 16000.0001));
    }
    CHECK(highest == Approx(summary["elevation_max_m"].get<double>()).epsilon(5e-7));
}

TEST_CASE("Solids of a TIN, of its heightfield and of a catchment's cells are closed and hold the terrain") {
    const TempFolder temp;
    Experiment e = island(MeshKind::tin, 2000);
    e.output.mesh_file = MeshFile::ply;
    e.output.heightfield_mesh_file = MeshFile::obj;
    e.output.solid = true;
    e.output.base_depth_m = 100;
    const Json summary = simulated(e, temp / "tin");
    const double mean = summary["elevation_mean_m"].get<double>(), area = summary["domain_area_m2"].get<double>();
    REQUIRE(summary["meshes"].size() == 2);
    for (const Json& mesh : summary["meshes"]) {
        CHECK(mesh["closed"] == true);
        CHECK(mesh["base_m"] == -100);
        CHECK(mesh["volume_m3"].get<double>() == Approx(area * (mean + 100)).epsilon(0.05));
        CHECK(mesh["vertices"].get<int>() * 2 - 4 == mesh["triangles"].get<int>());  // Euler: a sphere with no handle
        CHECK(std::filesystem::exists(temp / "tin" / mesh["file"].get<std::string>()));
    }
    CHECK(read_obj(temp / "tin/heightfield.obj").triangles == summary["meshes"][1]["triangles"]);

    Experiment basin = island(MeshKind::raster, 0);
    basin.domain = {};
    basin.domain.mesh = MeshKind::raster;
    basin.domain.dem = jacksboro;
    basin.output.mesh_file = MeshFile::obj;
    basin.output.solid = true;
    const Json of_cells = simulated(basin, temp / "raster")["meshes"][0];
    CHECK(of_cells["volume_m3"].get<double>() > 0);
    const ObjFile file = read_obj(temp / "raster/mesh.obj");
    CHECK(file.vertices.size() == of_cells["vertices"]);
    double farthest = 0;
    for (const auto& v : file.vertices) farthest = std::max({farthest, std::abs(v[0]), std::abs(v[1])});
    CHECK(farthest < 50000);  // metres about the origin, whatever the map's coordinates
}

TEST_CASE("Output for other programs has the same bytes for any number of threads") {
    const TempFolder temp;
    Experiment e = island(MeshKind::tin, 2000);
    e.output.interpolation = Interpolation::gaussian;
    e.output.geotiff = GeotiffKind::cog;
    e.output.heightmap = HeightmapFile::png;
    e.output.mesh_file = MeshFile::ply;
    e.output.heightfield_mesh_file = MeshFile::ply;
    e.output.solid = true;
    for (const int threads : {1, 2}) {
        const ThreadLimit limit(threads);
        simulated(e, temp / std::to_string(threads));
    }
    for (const char* file : {"elevation.tif", "elevation.png", "elevation.wld", "mesh.ply", "heightfield.ply"}) {
        INFO(file);
        CHECK(bytes_of(temp / "1" / file) == bytes_of(temp / "2" / file));
        CHECK(bytes_of(temp / "1" / file).size() > 20);
    }
}

TEST_CASE("A raster mesh written at a resolution of its own lies on the same ground, bilinear between its cells") {
    const TempFolder temp;
    Experiment e = island(MeshKind::raster, 2000);
    const Json own = simulated(e, temp / "own");
    const Raster cells = io::read_raster(temp / "own/elevation.tif").raster;
    const Raster area = io::read_raster(temp / "own/drainage_area.tif").raster;

    e.output.resolution = 3 * cells.grid.cols;
    const Json fine = simulated(e, temp / "fine");
    const Raster thirds = io::read_raster(temp / "fine/elevation.tif").raster;
    const Raster thirds_area = io::read_raster(temp / "fine/drainage_area.tif").raster;
    CHECK(thirds.grid.cols == 3 * cells.grid.cols);
    CHECK(thirds.placement.west == cells.placement.west);
    CHECK(thirds.placement.north == cells.placement.north);
    CHECK(thirds.placement.cell_width * 3 == Approx(cells.placement.cell_width));
    CHECK(std::abs(thirds.grid.rows * thirds.placement.cell_height - cells.grid.rows * cells.placement.cell_height) <
          thirds.placement.cell_height);
    for (Index row = 0; row < thirds.grid.rows; ++row) {
        const double y = (row + 0.5) * thirds.placement.cell_height / cells.placement.cell_height - 0.5;
        if (y < 0 || y > cells.grid.rows - 1) continue;
        const Index r = std::min(static_cast<Index>(y), cells.grid.rows - 2);
        for (Index c = 0; c < cells.grid.cols; ++c) {  // the middle third of a cell stands at its column's centre
            const double above = cells.values[r * cells.grid.cols + c];
            const double below = cells.values[(r + 1) * cells.grid.cols + c];
            const Index at = row * thirds.grid.cols + 3 * c + 1;
            CHECK(thirds.values[at] == Approx(above + (y - r) * (below - above)).margin(1e-6));
            const Index holds = std::min(static_cast<Index>(y + 0.5), cells.grid.rows - 1);
            CHECK(thirds_area.values[at] == area.values[holds * cells.grid.cols + c]);
        }
    }
    CHECK(fine["terrain"]["channels"] == own["terrain"]["channels"]);  // measured on the run's own graph
}

TEST_CASE("A catchment's cells in degrees, too, are written at another resolution") {
    const TempFolder temp;
    Experiment e;
    e.domain.dem = jacksboro;
    e.domain.mesh = MeshKind::raster;
    e.river.k = 2e-5;
    e.river.m = 0.5;
    e.time.solver = Solver::steady;
    simulated(e, temp / "own");
    e.output.resolution = 150;
    simulated(e, temp / "coarse");
    const auto area_and_mean = [&](const char* folder) {
        const Raster raster = io::read_raster(temp / folder / "elevation.tif").raster;
        double area = 0, sum = 0;
        for (Index node = 0; node < raster.grid.size(); ++node) {
            if (std::isnan(raster.values[node])) continue;
            area += raster.grid.area(node);
            sum += raster.grid.area(node) * raster.values[node];
        }
        return std::pair{area, sum / area};
    };
    const auto [own_area, own_mean] = area_and_mean("own");
    const auto [coarse_area, coarse_mean] = area_and_mean("coarse");
    CHECK(coarse_area == Approx(own_area).epsilon(0.02));
    CHECK(coarse_mean == Approx(own_mean).epsilon(0.01));
    const Raster coarse = io::read_raster(temp / "coarse/elevation.tif").raster;
    CHECK(std::max(coarse.grid.rows, coarse.grid.cols) == 150);
}

TEST_CASE("Keys that contradict each other are refused before the simulation begins") {
    const TempFolder temp;
    const auto refused = [&](auto change) {
        Experiment e = island(MeshKind::tin, 2000);
        change(e.output);
        CHECK(is_sentence(error_of([&] { simulated(e, temp / "out"); })));
        CHECK_FALSE(std::filesystem::exists(temp / "out/summary.json"));
    };
    refused([](auto& output) { output.sigma_cells = 2; });
    refused([](auto& output) { output.solid = true; });
    refused([](auto& output) {
        output.mesh_file = MeshFile::obj;
        output.base_depth_m = 10;
    });
}

TEST_CASE("A heightfield that cannot be is refused before the first step") {
    const test::TempFolder temp;
    const auto refused_before_stepping = [&](const Experiment& e) {
        bool stepped = false;
        Messages messages;
        messages.progress = [&](const std::string& text) { stepped = stepped || text != "making the mesh"; };
        const std::string refusal = test::error_of([&] { simulate(e, temp / "out", messages); });
        CHECK(test::is_sentence(refusal));
        CHECK(!stepped);
        return refusal;
    };
    Experiment e = island(MeshKind::raster, 400);
    e.output.resolution = 100000;
    CHECK(refused_before_stepping(e).find("80000 x 100000") != std::string::npos);
    e.output.resolution.reset();
    e.output.interpolation = Interpolation::natural;
    CHECK(refused_before_stepping(e).find("output.interpolation") != std::string::npos);
    e = island(MeshKind::tin, 400);
    e.output.resolution = 100000;
    CHECK(refused_before_stepping(e).find("80000 x 100000") != std::string::npos);
}
