// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/mesh/mesh_file.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <sstream>

#include "support/temp_folder.hpp"

using namespace thalweg;
using namespace thalweg::mesh;
using thalweg::test::bytes_of;
using thalweg::test::error_of;
using thalweg::test::is_sentence;
using thalweg::test::TempFolder;

namespace {

TriangleSurface roof() {
    return {.x = {0, 123456.789, 0.125, 1},
            .y = {0, -1e-3, 3, 1},
            .z = {1234.5678, 2, 1.0 / 3, -7},
            .triangles = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

/// Vertices and triangles of an OBJ file by its lines.
TriangleSurface parse_obj(const std::string& text) {
    TriangleSurface s;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        double x, y, z;
        Index i, j, k;
        if (kind == "v" && words >> x >> y >> z) {
            s.x.push_back(x);
            s.y.push_back(y);
            s.z.push_back(z);
        } else if (kind == "f" && words >> i >> j >> k) {
            s.triangles.push_back({i - 1, j - 1, k - 1});
        } else {
            CHECK((kind.empty() || kind[0] == '#'));
        }
    }
    return s;
}

template <class T>
T take(const std::string& bytes, std::size_t& at) {
    T value;
    REQUIRE(at + sizeof(T) <= bytes.size());
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    at += sizeof(T);
    return value;
}

/// Vertices and triangles of a binary PLY file of doubles, to its last byte.
TriangleSurface parse_ply(const std::string& bytes, std::size_t vertices, std::size_t faces) {
    const std::string end = "end_header\n";
    std::size_t at = bytes.find(end) + end.size();
    TriangleSurface s;
    for (std::size_t v = 0; v < vertices; ++v) {
        s.x.push_back(take<double>(bytes, at));
        s.y.push_back(take<double>(bytes, at));
        s.z.push_back(take<double>(bytes, at));
    }
    for (std::size_t f = 0; f < faces; ++f) {
        CHECK(take<std::uint8_t>(bytes, at) == 3);
        std::array<Index, 3> t{};
        for (Index& corner : t) corner = static_cast<Index>(take<std::int32_t>(bytes, at));
        s.triangles.push_back(t);
    }
    CHECK(at == bytes.size());
    return s;
}

}  // namespace

TEST_CASE("An OBJ file holds every vertex to seven digits, triangles counted from one, and the comment first") {
    const TempFolder folder;
    write_mesh(folder / "roof.obj", roof(), MeshFormat::obj, "metres from (500000, 4000000)");
    const std::string text = bytes_of(folder / "roof.obj");
    CHECK(text.starts_with("# metres from (500000, 4000000)\n"));
    const TriangleSurface read = parse_obj(text);
    CHECK(read.triangles == roof().triangles);
    REQUIRE(read.size() == 4);
    for (Index v = 0; v < 4; ++v) {
        CHECK(read.x[v] == Approx(roof().x[v]).epsilon(5e-7));
        CHECK(read.y[v] == Approx(roof().y[v]).epsilon(5e-7));
        CHECK(read.z[v] == Approx(roof().z[v]).epsilon(5e-7));
    }
}

TEST_CASE("A PLY file is binary little-endian with doubles and reads back to the last bit") {
    const TempFolder folder;
    write_mesh(folder / "roof.ply", roof(), MeshFormat::ply);
    const std::string bytes = bytes_of(folder / "roof.ply");
    CHECK(bytes.starts_with("ply\nformat binary_little_endian 1.0\n"));
    for (const char* line : {"element vertex 4\n", "property double x\n", "property double y\n", "property double z\n",
                             "element face 3\n"}) {
        CHECK(bytes.find(line) != std::string::npos);
    }
    const TriangleSurface read = parse_ply(bytes, 4, 3);
    CHECK(read.x == roof().x);
    CHECK(read.y == roof().y);
    CHECK(read.z == roof().z);
    CHECK(read.triangles == roof().triangles);
}

TEST_CASE("Mesh files that cannot be written whole are refused with a sentence and leave nothing") {
    const TempFolder folder;
    const auto refused = [&](const std::filesystem::path& path, const TriangleSurface& surface) {
        const std::string error = error_of([&] { write_mesh(path, surface, MeshFormat::ply); });
        CHECK(is_sentence(error));
    };
    refused(folder / "empty.ply", {});
    TriangleSurface broken = roof();
    broken.z[2] = std::nan("");
    refused(folder / "nan.ply", broken);
    refused(folder / "no/such/folder.ply", roof());
    refused("/dev/full", roof());
    CHECK(folder.empty());
}
