// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/compressed_flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "terrain/row_lengths.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"

namespace thalweg::terrain {
namespace {

constexpr std::uint8_t placed = 255;

/// How many donors each node has.
std::vector<std::uint8_t> count_donors(const MultipleFlow& flow) {
    std::vector<std::uint8_t> donors(flow.size(), 0);
    for (const Index receiver : flow.receiver) ++donors[receiver];
    return donors;
}

void write_row(const Grid& grid, Index row, std::span<const SlotBits> bits, MultipleFlow& flow) {
    const std::array<double, 8> of_slot = row_lengths(grid, row);
    const Index first = row * grid.cols;
    Index at = flow.offset[first];
    for (Index node = first; node < first + grid.cols; ++node) {
        for (unsigned left = bits[node]; left != 0; left &= left - 1) {
            const Slot slot = static_cast<Slot>(std::countr_zero(left));
            flow.receiver[at] = grid.neighbor(node, slot);
            flow.length[at] = of_slot[slot];
            ++at;
        }
    }
}

}  // namespace

void lay_out(std::span<const std::uint8_t> receivers_of, MultipleFlow& flow) {
    flow.offset.resize(receivers_of.size() + 1);
    std::uint64_t total = 0;
    for (std::size_t node = 0; node < receivers_of.size(); ++node) {
        flow.offset[node] = static_cast<Index>(total);
        total += receivers_of[node];
    }
    if (total >= none) {
        throw Error(
            fmt::format("multiple flow on {} nodes has {} receivers, more than 32-bit numbers can name: use a "
                        "coarser terrain or single flow",
                        receivers_of.size(), total));
    }
    flow.offset.back() = static_cast<Index>(total);
    flow.receiver.resize(total);
    flow.length.resize(total);
    flow.share.resize(total);
}

void write_receivers(const Grid& grid, std::span<const SlotBits> bits, const std::function<void(Index, Index)>& shares,
                     MultipleFlow& flow) {
    std::vector<std::uint8_t> receivers_of(bits.size());
    for (std::size_t i = 0; i < bits.size(); ++i) receivers_of[i] = static_cast<std::uint8_t>(std::popcount(bits[i]));
    lay_out(receivers_of, flow);
    const auto rows = [&](Index first_row, Index last_row) {
        for (Index row = first_row; row < last_row; ++row) {
            write_row(grid, row, bits, flow);
            shares(row * grid.cols, (row + 1) * grid.cols);
        }
    };
    parallel_for(0, grid.rows, rows, std::max<Index>(1, 16384 / grid.cols));
}

namespace {

/// Asks for the receivers of a node that comes soon.
[[gnu::always_inline]] inline void fetch_receivers(const MultipleFlow& flow, Index node) {
    const Index first = flow.offset[node];
    __builtin_prefetch(flow.receiver.data() + first);
    __builtin_prefetch(flow.share.data() + first);
}

/// From the nodes without donors down as far as all donors of a node have come by: donors before receivers, so the list
/// is filled in from its end, and is its own queue. The nodes without donors are taken in pieces, which keeps together
/// in memory what the queue holds at a time.
template <class Arrive>
void order_nodes(std::span<const double> elevation_m, MultipleFlow& flow, Arrive arrive) {
    constexpr Index piece = 4096;
    constexpr Index ahead = 16;
    std::vector<std::uint8_t> awaited = count_donors(flow);
    flow.order.resize(flow.size());
    Index* const order = flow.order.data();
    Index free = flow.size();  // the queue: order[free … next), its head at the end
    Index next = free;
    for (Index leaf = 0; leaf < flow.size();) {
        const Index end = std::min<std::uint64_t>(std::uint64_t{leaf} + piece, flow.size());
        for (; leaf < end; ++leaf) {
            if (awaited[leaf] == 0 && !std::isnan(elevation_m[leaf])) order[--free] = leaf;
        }
        while (next > free) {
            if (next > free + 2 * ahead) __builtin_prefetch(&flow.offset[order[next - 1 - 2 * ahead]]);
            if (next > free + ahead) fetch_receivers(flow, order[next - 1 - ahead]);
            const Index node = order[--next];
            awaited[node] = placed;
            for (Index at = flow.offset[node]; at < flow.offset[node + 1]; ++at) {
                const Index receiver = flow.receiver[at];
                arrive(node, receiver, flow.share[at]);
                order[free - 1] = receiver;  // kept only if nothing more is awaited there: no branch to mispredict
                free -= --awaited[receiver] == 0;
            }
        }
    }
    flow.order.erase(flow.order.begin(), flow.order.begin() + free);
}

}  // namespace

void write_order(std::span<const double> elevation_m, MultipleFlow& flow, std::span<double> upstream) {
    if (upstream.empty()) {
        order_nodes(elevation_m, flow, [](Index, Index, double) {});
        return;
    }
    for (std::size_t node = 0; node < upstream.size(); ++node) {
        if (std::isnan(elevation_m[node])) upstream[node] = 0;
    }
    order_nodes(elevation_m, flow,
                [=](Index node, Index receiver, double share) { upstream[receiver] += share * upstream[node]; });
}

}  // namespace thalweg::terrain
