// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/surface/minimum_norm_network.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/surface/tension_spline.hpp"

namespace thalweg::surface {
namespace {

constexpr Index vertices_per_piece = 1024;

void check(const TensionMesh& mesh) {
    const std::size_t count = mesh.x.size();
    if (mesh.y.size() != count || mesh.height.size() != count || mesh.tension.size() != count) {
        throw Error(fmt::format("a surface needs x, y, height and tension of each vertex: given are {}, {}, {} and {}",
                                count, mesh.y.size(), mesh.height.size(), mesh.tension.size()));
    }
    for (const std::size_t given : {mesh.given_slope_x.size(), mesh.given_slope_y.size()}) {
        if (given == (mesh.given_slope_x.empty() ? 0 : count)) continue;
        throw Error(
            fmt::format("{} gradients are given for {} vertices: a surface needs one for each, or none", given, count));
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (!std::isfinite(mesh.x[i]) || !std::isfinite(mesh.y[i]) || !std::isfinite(mesh.height[i])) {
            throw Error(fmt::format("vertex {} lies at ({}, {}, {}): a surface needs numbers", i, mesh.x[i], mesh.y[i],
                                    mesh.height[i]));
        }
        if (!(mesh.tension[i] >= 0) || !std::isfinite(mesh.tension[i])) {
            throw Error(fmt::format("vertex {} has tension {}: it must be 0 or more", i, mesh.tension[i]));
        }
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        if (a >= count || b >= count || c >= count || a == b || b == c || c == a) {
            throw Error(
                fmt::format("triangle {} has the corners {}, {} and {}: three different ones under {} are needed", t, a,
                            b, c, count));
        }
    }
}

/// A side of a triangle, kept under its lower vertex.
struct Side {
    Index high;
    Index triangle;
    int opposite;  ///< corner
};

/// The sides of all triangles by their lower vertex: those of vertex i are sides[start[i] … start[i + 1]).
void sort_sides(const TensionMesh& mesh, std::vector<Index>& start, std::vector<Side>& sides) {
    const auto visit = [&](auto put) {
        for (Index t = 0; t < mesh.triangles.size(); ++t) {
            for (int k = 0; k < 3; ++k) {
                const auto [low, high] = std::minmax(mesh.triangles[t][(k + 1) % 3], mesh.triangles[t][(k + 2) % 3]);
                put(low, Side{high, t, k});
            }
        }
    };
    start.assign(mesh.x.size() + 1, 0);
    visit([&](Index low, const Side&) { ++start[low + 1]; });
    std::partial_sum(start.begin(), start.end(), start.begin());
    sides.resize(start.back());
    std::vector<Index> next(start.begin(), start.end() - 1);
    visit([&](Index low, const Side& side) { sides[next[low]++] = side; });
}

/// Each edge once, though two triangles have it.
void number_edges(const TensionMesh& mesh, MinimumNormNetwork& network) {
    std::vector<Index> start;
    std::vector<Side> sides;
    sort_sides(mesh, start, sides);
    network.edges_of_triangle.resize(mesh.triangles.size());
    for (Index low = 0; low < mesh.x.size(); ++low) {
        const auto first = sides.begin() + start[low];
        const auto last = sides.begin() + start[low + 1];
        std::sort(first, last, [](const Side& a, const Side& b) { return a.high < b.high; });
        for (auto side = first; side != last; ++side) {
            if (side == first || side->high != (side - 1)->high) network.edges.push_back({low, side->high});
            network.edges_of_triangle[side->triangle][side->opposite] = static_cast<Index>(network.edges.size() - 1);
        }
    }
}

void add_extra_tension(const TensionMesh& mesh, MinimumNormNetwork& network) {
    for (const ExtraTension& extra : mesh.extra_tension) {
        const std::array<Index, 2> ends{std::min(extra.a, extra.b), std::max(extra.a, extra.b)};
        const auto found = std::lower_bound(network.edges.begin(), network.edges.end(), ends);
        if (found == network.edges.end() || *found != ends) {
            throw Error(
                fmt::format("extra tension between the vertices {} and {}, which no edge joins", extra.a, extra.b));
        }
        network.edge_tension[found - network.edges.begin()] += extra.tension;
    }
}

void set_edge_tension(const TensionMesh& mesh, MinimumNormNetwork& network) {
    for (const auto& [a, b] : network.edges) network.edge_tension.push_back((mesh.tension[a] + mesh.tension[b]) / 2);
    add_extra_tension(mesh, network);
    for (std::size_t e = 0; e < network.edges.size(); ++e) {
        if (network.edge_tension[e] >= 0 && std::isfinite(network.edge_tension[e])) continue;
        throw Error(fmt::format("the edge between the vertices {} and {} has tension {}: it must be 0 or more",
                                network.edges[e][0], network.edges[e][1], network.edge_tension[e]));
    }
}

struct EdgeLine {
    double x, y;    ///< unit vector
    double length;  ///< m
    double chord;   ///< slope
};

EdgeLine line_of(const TensionMesh& mesh, const std::array<Index, 2>& ends) {
    const auto [a, b] = ends;
    const double dx = mesh.x[b] - mesh.x[a];
    const double dy = mesh.y[b] - mesh.y[a];
    const double length = std::sqrt(dx * dx + dy * dy);
    if (!(length > 0)) {
        throw Error(
            fmt::format("the vertices {} and {} of one edge lie in one place, ({}, {})", a, b, mesh.x[a], mesh.y[a]));
    }
    return {dx / length, dy / length, length, (mesh.height[b] - mesh.height[a]) / length};
}

struct Vector {
    double x = 0;
    double y = 0;
};

/// Symmetric 2×2 matrix.
struct Block {
    double xx = 0;
    double xy = 0;
    double yy = 0;

