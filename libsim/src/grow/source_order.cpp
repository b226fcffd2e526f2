// SPDX-License-Identifier: GPL-3.0-or-later
#include "grow/source_order.hpp"

#include <algorithm>
#include <numeric>

namespace thalweg::grow {
namespace {

Index weight(Index mark) { return mark & 1; }  // sources have odd numbers

}  // namespace

SourceOrder::SourceOrder() {
    blocks_.emplace_back();
    block_of_ = {0, 0};
    put(0, 0, opening(0), 0);
    put(0, 1, source(0), 1);
}

void SourceOrder::reserve(Index streams) {
    block_of_.reserve(2 * std::size_t{streams});
    blocks_.reserve(2 * std::size_t{streams} / (most_members / 2));
}

void SourceOrder::add_stream(Index behind) {
    const auto opening_mark = static_cast<Index>(block_of_.size());
    insert(behind);
    insert(opening_mark);
}

void SourceOrder::insert(Index behind) {
    const auto mark = static_cast<Index>(block_of_.size());
    make_room(block_of_[behind]);
    const Index block = block_of_[behind];
    block_of_.push_back(block);
    put(block, position(block, behind) + 1, mark, weight(mark));
    if (weight(mark) == 0) return;
    for (Index at = block; blocks_[at].parent != none; at = blocks_[at].parent) {
        const Index parent = blocks_[at].parent;
        ++blocks_[parent].sources[position(parent, at)];
    }
}

/// Splits a full block, and before it all full ones above that would have to take the new half.
void SourceOrder::make_room(Index block) {
    std::array<Index, 16> full;  // blocks are at least half full: 16 levels are more than 32-bit numbers can fill
    std::size_t count = 0;
    for (Index at = block; at != none && blocks_[at].size == most_members; at = blocks_[at].parent) full[count++] = at;
    while (count > 0) split(full[--count]);
}

/// The second half of a full block becomes a block of its own, behind it. The block above must have room.
void SourceOrder::split(Index lower) {
    const auto all = [&](Index block) {
        const auto& sources = blocks_[block].sources;
        return std::accumulate(sources.begin(), sources.begin() + blocks_[block].size, Index{0});
    };
    if (blocks_[lower].parent == none) {
        const auto root = static_cast<Index>(blocks_.size());
        blocks_.emplace_back().of_marks = false;
        put(root, 0, lower, all(lower));
        blocks_[lower].parent = root;
    }
    const auto upper = static_cast<Index>(blocks_.size());
    const Index parent = blocks_[lower].parent;
    Block half = blocks_[lower];
    constexpr Index kept = most_members / 2;
    std::copy(half.member.begin() + kept, half.member.end(), half.member.begin());
    std::copy(half.sources.begin() + kept, half.sources.end(), half.sources.begin());
    half.size = most_members - kept;
    blocks_.push_back(half);
    blocks_[lower].size = kept;
    for (Index i = 0; i < half.size; ++i) {
        (half.of_marks ? block_of_[half.member[i]] : blocks_[half.member[i]].parent) = upper;
    }
    const Index place = position(parent, lower);
    blocks_[parent].sources[place] -= all(upper);
    put(parent, place + 1, upper, all(upper));
}

/// Into a block with room.
void SourceOrder::put(Index number, Index position, Index member, Index sources) {
    Block& block = blocks_[number];
    for (auto* row : {&block.member, &block.sources}) {
        std::copy_backward(row->begin() + position, row->begin() + block.size, row->begin() + block.size + 1);
    }
    block.member[position] = member;
    block.sources[position] = sources;
    ++block.size;
}

Index SourceOrder::position(Index block, Index member) const {
    const auto& members = blocks_[block].member;
    return static_cast<Index>(std::find(members.begin(), members.begin() + blocks_[block].size, member) -
                              members.begin());
}

Index SourceOrder::rank(Index mark) const {
    Index sources = weight(mark);
    Index member = mark;
    for (Index at = block_of_[mark]; at != none; at = blocks_[at].parent) {
        const auto& row = blocks_[at].sources;
        sources = std::accumulate(row.begin(), row.begin() + position(at, member), sources);
        member = at;
    }
    return sources;
}

void SourceOrder::ask_for_lines(Index block) const {
    const char* begin = reinterpret_cast<const char*>(&blocks_[block]);
    for (std::size_t line = 0; line < sizeof(Block); line += 64) __builtin_prefetch(begin + line);
}

}  // namespace thalweg::grow
