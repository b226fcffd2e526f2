// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "surface/nodes.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/surface/heightfield.hpp"

namespace thalweg::surface {
namespace {

/// Of the exponents, beyond the nearest node's, up to which nodes count: 5 σ where the nearest is at hand.
constexpr double most_exponent = 12.5;

/// The nodes in square buckets, about as many as there are nodes; in each bucket ascending.
struct NodeBuckets {
    double west, south, size;
    Index cols, rows;
    std::vector<Index> start;
    std::vector<Index> nodes;

    Index col(double x) const { return place(x - west, cols); }
    Index row(double y) const { return place(y - south, rows); }
    Index bucket(const Point& p) const { return row(p.y) * cols + col(p.x); }

  private:
    Index place(double distance, Index count) const {
        return static_cast<Index>(std::clamp(std::floor(distance / size), 0.0, count - 1.0));
    }
};

NodeBuckets buckets_of(const Mesh& mesh) {
    const auto [west, east] = std::minmax_element(mesh.x.begin(), mesh.x.end());
    const auto [south, north] = std::minmax_element(mesh.y.begin(), mesh.y.end());
    const double width = *east - *west;
    const double height = *north - *south;
    const double wanted = std::sqrt(width * height / mesh.size());
    const double size = std::max({wanted, std::max(width, height) / 1e4, std::numeric_limits<double>::min()});
    NodeBuckets b{.west = *west, .south = *south, .size = size, .cols = 1, .rows = 1, .start = {}, .nodes = {}};
    b.cols = static_cast<Index>(width / size) + 1;
    b.rows = static_cast<Index>(height / size) + 1;
    b.start.assign(std::size_t{b.cols} * b.rows + 1, 0);
    for (Index node = 0; node < mesh.size(); ++node) ++b.start[b.bucket(node_at(mesh, node)) + 1];
    std::partial_sum(b.start.begin(), b.start.end(), b.start.begin());
    b.nodes.resize(mesh.size());
    std::vector<Index> next(b.start.begin(), b.start.end() - 1);
    for (Index node = 0; node < mesh.size(); ++node) b.nodes[next[b.bucket(node_at(mesh, node))]++] = node;
    return b;
}

/// Weighted differences from the nearest node's value: a constant stays itself, and no weight underflows.
class GaussianMean {
  public:
    GaussianMean(const Mesh& mesh, std::span<const double> values, double sigma)
        : mesh_(mesh), values_(values), twice_variance_(2 * sigma * sigma), buckets_(buckets_of(mesh)) {}

    double at(const Point& p, Index nearest) const {
        const double nearest2 = distance2(node_at(mesh_, nearest), p);
        const double reach2 = nearest2 + most_exponent * twice_variance_;
        const double reach = std::sqrt(reach2);
        const Index last_row = buckets_.row(p.y + reach), last_col = buckets_.col(p.x + reach);
        Sums sums{.lowest = values_[nearest], .highest = values_[nearest]};
        for (Index row = buckets_.row(p.y - reach); row <= last_row; ++row) {
            const Index first = row * buckets_.cols + buckets_.col(p.x - reach);
            const Index last = row * buckets_.cols + last_col;
            for (Index i = buckets_.start[first]; i < buckets_.start[last + 1]; ++i) {
                add(buckets_.nodes[i], p, nearest2, reach2, values_[nearest], sums);
            }
        }
        return std::clamp(values_[nearest] + sums.difference / sums.weight, sums.lowest, sums.highest);
    }

  private:
    struct Sums {
        double weight = 0, difference = 0;
        double lowest, highest;  ///< of the values, against rounding
    };

    void add(Index node, const Point& p, double nearest2, double reach2, double origin, Sums& sums) const {
        const double square = distance2(node_at(mesh_, node), p);
        if (!(square <= reach2)) return;
        const double weight = std::exp((nearest2 - square) / twice_variance_);
        sums.weight += weight;
        sums.difference += weight * (values_[node] - origin);
        sums.lowest = std::min(sums.lowest, values_[node]);
        sums.highest = std::max(sums.highest, values_[node]);
    }

    const Mesh& mesh_;
    std::span<const double> values_;
    double twice_variance_;
    NodeBuckets buckets_;
};

}  // namespace

void interpolate_gaussian(const Mesh& mesh, std::span<const double> node_values, double sigma_m, Raster& raster) {
    check_one_value_per_node(mesh, node_values);
    if (!(sigma_m > 0) || !std::isfinite(sigma_m)) {
        throw Error(fmt::format("Gaussian weights need a standard deviation above 0 m, not {}", sigma_m));
    }
    raster.values.assign(raster.grid.size(), std::numeric_limits<double>::quiet_NaN());
    if (mesh.size() == 0) return;
    const GaussianMean mean(mesh, node_values, sigma_m);
    cover(plane_of(mesh), raster, [&](const Claim& claim) {
        for (const Index cell : claim.cells) {
            const Point center = raster.placement.center(raster.grid.row(cell), raster.grid.col(cell));
            raster.values[cell] = mean.at(center, walk_to_nearest(mesh, mesh.triangles[claim.triangle], center));
        }
    });
}

}  // namespace thalweg::surface
