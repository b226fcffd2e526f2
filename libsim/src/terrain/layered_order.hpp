// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "terrain/blocks.hpp"
#include "terrain/donors.hpp"
#include "terrain/downhill.hpp"
#include "thalweg/terrain/graph.hpp"

namespace thalweg::terrain {

/// Memory that the ordering needs; kept from step to step it is allocated once.
struct OrderBuffers {
    std::vector<std::uint8_t> awaited;  ///< donors that have not passed yet
    std::vector<Index> queue;           ///< of each block in turn, from its end: donors before receivers
};

namespace detail {

/// What one block, or the trunk below them all, has put in order. Positions are counted in its own list, receivers
/// first.
struct Part {
    std::vector<Index> crossing;  ///< nodes whose receiver lies in another block
    std::vector<Index> layer;     ///< where in its queue the layers begin, the last first
    Index count = 0;
};

/// Leaves are looked for in so many nodes at a time, and followed as far as they lead, so that what is worked on stays
/// in the processor's nearest memory.
inline constexpr Index leaves_at_a_time = 8192;

/// One block's nodes from the leaves down, in layers: no node of a layer flows to another of it. No branch depends on
/// the terrain but those that are nearly never taken.
template <class Neighbor, class Pass>
class BlockWalk {
  public:
    BlockWalk(const Neighbor& neighbor, std::span<const double> elevation_m, const FlowDirections& directions,
              OrderBuffers& buffers, Index first, Index last, Index* queue, const Pass& pass)
        : neighbor_(neighbor),
          elevation_m_(elevation_m),
          directions_(directions.data()),
          awaited_(buffers.awaited.data()),
          first_(first),
          size_(last - first),
          queue_(queue),
          next_(size_),
          free_(size_),
          pass_(pass) {}

    Part run() {
        for (Index from = 0; from < size_; from += leaves_at_a_time) {
            push_leaves(first_ + from, first_ + std::min(size_, from + leaves_at_a_time));
            while (next_ != free_) follow_layer();
        }
        part_.count = size_ - free_;
        return std::move(part_);
    }

  private:
    void push_leaves(Index from, Index to) {
        for (Index node = from; node < to; ++node) {
            if (directions_[node] == no_flow) [[unlikely]] {
                push_if(awaited_[node] == 0 && !std::isnan(elevation_m_[node]), node);
            } else {
                push_if(awaited_[node] == 0, node);
            }
        }
    }

    void follow_layer() {
        part_.layer.push_back(free_);
        for (const Index end = free_; next_ != end;) {
            const Index node = queue_[--next_];
            const Slot slot = directions_[node];
            if (slot == no_flow) [[unlikely]]
                continue;
            const Index receiver = neighbor_(node, slot);
            if (receiver - first_ >= size_) [[unlikely]] {
                part_.crossing.push_back(node);
                continue;
            }
            pass_(node, receiver);
            const auto left = static_cast<std::uint8_t>(awaited_[receiver] - 1);
            awaited_[receiver] = static_cast<std::uint8_t>(left - (left == 0));  // 255: placed, and no leaf
            push_if(left == 0, receiver);
        }
    }

    /// There is always room for one more, so that this needs no branch. (Signed: with all nodes placed it is place -1.)
    void push_if(bool wanted, Index node) {
        queue_[std::ptrdiff_t{free_} - 1] = node;
        free_ -= wanted;
    }

    const Neighbor& neighbor_;
    std::span<const double> elevation_m_;
    const Slot* directions_;
    std::uint8_t* awaited_;
    Index first_, size_;
    Index* queue_;  // filled from its end; one place before its begin is ours
    Index next_, free_;
    const Pass& pass_;
    Part part_;
};

/// What flows over the borders of the blocks, and all that lies below: donors first.
template <class Neighbor, class Pass>
Part walk_trunk(const Neighbor& neighbor, const FlowDirections& directions, const std::vector<Part>& blocks,
                OrderBuffers& buffers, std::vector<Index>& trunk, const Pass& pass) {
    const auto give = [&](Index node) {
        const Index receiver = neighbor(node, directions[node]);
        pass(node, receiver);
        if (--buffers.awaited[receiver] == 0) trunk.push_back(receiver);
    };
    Part part;
    for (const Part& block : blocks) {
        for (const Index node : block.crossing) give(node);
    }
    for (std::size_t next = 0; next < trunk.size();) {
        const std::size_t end = trunk.size();
        part.layer.push_back(static_cast<Index>(end));
        for (; next < end; ++next) {
            if (directions[trunk[next]] != no_flow) give(trunk[next]);
        }
    }
    part.count = static_cast<Index>(trunk.size());
    for (Index& end : part.layer) end = part.count - end;
    return part;
}

/// Appends a part, given where its layers begin in the order, the last first.
inline void append_part(const std::vector<Index>& begins, FlowLayers& layers) {
    layers.part.push_back(static_cast<Index>(layers.begin.size()));
    layers.begin.insert(layers.begin.end(), begins.rbegin(), begins.rend());
}

}  // namespace detail

/// Orders all nodes with data, each after its receiver, and calls pass(donor, receiver) once for each that flows: after
/// all that flow to the donor, one at a time for each receiver, and for each receiver in an order that depends on the
/// directions alone.
///
/// From the leaves down, layer by layer: first within the blocks (on several threads), then what crosses their borders
/// and all below it (the trunk, a few per cent of the nodes). Linear, without recursion.
template <class T, class Pass>
void order_by_layers(const T& topology, std::span<const double> elevation_m, const FlowDirections& directions,
                     OrderBuffers& buffers, std::vector<Index>& order, FlowLayers& layers, const Pass& pass) {
    const Blocks blocks(topology.size());
    const auto neighbor = downhill(topology);
    count_donors(topology, directions, buffers.awaited);
    buffers.queue.resize(std::size_t{topology.size()} + blocks.count());
    std::vector<detail::Part> parts(blocks.count());
    const auto queue_of = [&](Index block) { return buffers.queue.data() + blocks.first(block) + block + 1; };
    blocks.for_each([&](Index block) {
        parts[block] = detail::BlockWalk(neighbor, elevation_m, directions, buffers, blocks.first(block),
                                         blocks.last(block), queue_of(block), pass)
                           .run();
    });
    std::vector<Index> trunk;
    const detail::Part below = detail::walk_trunk(neighbor, directions, parts, buffers, trunk, pass);

    std::vector<Index> begin{below.count};
    for (const detail::Part& part : parts) begin.push_back(begin.back() + part.count);
    order.resize(begin.back());
    std::reverse_copy(trunk.begin(), trunk.end(), order.begin());
    blocks.for_each([&](Index block) {
        const Index size = blocks.last(block) - blocks.first(block);
        const Index* const end = queue_of(block) + size;
        std::copy(end - parts[block].count, end, order.begin() + begin[block]);
        for (Index& at : parts[block].layer) at += begin[block] + parts[block].count - size;
    });
    layers.begin.clear();
    layers.part.clear();
    detail::append_part(below.layer, layers);
    for (const detail::Part& part : parts) detail::append_part(part.layer, layers);
    layers.part.push_back(static_cast<Index>(layers.begin.size()));
    layers.begin.push_back(begin.back());
}

}  // namespace thalweg::terrain
