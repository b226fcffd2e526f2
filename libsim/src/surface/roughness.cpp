// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/surface/roughness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "surface/coverage.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/core/random.hpp"

namespace thalweg::surface {
namespace {

/// A vertex of the subdivision: who it is, and how far it is displaced.
struct Vertex {
    std::uint64_t name;
    double height = 0;
};

/// A triangle on the way down; edge k lies opposite to corner k.
struct Piece {
    std::array<Vertex, 3> corner;
    std::array<double, 3> length;     ///< of the edges, m
    std::array<double, 3> deviation;  ///< of the displacements of their middles, m
};

std::uint32_t low(std::uint64_t bits) { return static_cast<std::uint32_t>(bits); }
std::uint32_t high(std::uint64_t bits) { return static_cast<std::uint32_t>(bits >> 32); }

/// The middle of an edge, the same from both of its ends.
Vertex middle_of(const Vertex& a, const Vertex& b, double deviation, std::uint64_t seed) {
    const auto [first, second] = std::minmax(a.name, b.name);
    const auto bits = philox({low(first), high(first), low(second), high(second)}, {low(seed), high(seed)});
    // One draw names the vertex and displaces it (Box & Muller 1958).
    const double u = (bits[2] + 0.5) * 0x1p-32, v = bits[3] * 0x1p-32;
    const double normal = std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
    return {(std::uint64_t{bits[0]} << 32) | bits[1], (a.height + b.height) / 2 + deviation * normal};
}

class Roughness {
  public:
    Roughness(const Mesh& mesh, std::span<const double> share, const FractalRoughness& how)
        : mesh_(mesh),
          share_(share),
          how_(how),
          finer_(std::pow(0.5, how.hurst)),
          middle_(std::sqrt((std::pow(0.25, how.hurst) - 0.25) / 1.5)) {}

    /// At a place in a triangle by its unnormalised barycentric coordinates.
    double at(Index triangle, std::array<double, 3> b) const {
        const double sum = b[0] + b[1] + b[2];
        for (double& coordinate : b) coordinate /= sum;
        const auto& t = mesh_.triangles[triangle];
        const double share = b[0] * share_[t[0]] + b[1] * share_[t[1]] + b[2] * share_[t[2]];
        if (share == 0) return 0;
        Piece piece = whole(t);
        while (std::max({piece.length[0], piece.length[1], piece.length[2]}) > how_.finest_m) descend(piece, b);
        return share * (b[0] * piece.corner[0].height + b[1] * piece.corner[1].height + b[2] * piece.corner[2].height);
    }

  private:
    Piece whole(const std::array<Index, 3>& t) const {
        Piece piece{};
        for (int k = 0; k < 3; ++k) {
            const Index i = t[(k + 1) % 3], j = t[(k + 2) % 3];
            piece.corner[k] = {t[k]};
            piece.length[k] = std::hypot(mesh_.x[j] - mesh_.x[i], mesh_.y[j] - mesh_.y[i]);
            piece.deviation[k] = middle_ * how_.amplitude_m * std::pow(piece.length[k] / how_.reference_m, how_.hurst);
        }
        return piece;
    }

    Vertex middle(const Piece& piece, int k) const {
        const double deviation = piece.length[k] > how_.finest_m ? piece.deviation[k] : 0;
        return middle_of(piece.corner[(k + 1) % 3], piece.corner[(k + 2) % 3], deviation, how_.seed);
    }

    /// To the one of the four parts that holds the place: edges keep their directions and halve.
    void descend(Piece& piece, std::array<double, 3>& b) const {
        int corner = 0;
        while (corner < 3 && b[corner] < 0.5) ++corner;
        std::array<Vertex, 3> next;
        for (int k = 0; k < 3; ++k)
            next[k] = k == corner ? piece.corner[k] : middle(piece, corner == 3 ? k : third(k, corner));
        piece.corner = next;
        for (int k = 0; k < 3; ++k) {
            b[k] = corner == 3 ? 1 - 2 * b[k] : 2 * b[k] - (k == corner ? 1 : 0);
            piece.length[k] /= 2;
            piece.deviation[k] *= finer_;
        }
    }

    /// The part at a corner has there where corner k was the middle of the edge between the two: opposite to the third.
    static int third(int k, int corner) { return 3 - k - corner; }

    const Mesh& mesh_;
    std::span<const double> share_;
    FractalRoughness how_;
    double finer_;   ///< deviation of edges half as long
    double middle_;  ///< deviation of the middle of an edge, in that of its ends' difference
};

void check(const Mesh& mesh, std::span<const double> share, const FractalRoughness& how) {
    if (share.size() != mesh.x.size()) {
        throw Error(fmt::format("roughness: {} shares for {} vertices", share.size(), mesh.x.size()));
    }
    if (!(how.hurst > 0 && how.hurst < 1)) {
        throw Error(fmt::format("roughness: a Hurst exponent lies between 0 and 1, and {} does not", how.hurst));
    }
    const bool has_sizes = how.finest_m > 0 && how.reference_m > 0 && how.amplitude_m >= 0;
    if (!has_sizes || !std::isfinite(how.amplitude_m)) {
        throw Error(fmt::format("roughness: an amplitude of {} m over {} m, down to {} m, is none", how.amplitude_m,
                                how.reference_m, how.finest_m));
    }
}

Triangulation plane_of(const Mesh& mesh) { return {mesh.x, mesh.y, mesh.triangles}; }

}  // namespace

void add_roughness(const Mesh& mesh, std::span<const double> share, const FractalRoughness& how, Raster& raster) {
    check(mesh, share, how);
    const Roughness rough(mesh, share, how);
    cover(plane_of(mesh), raster, [&](const Claim& claim) {
        for (std::size_t i = 0; i < claim.cells.size(); ++i) {
            raster.values[claim.cells[i]] += rough.at(claim.triangle, {claim.at[0][i], claim.at[1][i], claim.at[2][i]});
        }
    });
}

std::vector<double> roughness_at(const Mesh& mesh, std::span<const double> share, const FractalRoughness& how,
                                 std::span<const Point> points) {
    check(mesh, share, how);
    const Roughness rough(mesh, share, how);
    const std::vector<Index> triangle = triangle_of_points(plane_of(mesh), points);
    std::vector<double> heights(points.size(), std::numeric_limits<double>::quiet_NaN());
    parallel_for(
        0, static_cast<Index>(points.size()),
        [&](Index first, Index last) {
            for (Index i = first; i < last; ++i) {
                if (triangle[i] == none) continue;
                std::array<double, 3> at =
                    TriangleTest(plane_of(mesh), mesh.triangles[triangle[i]]).coordinates(points[i]);
                for (double& coordinate : at) coordinate = std::max(coordinate, 0.0);
                heights[i] = rough.at(triangle[i], at);
            }
        },
        256);
    return heights;
}

}  // namespace thalweg::surface