    Vector operator*(const Vector& v) const { return {xx * v.x + xy * v.y, xy * v.x + yy * v.y}; }
};

/// The inverse, or where the edges lie on one line (to 1e-6) the inverse along that line.
Block inverse_of(const Block& a) {
    constexpr double one_line = 1e-12;  // of the squares of the axes
    const double trace = a.xx + a.yy;
    const double determinant = a.xx * a.yy - a.xy * a.xy;
    if (determinant > one_line * trace * trace) {
        return {a.yy / determinant, -a.xy / determinant, a.xx / determinant};
    }
    if (!(trace > 0)) return {};
    return {a.xx / (trace * trace), a.xy / (trace * trace), a.yy / (trace * trace)};
}

/// The system by vertices: row i is own[i] g_i + Σ v (v·g_j) over its edges = right[i].
struct System {
    struct Link {
        Index other;
        Vector v;  ///< √(e/L) û
    };
    std::vector<Block> own;
    std::vector<Block> inverse;
    std::vector<Vector> right;
    std::vector<Index> start;
    std::vector<Link> links;
    double coupling = 0;  ///< the largest e/d

    Index size() const { return static_cast<Index>(own.size()); }
};

/// Room for the links of each vertex.
void lay_out(const MinimumNormNetwork& network, std::size_t vertices, System& system) {
    system.own.resize(vertices);
    system.inverse.resize(vertices);
    system.right.resize(vertices);
    system.start.assign(vertices + 1, 0);
    for (const auto& [a, b] : network.edges) {
        ++system.start[a + 1];
        ++system.start[b + 1];
    }
    std::partial_sum(system.start.begin(), system.start.end(), system.start.begin());
    system.links.resize(system.start.back());
}

bool is_given(const TensionMesh& mesh, std::size_t vertex) {
    return std::isfinite(mesh.given_slope_x[vertex]) && std::isfinite(mesh.given_slope_y[vertex]);
}

System assemble(const TensionMesh& mesh, const MinimumNormNetwork& network) {
    System system;
    lay_out(network, mesh.x.size(), system);
    std::vector<Index> next(system.start.begin(), system.start.end() - 1);
    for (std::size_t e = 0; e < network.edges.size(); ++e) {
        const EdgeLine line = line_of(mesh, network.edges[e]);
        const EdgeEnergy energy = tension_energy(network.edge_tension[e]);
        system.coupling = std::max(system.coupling, energy.cross / energy.own);
        const double own = energy.own / line.length;
        const double right = (energy.own + energy.cross) / line.length * line.chord;
        const double root = std::sqrt(energy.cross / line.length);
        for (int end = 0; end < 2; ++end) {
            const Index here = network.edges[e][end];
            system.own[here].xx += own * line.x * line.x;
            system.own[here].xy += own * line.x * line.y;
            system.own[here].yy += own * line.y * line.y;
            system.right[here].x += right * line.x;
            system.right[here].y += right * line.y;
            system.links[next[here]++] = {network.edges[e][1 - end], {root * line.x, root * line.y}};
        }
    }
    std::transform(system.own.begin(), system.own.end(), system.inverse.begin(), inverse_of);
    for (std::size_t i = 0; i < mesh.given_slope_x.size(); ++i) {
        if (is_given(mesh, i)) system.inverse[i] = {};  // nothing there is corrected
    }
    return system;
}

/// What is missing at a vertex, divided by its own block.
Vector correction_at(const System& system, const std::vector<Vector>& gradient, Index i) {
    const Vector own = system.own[i] * gradient[i];
    Vector missing{system.right[i].x - own.x, system.right[i].y - own.y};
    for (Index at = system.start[i]; at < system.start[i + 1]; ++at) {
        const auto& [other, v] = system.links[at];
        const double along = v.x * gradient[other].x + v.y * gradient[other].y;
        missing.x -= along * v.x;
        missing.y -= along * v.y;
    }
    return system.inverse[i] * missing;
}

/// Rounds of Chebyshev's iteration until the error is under rounding: each multiplies it by
/// (1 − √(1 − coupling²))/coupling.
int rounds_needed(double coupling) {
    constexpr double rounding = 0x1p-58;
    const double rate = coupling / (1 + std::sqrt(1 - coupling * coupling));
    return std::max(1, static_cast<int>(std::ceil(std::log(rounding) / std::log(rate))));
}

/// Largest component of any vector.
double largest(const std::vector<Vector>& vectors) {
    double found = 0;
    for (const Vector& v : vectors) found = std::max({found, std::abs(v.x), std::abs(v.y)});
    return found;
}

/// No gradient, but where it is given.
std::vector<Vector> beginning(const TensionMesh& mesh) {
    std::vector<Vector> gradient(mesh.x.size());
    for (std::size_t i = 0; i < mesh.given_slope_x.size(); ++i) {
        if (is_given(mesh, i)) gradient[i] = {mesh.given_slope_x[i], mesh.given_slope_y[i]};
    }
    return gradient;
}

/// Chebyshev's iteration for eigenvalues in 1 ± coupling (Saad 2003, algorithm 12.1). The
/// residual is computed anew in every round, so that rounding does not add up.
std::vector<Vector> solve(const System& system, std::vector<Vector> gradient, MinimumNormNetwork& network) {
    std::vector<Vector> next = gradient, step(system.size());
    const double coupling = std::clamp(system.coupling, 1e-12, 0.5) * (1 + 1e-9);  // a hair for rounding in the blocks
    network.iterations = rounds_needed(coupling);
    double weight = coupling;
    double carried = 0;  // of the last step
    double added = 1;    // of what is missing
    for (int round = 0; round < network.iterations; ++round) {
        parallel_for(
            0, system.size(),
            [&](Index first, Index last) {
                for (Index i = first; i < last; ++i) {
                    const Vector correction = correction_at(system, gradient, i);
                    step[i] = {carried * step[i].x + added * correction.x, carried * step[i].y + added * correction.y};
                    next[i] = {gradient[i].x + step[i].x, gradient[i].y + step[i].y};
                }
            },
            vertices_per_piece);
        gradient.swap(next);
        const double next_weight = 1 / (2 / coupling - weight);
        carried = next_weight * weight;
        added = 2 * next_weight / coupling;
        weight = next_weight;
    }
    const double size = largest(gradient);
    network.last_change = size > 0 ? largest(step) / size : 0;
    return gradient;
}

}  // namespace

MinimumNormNetwork minimum_norm_network(const TensionMesh& mesh) {
    check(mesh);
    MinimumNormNetwork network;
    number_edges(mesh, network);
    set_edge_tension(mesh, network);
    const System system = assemble(mesh, network);
    const std::vector<Vector> gradient = solve(system, beginning(mesh), network);
    network.slope_x.assign(mesh.x.size(), std::numeric_limits<double>::quiet_NaN());
    network.slope_y = network.slope_x;
    for (Index i = 0; i < system.size(); ++i) {
        if (system.start[i] == system.start[i + 1]) continue;
        network.slope_x[i] = gradient[i].x;
        network.slope_y[i] = gradient[i].y;
    }
    return network;
}

double network_energy(const TensionMesh& mesh, const MinimumNormNetwork& network, std::span<const double> slope_x,
                      std::span<const double> slope_y) {
    double sum = 0;
    for (std::size_t e = 0; e < network.edges.size(); ++e) {
        const auto [a, b] = network.edges[e];
        const EdgeLine line = line_of(mesh, network.edges[e]);
        sum += energy(TensionCurve{.length = line.length,
                                   .start_height = mesh.height[a],
                                   .end_height = mesh.height[b],
                                   .start_slope = slope_x[a] * line.x + slope_y[a] * line.y,
                                   .end_slope = slope_x[b] * line.x + slope_y[b] * line.y,
                                   .tension = network.edge_tension[e]});
    }
    return sum;
}

}  // namespace thalweg::surface
