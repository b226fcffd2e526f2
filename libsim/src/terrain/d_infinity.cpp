// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/terrain/d_infinity.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "terrain/check_sizes.hpp"
#include "terrain/compressed_flow.hpp"
#include "terrain/row_lengths.hpp"
#include "terrain/water.hpp"
#include "thalweg/core/parallel.hpp"

namespace thalweg::terrain {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A facet: the cell, a straight and a diagonal neighbour. Numbered clockwise from the east; the even ones turn
/// clockwise from their straight edge.
struct Facet {
    Slot straight, diagonal;
};
constexpr std::array<Facet, 8> facets{{{0, 1}, {2, 1}, {2, 3}, {4, 3}, {4, 5}, {6, 5}, {6, 7}, {0, 7}}};

/// Lengths of a row's facets, m, and the angles they span at the cell, radians.
struct RowFacets {
    std::array<double, 8> length{};   // by slot
    std::array<double, 8> outer{};    // by facet: between the two neighbours
    std::array<double, 8> opening{};  // by facet
};

RowFacets facets_of_row(const Grid& grid, Index row) {
    RowFacets of{.length = row_lengths(grid, row)};
    for (std::size_t f = 0; f < 8; ++f) {
        const auto [straight, diagonal] = facets[f];
        const Index other_row = row + Grid::row_step[diagonal];
        if (other_row >= grid.rows) continue;
        of.outer[f] = straight % 4 == 0 ? of.length[diagonal < 4 ? 2 : 6] : grid.east_west[other_row];
        of.opening[f] = std::atan2(of.outer[f], of.length[straight]);
    }
    return of;
}

/// Where the water of a cell goes: to one neighbour (the other slot is `no_flow`) or to both of a facet.
struct CellFlow {
    std::size_t facet = 0;
    Slot straight = no_flow, diagonal = no_flow;
    double turn = 0;  ///< radians from the straight neighbour towards the diagonal one
    double slope = 0;
};

/// Flow down one facet, of slope 0 or less where it does not fall. Beside a void it is the neighbour that there is.
CellFlow down_facet(const RowFacets& of, std::size_t f, double e0, double e1, double e2) {
    const auto [straight, diagonal] = facets[f];
    const double d1 = of.length[straight];
    const double d2 = of.outer[f];
    const double s1 = (e0 - e1) / d1;
    const double s2 = (e1 - e2) / d2;
    if (std::isnan(e1) || (s2 > 0 && s1 * d2 <= s2 * d1)) {
        return {f, no_flow, diagonal, of.opening[f], (e0 - e2) / of.length[diagonal]};
    }
    if (!(s2 > 0)) return {f, straight, no_flow, 0, s1};
    return {f, straight, diagonal, std::atan2(s2, s1), std::sqrt(s1 * s1 + s2 * s2)};
}

CellFlow steepest_facet(const Grid& grid, const RowFacets& of, const double* ground, Index node) {
    std::array<double, 8> around;
    around.fill(nan);
    grid.neighbors(node, [&](Index neighbor, double, Slot slot) { around[slot] = ground[neighbor]; });
    CellFlow steepest;
    for (std::size_t f = 0; f < 8; ++f) {
        const CellFlow flow = down_facet(of, f, ground[node], around[facets[f].straight], around[facets[f].diagonal]);
        if (flow.slope > steepest.slope) steepest = flow;
    }
    return steepest;
}

CellFlow follow(const RowFacets& of, Slot single) {
    CellFlow flow;
    if (single == no_flow) return flow;
    (single % 2 == 0 ? flow.straight : flow.diagonal) = single;
    while (facets[flow.facet].straight != single && facets[flow.facet].diagonal != single) ++flow.facet;
    if (single % 2 == 1) {
        while (facets[flow.facet].straight % 4 != 0 || facets[flow.facet].diagonal != single) ++flow.facet;
        flow.turn = of.opening[flow.facet];
    }
    return flow;
}

/// Flow of a cell with the water level minded: only neighbours with a lower level are receivers.
CellFlow flow_of_cell(const Grid& grid, const RowFacets& of, const Water& water, Index node) {
    const Slot single = water.single()[node];
    if (!water.may_divide(node)) return follow(of, single);
    CellFlow flow = steepest_facet(grid, of, water.ground(), node);
    const auto takes = [&](Slot slot) { return slot != no_flow && water.takes_from(grid.neighbor(node, slot), node); };
    const bool straight = takes(flow.straight);
    const bool diagonal = takes(flow.diagonal);
    if (straight && diagonal) return flow;
    if (straight) return follow(of, flow.straight);
    return follow(of, diagonal ? flow.diagonal : single);
}

SlotBits bit(Slot slot) { return slot == no_flow ? SlotBits{0} : static_cast<SlotBits>(1U << slot); }

template <class Visit>
void visit_cells(const Grid& grid, std::span<const double> elevation_m, const FlowDirections& single, Visit visit) {
    check_sizes(grid.size(), elevation_m.size(), single.size());
    const Water water(grid, elevation_m, single);
    const auto rows = [&](Index first, Index last) {
        for (Index row = first; row < last; ++row) {
            const RowFacets of = facets_of_row(grid, row);
            for (Index node = row * grid.cols; node < (row + 1) * grid.cols; ++node) {
                visit(node, of, flow_of_cell(grid, of, water, node));
            }
        }
    };
    parallel_for(0, grid.rows, rows, std::max<Index>(1, 16384 / grid.cols));
}

/// Shares of the nodes [first, last): the straight neighbour, of even slot, gets `to_straight`, the other one the rest.
void write_shares(std::span<const SlotBits> bits, std::span<const double> to_straight, Index first, Index last,
                  MultipleFlow& flow) {
    for (Index node = first; node < last; ++node) {
        const Index at = flow.offset[node];
        const Index count = flow.offset[node + 1] - at;
        if (count == 1) flow.share[at] = 1;
        if (count != 2) continue;
        const bool straight_first = std::countr_zero(static_cast<unsigned>(bits[node])) % 2 == 0;
        flow.share[at] = straight_first ? to_straight[node] : 1 - to_straight[node];
        flow.share[at + 1] = 1 - flow.share[at];
    }
}

}  // namespace

