// SPDX-License-Identifier: GPL-3.0-or-later
#include "grow/growing_tree.hpp"

#include <algorithm>

namespace thalweg::grow {
namespace {

constexpr std::size_t at_once = 16;  // more would not fit what a processor can wait for, nor its nearest cache
constexpr int usual_sides = 10;      // of a polygon; seldom more

/// All walks go on in turn: while one waits for its next side, so do the others. That ends of walks are not looked for
/// keeps the processor from guessing them wrong, which would end the waiting together.
void walk_around(const Subdivision& basin, std::span<Index> sides) {
    for (int step = 0; step < usual_sides; ++step) {
        for (Index& side : sides) {
            basin.ask_for_surroundings(side);
            side = basin.next(side);
        }
    }
}

/// Between which its sources lie.
std::array<Index, 2> marks_of(const GrowingLink& link) { return {link.mark, SourceOrder::source(link.stream)}; }

void fetch_together(const GrowingTree& tree, std::span<const Index> links) {
    for (const Index link : links) __builtin_prefetch(&tree.links[link]);
    std::array<Index, 2 * at_once> sides;
    for (std::size_t i = 0; i < links.size(); ++i) {
        const GrowingLink& link = tree.links[links[i]];
        sides[2 * i] = link.edge;
        sides[2 * i + 1] = link.edge ^ 1;
        tree.basin.ask_for(link.edge);
        __builtin_prefetch(&tree.streams[link.stream]);
        __builtin_prefetch(&tree.streams[link.mark / 2]);
        for (const Index mark : marks_of(link)) tree.sources.ask_for(mark);
    }
    for (const Index link : links) {
        for (const Index mark : marks_of(tree.links[link])) tree.sources.ask_for_block(mark);
    }
    walk_around(tree.basin, std::span(sides).first(2 * links.size()));
    for (const Index link : links) {
        for (const Index mark : marks_of(tree.links[link])) tree.sources.ask_for_block_above(mark);
        for (const Index inflow : tree.links[link].upstream) {
            if (inflow != none) __builtin_prefetch(&tree.links[inflow]);
        }
        const Index junction = tree.streams[tree.links[link].mark / 2].junction;
        if (junction != none) __builtin_prefetch(&tree.junctions[junction]);
    }
}

}  // namespace

void fetch_ahead(const GrowingTree& tree, std::span<const Index> links) {
    for (std::size_t done = 0; done < links.size(); done += at_once) {
        fetch_together(tree, links.subspan(done, std::min(at_once, links.size() - done)));
    }
}

}  // namespace thalweg::grow
