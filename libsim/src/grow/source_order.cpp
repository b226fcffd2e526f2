// SPDX-License-Identifier: GPL-3.0-or-later
#include "grow/source_order.hpp"

#include "thalweg/core/random.hpp"

namespace thalweg::grow {
namespace {

/// Priorities need no seed: whatever they are, the ranks are the same.
std::uint64_t priority_of(Index mark) {
    const auto bits = philox({mark, 0, 0, 0}, {0, 0});
    return std::uint64_t{bits[1]} << 32 | bits[0];
}

Index weight(Index mark) { return mark & 1; }  // sources have odd numbers

}  // namespace

SourceOrder::SourceOrder() : nodes_{{none, none, none, 0}}, priority_{priority_of(0)} { insert(0); }

void SourceOrder::add_stream(Index behind) {
    const auto opening_mark = static_cast<Index>(nodes_.size());
    insert(behind);
    insert(opening_mark);
}

void SourceOrder::insert(Index behind) {
    const auto mark = static_cast<Index>(nodes_.size());
    Index parent = behind;
    const bool as_right = nodes_[behind].right == none;
    if (!as_right) {
        parent = nodes_[behind].right;
        while (nodes_[parent].left != none) parent = nodes_[parent].left;
    }
    (as_right ? nodes_[parent].right : nodes_[parent].left) = mark;
    nodes_.push_back({none, none, parent, weight(mark)});
    priority_.push_back(priority_of(mark));
    if (weight(mark) > 0) {
        for (Index above = parent; above != none; above = nodes_[above].parent) ++nodes_[above].sources;
    }
    while (nodes_[mark].parent != none && priority_[nodes_[mark].parent] < priority_[mark]) rotate_up(mark);
}

void SourceOrder::rotate_up(Index mark) {
    Node& risen = nodes_[mark];
    const Index parent = risen.parent;
    Node& sunk = nodes_[parent];
    const bool from_left = sunk.left == mark;
    const Index inner = from_left ? risen.right : risen.left;
    (from_left ? sunk.left : sunk.right) = inner;
    if (inner != none) nodes_[inner].parent = parent;
    (from_left ? risen.right : risen.left) = parent;
    risen.parent = sunk.parent;
    sunk.parent = mark;
    if (risen.parent != none) {
        Node& above = nodes_[risen.parent];
        (above.left == parent ? above.left : above.right) = mark;
    }
    const Index all = sunk.sources;
    sunk.sources = all - risen.sources + (inner == none ? 0 : nodes_[inner].sources);
    risen.sources = all;
}

Index SourceOrder::rank(Index mark) const {
    const Index left = nodes_[mark].left;
    Index sources = (left == none ? 0 : nodes_[left].sources) + weight(mark);
    for (Index at = mark; nodes_[at].parent != none; at = nodes_[at].parent) {
        const Node& parent = nodes_[nodes_[at].parent];
        if (parent.right == at) sources += parent.sources - nodes_[at].sources;
    }
    return sources;
}

}  // namespace thalweg::grow