MultipleFlow d_infinity(const Grid& grid, std::span<const double> elevation_m, const FlowDirections& single) {
    std::vector<SlotBits> bits(grid.size());
    std::vector<double> to_straight(grid.size());
    visit_cells(grid, elevation_m, single, [&](Index node, const RowFacets& of, const CellFlow& cell) {
        bits[node] = bit(cell.straight) | bit(cell.diagonal);
        to_straight[node] = std::max(0.0, 1 - cell.turn / of.opening[cell.facet]);
    });
    MultipleFlow flow;
    write_receivers(
        grid, bits, [&](Index first, Index last) { write_shares(bits, to_straight, first, last, flow); }, flow);
    write_order(elevation_m, flow);
    return flow;
}

std::vector<double> d_infinity_angle(const Grid& grid, std::span<const double> elevation_m,
                                     const FlowDirections& single) {
    constexpr double full = 2 * std::numbers::pi;
    std::vector<double> angle(grid.size(), nan);
    visit_cells(grid, elevation_m, single, [&](Index node, const RowFacets&, const CellFlow& cell) {
        if (cell.straight == no_flow && cell.diagonal == no_flow) return;
        const double edge = full - 0.25 * std::numbers::pi * facets[cell.facet].straight;  // slots run clockwise
        const double direction = cell.facet % 2 == 0 ? edge - cell.turn : edge + cell.turn;
        angle[node] = direction >= full ? direction - full : direction;
    });
    return angle;
}

}  // namespace thalweg::terrain
