// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "surface/nodes.hpp"
#include "surface/sides.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/surface/heightfield.hpp"

namespace thalweg::surface {
namespace {

double cross(const Point& a, const Point& b) { return a.x * b.y - a.y * b.x; }
double square(const Point& a) { return a.x * a.x + a.y * a.y; }
Point between(const Point& from, const Point& to) { return {to.x - from.x, to.y - from.y}; }

/// Centre of the circle through the origin, a and b.
Point circumcenter(const Point& a, const Point& b) {
    const double twice = 2 * cross(a, b);
    const double aa = square(a), bb = square(b);
    return {(aa * b.y - bb * a.y) / twice, (bb * a.x - aa * b.x) / twice};
}

/// What does not depend on the place: each triangle's circumcircle, coordinates from the mesh's first node on, so that
/// places far from the origin lose no digits.
struct Circles {
    explicit Circles(const Mesh& mesh) : origin(node_at(mesh, 0)), center(mesh.triangles.size()) {
        parallel_for(0, static_cast<Index>(center.size()), [&](Index first, Index last) {
            for (Index t = first; t < last; ++t) {
                const auto& [i, j, k] = mesh.triangles[t];
                const Point corner = node_at(mesh, i);
                const Point c = circumcenter(between(corner, node_at(mesh, j)), between(corner, node_at(mesh, k)));
                center[t] = {corner.x - origin.x + c.x, corner.y - origin.y + c.y};
            }
        });
    }

    Point origin;
    std::vector<Point> center;
};

struct NaturalNeighbor {
    Index node;
    double area = 0;          ///< twice the area it would lose, signed
    Point in = {}, out = {};  ///< ends of the new cell's edge towards it, counter-clockwise
};

/// Working space of one thread.
struct Scratch {
    std::vector<Index> removed;  ///< triangles
    std::vector<NaturalNeighbor> around;
};

/// Finds the natural neighbours of one place after another.
///
/// A new node at p would remove the triangles whose circumcircles hold p and be joined to the corners of the hole. Node
/// v loses the area between the new cell's edge and the old cells' edges that end at removed triangles' centres. It is
/// summed edge by edge (cross products from p): an old edge between two nodes counts for both, once each way.
class NaturalNeighbors {
  public:
    NaturalNeighbors(const Mesh& mesh, const Circles& circles, const TriangleSides& sides,
                     std::span<const double> values, Scratch& scratch)
        : mesh_(mesh),
          circles_(circles),
          sides_(sides),
          values_(values),
          removed_(scratch.removed),
          around_(scratch.around) {}

    double value_at(const Point& p, Index triangle) {
        for (const Index corner : mesh_.triangles[triangle]) {
            if (node_at(mesh_, corner) == p) return values_[corner];
        }
        place_ = p;
        from_origin_ = between(circles_.origin, p);
        around_.clear();
        collect_removed(triangle);
        double on_edge = 0;
        if (!sum_edges(on_edge)) return on_edge;
        return weighted_mean();
    }

  private:
    Point relative(Index node) const { return between(place_, node_at(mesh_, node)); }
    Point center(Index t) const { return between(from_origin_, circles_.center[t]); }
    bool is_removed(Index t) const { return std::find(removed_.begin(), removed_.end(), t) != removed_.end(); }

    void collect_removed(Index triangle) {
        removed_.assign(1, triangle);
        for (std::size_t i = 0; i < removed_.size(); ++i) {
            for (const Index other : sides_.across(removed_[i])) {
                if (other == none || is_removed(other)) continue;
                const Point c = center(other);
                const Point corner = relative(mesh_.triangles[other][0]);
                if (square(c) < square(between(c, corner))) removed_.push_back(other);
            }
        }
    }

    /// False if the place lies on an edge of the outline: then the value is the one along it.
    bool sum_edges(double& on_edge) {
        for (const Index t : removed_) {
            for (int k = 0; k < 3; ++k) {
                const Index from = mesh_.triangles[t][(k + 1) % 3], to = mesh_.triangles[t][(k + 2) % 3];
                const Index other = sides_.across(t)[k];
                if (other != none && is_removed(other)) {
                    if (t < other) add_edge(from, to, cross(center(t), center(other)));
                } else if (!add_hole_edge(t, from, to, on_edge)) {
                    return false;
                }
            }
        }
        for (NaturalNeighbor& n : around_) n.area += cross(n.in, n.out);
        return true;
    }

    bool add_hole_edge(Index t, Index from, Index to, double& on_edge) {
        constexpr double flat = 1e-11;  // height over length of the edge: nearer to it rounding would rule
        const Point a = relative(from), b = relative(to);
        const double length2 = square(between(a, b));
        if (!(cross(a, b) > flat * length2)) {
            const double share = std::clamp(-(a.x * (b.x - a.x) + a.y * (b.y - a.y)) / length2, 0.0, 1.0);
            on_edge = std::lerp(values_[from], values_[to], share);
            return false;
        }
        const Point fresh = circumcenter(a, b);
        neighbor(from).out = fresh;
        neighbor(to).in = fresh;
        add_edge(from, to, cross(center(t), fresh));
        return true;
    }

    /// The edge between the cells of two nodes, which leaves the triangle over the side from–to: along it the cell of
    /// `to` lies on the left.
    void add_edge(Index from, Index to, double twice_area) {
        neighbor(from).area -= twice_area;
        neighbor(to).area += twice_area;
    }

    NaturalNeighbor& neighbor(Index node) {
        for (NaturalNeighbor& n : around_) {
            if (n.node == node) return n;
        }
        return around_.emplace_back(NaturalNeighbor{.node = node});
    }

    /// Differences from one value, so that a constant stays itself.
    double weighted_mean() const {
        const double origin = values_[around_.front().node];
        double lowest = origin, highest = origin, area = 0, sum = 0;
        for (const NaturalNeighbor& n : around_) {
            area += n.area;
            sum += n.area * (values_[n.node] - origin);
            lowest = std::min(lowest, values_[n.node]);
            highest = std::max(highest, values_[n.node]);
        }
        return std::clamp(origin + sum / area, lowest, highest);
    }

    const Mesh& mesh_;
    const Circles& circles_;
    const TriangleSides& sides_;
    std::span<const double> values_;
    Point place_, from_origin_;
    std::vector<Index>& removed_;
    std::vector<NaturalNeighbor>& around_;
};

}  // namespace

void interpolate_natural(const Mesh& mesh, std::span<const double> node_values, Raster& raster) {
    check_one_value_per_node(mesh, node_values);
    raster.values.assign(raster.grid.size(), std::numeric_limits<double>::quiet_NaN());
    if (mesh.triangles.empty()) return;
    const Circles circles(mesh);
    const TriangleSides sides(mesh.size(), mesh.triangles);
    cover(plane_of(mesh), raster, [&](const Claim& claim) {
        thread_local Scratch scratch;
        NaturalNeighbors around(mesh, circles, sides, node_values, scratch);
        for (const Index cell : claim.cells) {
            const Point center = raster.placement.center(raster.grid.row(cell), raster.grid.col(cell));
            raster.values[cell] = around.value_at(center, claim.triangle);
        }
    });
}

}  // namespace thalweg::surface
