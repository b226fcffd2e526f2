// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/multiple_flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ranges>

#include "terrain/check_sizes.hpp"
#include "terrain/compressed_flow.hpp"
#include "terrain/water.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/power.hpp"

namespace thalweg::terrain {
namespace {

SlotBits bits_of_single(Slot slot) { return slot == no_flow ? SlotBits{0} : static_cast<SlotBits>(1U << slot); }

SlotBits bits_of_cell(const Grid& grid, const Water& water, Index node) {
    unsigned bits = 0;
    if (water.may_divide(node)) {
        grid.neighbors(node, [&](Index neighbor, double, Slot slot) {
            if (water.takes_from(neighbor, node)) bits |= 1U << slot;
        });
    }
    return bits == 0 ? bits_of_single(water.single()[node]) : static_cast<SlotBits>(bits);
}

/// Receivers of an inner row's inner columns. Sums of selects, so that the loop vectorises; cells that follow `single`
/// are mended afterwards.
void compare_row(const double* ground, const double* level, Index cols, SlotBits* out) {
    constexpr double nobody = -std::numeric_limits<double>::infinity();
    const double* above = level - cols;
    const double* below = level + cols;
    for (Index c = 1; c + 1 < cols; ++c) {
        const double height = ground[c] == level[c] ? ground[c] : nobody;
        std::int64_t bits = 0;
        const auto offer = [&](double neighbor, std::int64_t bit) {
            bits |= -static_cast<std::int64_t>(neighbor < height) & bit;
        };
        offer(level[c + 1], 1);
        offer(below[c + 1], 2);
        offer(below[c], 4);
        offer(below[c - 1], 8);
        offer(level[c - 1], 16);
        offer(above[c - 1], 32);
        offer(above[c], 64);
        offer(above[c + 1], 128);
        out[c] = static_cast<SlotBits>(bits);
    }
}

void receivers_in_row(const Grid& grid, const Water& water, Index row, std::vector<SlotBits>& bits) {
    const std::size_t first = std::size_t{row} * grid.cols;
    const auto at = [&](std::size_t node) { bits[node] = bits_of_cell(grid, water, static_cast<Index>(node)); };
    if (row == 0 || row + 1 == grid.rows || grid.cols < 3) {
        for (std::size_t node = first; node < first + grid.cols; ++node) at(node);
        return;
    }
    compare_row(water.ground() + first, water.level() + first, grid.cols, bits.data() + first);
    at(first);
    at(first + grid.cols - 1);
    const Slot* single = water.single().data();
    for (std::size_t node = first + 1; node + 1 < first + grid.cols; ++node) {
        const bool follows = bits[node] == 0 || single[node] == no_flow;
        if (follows) bits[node] = bits_of_single(single[node]);
    }
}

std::vector<SlotBits> receiver_bits(const Grid& grid, const Water& water) {
    std::vector<SlotBits> bits(grid.size());
    const auto rows = [&](Index first, Index last) {
        for (Index row = first; row < last; ++row) receivers_in_row(grid, water, row, bits);
    };
    parallel_for(0, grid.rows, rows, std::max<Index>(1, 16384 / grid.cols));
    return bits;
}

/// S^p of each receiver over that of the node's steepest one, by logarithms: no power leaves the range of doubles.
/// What would fall under 2^-1000 becomes that, so that no share is 0. Loops without branches, which vectorise.
void raise_slopes(double exponent, Index first, Index last, MultipleFlow& flow) {
    const std::span<double> powers = std::span(flow.share).subspan(flow.offset[first]);
    const std::size_t count = flow.offset[last] - flow.offset[first];
    for (std::size_t i = 0; i < count; ++i) {
        const LogarithmOfTwo logarithm = precise_log2(powers[i]);
        powers[i] = logarithm.high + logarithm.low;
    }
    for (Index node = first; node < last; ++node) {
        double steepest = -std::numeric_limits<double>::infinity();
        for (Index at = flow.offset[node]; at < flow.offset[node + 1]; ++at) {
            steepest = flow.share[at] > steepest ? flow.share[at] : steepest;
        }
        for (Index at = flow.offset[node]; at < flow.offset[node + 1]; ++at) {
            flow.share[at] = exponent * (flow.share[at] - steepest);
        }
    }
    for (std::size_t i = 0; i < count; ++i) powers[i] = precise_exp2(powers[i] > -1000 ? powers[i] : -1000, 0);
}

/// Shares of the nodes [first, last), whose receivers and lengths are known.
void divide(const double* ground, Division division, Index first, Index last, MultipleFlow& flow) {
    constexpr double gentlest = 1e-290;  // a slope that would underflow still counts as one
    const bool quinn = division.contour == Division::Contour::quinn;
    for (Index node = first; node < last; ++node) {
        for (Index at = flow.offset[node]; at < flow.offset[node + 1]; ++at) {
            const double slope = (ground[node] - ground[flow.receiver[at]]) / flow.length[at];
            flow.share[at] = slope > gentlest ? slope : gentlest;
        }
    }
    if (division.exponent != 1) raise_slopes(division.exponent, first, last, flow);
    for (Index node = first; node < last; ++node) {
        double sum = 0;
        for (Index at = flow.offset[node]; at < flow.offset[node + 1]; ++at) {
            if (quinn) flow.share[at] /= flow.length[at];
            sum += flow.share[at];
        }
        const double per_sum = 1 / sum;
        for (Index at = flow.offset[node]; at < flow.offset[node + 1]; ++at) flow.share[at] *= per_sum;
    }
}

void write_flow(const Grid& grid, const Water& water, Division division, MultipleFlow& flow) {
    write_receivers(
        grid, receiver_bits(grid, water),
        [&](Index first, Index last) { divide(water.ground(), division, first, last, flow); }, flow);
}

/// Calls visit(neighbor, length_m) for each receiver of a mesh node.
template <class Visit>
void visit_receivers(const Mesh& mesh, const Water& water, Index node, Visit visit) {
    const Slot single = water.single()[node];
    if (single == no_flow) return;
    bool divides = false;
    if (water.may_divide(node)) {
        mesh.neighbors(node, [&](Index neighbor, double length_m, Slot) {
            if (!water.takes_from(neighbor, node)) return;
            divides = true;
            visit(neighbor, length_m);
        });
    }
    if (!divides) visit(mesh.neighbor(node, single), mesh.length(node, single));
}

void write_flow(const Mesh& mesh, const Water& water, Division division, MultipleFlow& flow) {
    std::vector<std::uint8_t> receivers_of(mesh.size(), 0);
    parallel_for(0, mesh.size(), [&](Index first, Index last) {
        for (Index node = first; node < last; ++node) {
            visit_receivers(mesh, water, node, [&](Index, double) { ++receivers_of[node]; });
        }
    });
    lay_out(receivers_of, flow);
    parallel_for(0, mesh.size(), [&](Index first, Index last) {
        for (Index node = first; node < last; ++node) {
            Index at = flow.offset[node];
            visit_receivers(mesh, water, node, [&](Index receiver, double length_m) {
                flow.receiver[at] = receiver;
                flow.length[at++] = length_m;
            });
        }
        divide(water.ground(), division, first, last, flow);
    });
}

template <Topology T>
void flow_into(const T& topology, std::span<const double> elevation_m, const FlowDirections& single, Division division,
               MultipleFlow& into, std::span<double> upstream = {}) {
    if (!upstream.empty()) check_sizes(topology.size(), upstream.size(), upstream.size());
    check_sizes(topology.size(), elevation_m.size(), single.size());
    if (!(division.exponent > 0 && std::isfinite(division.exponent))) {
        throw Error(fmt::format("the exponent of multiple flow must be a positive number, not {}", division.exponent));
    }
    const Water water(topology, elevation_m, single);
    write_flow(topology, water, division, into);
    write_order(elevation_m, into, upstream);
}

template <Topology T>
std::vector<double> levels(const T& topology, std::span<const double> elevation_m, const FlowDirections& single,
                           std::span<const Index> order) {
    check_sizes(topology.size(), elevation_m.size(), single.size());
    std::vector<double> level(elevation_m.begin(), elevation_m.end());
    raise_to_water_level(topology, single, order, level);
    return level;
}

}  // namespace

MultipleFlow multiple_flow(const Grid& grid, std::span<const double> elevation_m, const FlowDirections& single,
                           Division division) {
    MultipleFlow flow;
    flow_into(grid, elevation_m, single, division, flow);
    return flow;
}

MultipleFlow multiple_flow(const Mesh& mesh, std::span<const double> elevation_m, const FlowDirections& single,
                           Division division) {
    MultipleFlow flow;
    flow_into(mesh, elevation_m, single, division, flow);
    return flow;
}

void multiple_flow(const Grid& grid, std::span<const double> elevation_m, const FlowDirections& single,
                   Division division, MultipleFlow& into, std::span<double> upstream) {
    flow_into(grid, elevation_m, single, division, into, upstream);
}

void multiple_flow(const Mesh& mesh, std::span<const double> elevation_m, const FlowDirections& single,
                   Division division, MultipleFlow& into, std::span<double> upstream) {
    flow_into(mesh, elevation_m, single, division, into, upstream);
}

std::vector<double> accumulate(const MultipleFlow& flow, std::span<const double> amount) {
    check_sizes(flow.size(), amount.size(), amount.size());
    std::vector<double> sum(flow.size(), 0.0);
    for (const Index node : std::views::reverse(flow.order)) {
        sum[node] += amount[node];
        flow.receivers(node, [&](Index receiver, double, double share) { sum[receiver] += share * sum[node]; });
    }
    return sum;
}

std::vector<double> water_level(const Grid& grid, std::span<const double> elevation_m, const FlowDirections& single,
                                std::span<const Index> order) {
    return levels(grid, elevation_m, single, order);
}

std::vector<double> water_level(const Mesh& mesh, std::span<const double> elevation_m, const FlowDirections& single,
                                std::span<const Index> order) {
    return levels(mesh, elevation_m, single, order);
}

}  // namespace thalweg::terrain
