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

SourceOrder::SourceOrder() : left_{none}, right_{none}, parent_{none}, sources_{0}, priority_{priority_of(0)} {
    insert(0);
}

void SourceOrder::add_stream(Index behind) {
    const auto opening_mark = static_cast<Index>(left_.size());
    insert(behind);
    insert(opening_mark);
}

void SourceOrder::insert(Index behind) {
    const auto mark = static_cast<Index>(left_.size());
    Index parent = behind;
    const bool as_right = right_[behind] == none;
    if (!as_right) {
        parent = right_[behind];
        while (left_[parent] != none) parent = left_[parent];
    }
    (as_right ? right_ : left_)[parent] = mark;
    left_.push_back(none);
    right_.push_back(none);
    parent_.push_back(parent);
    sources_.push_back(weight(mark));
    priority_.push_back(priority_of(mark));
    if (weight(mark) > 0) {
        for (Index above = parent; above != none; above = parent_[above]) ++sources_[above];
    }
    while (parent_[mark] != none && priority_[parent_[mark]] < priority_[mark]) rotate_up(mark);
}

void SourceOrder::rotate_up(Index mark) {
    const Index parent = parent_[mark];
    const Index above = parent_[parent];
    const bool from_left = left_[parent] == mark;
    const Index inner = from_left ? right_[mark] : left_[mark];
    (from_left ? left_ : right_)[parent] = inner;
    if (inner != none) parent_[inner] = parent;
    (from_left ? right_ : left_)[mark] = parent;
    parent_[parent] = mark;
    parent_[mark] = above;
    if (above != none) (left_[above] == parent ? left_ : right_)[above] = mark;
    const Index all = sources_[parent];
    sources_[parent] = all - sources_[mark] + (inner == none ? 0 : sources_[inner]);
    sources_[mark] = all;
}

Index SourceOrder::rank(Index mark) const {
    Index sources = (left_[mark] == none ? 0 : sources_[left_[mark]]) + weight(mark);
    for (Index at = mark; parent_[at] != none; at = parent_[at]) {
        const Index parent = parent_[at];
        if (right_[parent] != at) continue;
        sources += sources_[parent] - sources_[at];
    }
    return sources;
}

}  // namespace thalweg::grow
