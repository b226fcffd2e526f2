// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/surface/solid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "surface/nodes.hpp"
#include "surface/sides.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::surface {
namespace {

using Triangle = std::array<Index, 3>;

/// Vertices that triangles use, in their old order.
void drop_unused_vertices(TriangleSurface& s) {
    std::vector<Index> number(s.size(), none);
    for (const Triangle& t : s.triangles) {
        for (const Index corner : t) number[corner] = 0;
    }
    Index used = 0;
    for (Index v = 0; v < s.size(); ++v) {
        if (number[v] == none) continue;
        number[v] = used;
        s.x[used] = s.x[v];
        s.y[used] = s.y[v];
        s.z[used] = s.z[v];
        ++used;
    }
    for (auto* coordinate : {&s.x, &s.y, &s.z}) coordinate->resize(used);
    for (Triangle& t : s.triangles) t = {number[t[0]], number[t[1]], number[t[2]]};
}

/// The triangles between the cells nw, ne, sw and se that have data.
void add_square(const std::array<Index, 4>& cell, std::span<const double> z, std::vector<Triangle>& triangles) {
    const auto [nw, ne, sw, se] = cell;
    const auto missing = [&](Index i) { return std::isnan(z[i]); };
    const auto count = std::count_if(cell.begin(), cell.end(), missing);
    if (count > 1) return;
    if (missing(nw)) triangles.push_back({sw, se, ne});
    if (missing(ne)) triangles.push_back({sw, se, nw});
    if (missing(sw)) triangles.push_back({se, ne, nw});
    if (missing(se)) triangles.push_back({sw, ne, nw});
    if (count == 1) return;
    if (std::abs(z[nw] - z[se]) <= std::abs(z[ne] - z[sw])) {
        triangles.push_back({sw, se, nw});
        triangles.push_back({se, ne, nw});
    } else {
        triangles.push_back({sw, se, ne});
        triangles.push_back({sw, ne, nw});
    }
}

/// Gives each fan of triangles around a vertex a vertex of its own, where there are several.
class FanSplitter {
  public:
    FanSplitter(TriangleSurface& surface, const TriangleSides& sides)
        : surface_(surface), sides_(sides), old_(surface.triangles), done_(surface.triangles.size(), {0, 0, 0}) {}

    void split() {
        std::vector<std::uint8_t> has_fan(surface_.size(), 0);
        for (Index t = 0; t < old_.size(); ++t) {
            for (int k = 0; k < 3; ++k) {
                if (done_[t][k]) continue;
                const Index vertex = old_[t][k];
                const Index own = has_fan[vertex] ? copy_of(vertex) : vertex;
                has_fan[vertex] = 1;
                give_to_fan(t, vertex, own);
            }
        }
    }

  private:
    Index copy_of(Index vertex) {
        surface_.x.push_back(surface_.x[vertex]);
        surface_.y.push_back(surface_.y[vertex]);
        surface_.z.push_back(surface_.z[vertex]);
        return surface_.size() - 1;
    }

    int corner_of(Index t, Index vertex) const {
        return static_cast<int>(std::find(old_[t].begin(), old_[t].end(), vertex) - old_[t].begin());
    }

    /// Round the vertex both ways from triangle t, to the border or to where it began.
    void give_to_fan(Index t, Index vertex, Index own) {
        for (const int turn : {1, 2}) {
            Index here = turn == 1 ? t : sides_.across(t)[(corner_of(t, vertex) + turn) % 3];
            while (here != none) {
                const int corner = corner_of(here, vertex);
                if (done_[here][corner]) break;
                done_[here][corner] = 1;
                surface_.triangles[here][corner] = own;
                here = sides_.across(here)[(corner + turn) % 3];
            }
        }
    }

    TriangleSurface& surface_;
    const TriangleSides& sides_;
    std::vector<Triangle> old_;
    std::vector<std::array<std::uint8_t, 3>> done_;
};

void check_size(std::size_t count, Index needed, const char* what) {
    if (count != needed) throw Error(fmt::format("{} {} for {} nodes", count, what, needed));
}

}  // namespace

TriangleSurface triangle_surface(const Mesh& mesh, std::span<const double> heights_m) {
    check_one_value_per_node(mesh, heights_m);
    TriangleSurface s{.x = mesh.x, .y = mesh.y, .z = {heights_m.begin(), heights_m.end()}, .triangles = mesh.triangles};
    const auto lacks_data = [&](const Triangle& t) {
        return std::isnan(s.z[t[0]]) || std::isnan(s.z[t[1]]) || std::isnan(s.z[t[2]]);
    };
    if (std::erase_if(s.triangles, lacks_data) > 0) drop_unused_vertices(s);
    return s;
}

std::vector<Triangle> cell_triangles(const Grid& grid, std::span<const double> heights_m) {
    check_size(heights_m.size(), grid.size(), "heights");
    std::vector<Triangle> triangles;
    triangles.reserve(2 * std::size_t{grid.size()});
    for (Index row = 0; row + 1 < grid.rows; ++row) {
        for (Index col = 0; col + 1 < grid.cols; ++col) {
            const Index nw = row * grid.cols + col, sw = nw + grid.cols;
            add_square({nw, nw + 1, sw, sw + 1}, heights_m, triangles);
        }
    }
    return triangles;
}

TriangleSurface triangle_surface(const Grid& grid, std::span<const Point> centers, std::span<const double> heights_m) {
    check_size(centers.size(), grid.size(), "centres");
    TriangleSurface s;
    s.triangles = cell_triangles(grid, heights_m);
    s.z.assign(heights_m.begin(), heights_m.end());
    for (const Point& p : centers) {
        s.x.push_back(p.x);
        s.y.push_back(p.y);
    }
    drop_unused_vertices(s);
    return s;
}

TriangleSurface closed_solid(const TriangleSurface& surface, double base_m) {
    const auto lowest = std::min_element(surface.z.begin(), surface.z.end());
    if (lowest != surface.z.end() && !(base_m < *lowest)) {
        throw Error(fmt::format("the base at {} m must lie below the lowest point at {} m", base_m, *lowest));
    }
    TriangleSurface solid = surface;
    const TriangleSides sides(surface.size(), surface.triangles);
    FanSplitter(solid, sides).split();
    drop_unused_vertices(solid);
    const Index top = solid.size(), count = static_cast<Index>(solid.triangles.size());
    solid.x.insert(solid.x.end(), solid.x.begin(), solid.x.begin() + top);
    solid.y.insert(solid.y.end(), solid.y.begin(), solid.y.begin() + top);
    solid.z.resize(2 * std::size_t{top}, base_m);
    for (Index t = 0; t < count; ++t) {
        const Triangle corners = solid.triangles[t];
        for (int k = 0; k < 3; ++k) {
            if (sides.across(t)[k] != none) continue;
            const Index from = corners[(k + 1) % 3], to = corners[(k + 2) % 3];
            solid.triangles.push_back({to, from, from + top});
            solid.triangles.push_back({to, from + top, to + top});
        }
    }
    for (Index t = 0; t < count; ++t) {
        const Triangle c = solid.triangles[t];
        solid.triangles.push_back({c[0] + top, c[2] + top, c[1] + top});
    }
    return solid;
}

double enclosed_volume(const TriangleSurface& s) {
    if (s.x.empty()) return 0;
    const double x0 = s.x[0], y0 = s.y[0], z0 = s.z[0];
    double six_volumes = 0;
    for (const auto& [i, j, k] : s.triangles) {
        const double ax = s.x[i] - x0, ay = s.y[i] - y0, az = s.z[i] - z0;
        const double bx = s.x[j] - x0, by = s.y[j] - y0, bz = s.z[j] - z0;
        const double cx = s.x[k] - x0, cy = s.y[k] - y0, cz = s.z[k] - z0;
        six_volumes += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
    }
    return six_volumes / 6;
}

}  // namespace thalweg::surface
