// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include "thalweg/evolve/exchange_watch.hpp"

// Real landscapes hardly ever cycle, so the rule is tested on drawn sequences of directions.

using thalweg::FlowDirections;
using thalweg::Index;
using thalweg::no_flow;
using namespace thalweg::evolve;

namespace {

constexpr Index patience = 5;

/// Five nodes of which node 1 swings between two receivers; node 3 turns for good at the step `turn`.
FlowDirections swinging(int step, int turn) {
    return {0, static_cast<thalweg::Slot>(step % 2 ? 2 : 6), 4, static_cast<thalweg::Slot>(step < turn ? 1 : 7),
            no_flow};
}

}  // namespace

TEST_CASE("Directions that never change are no exchange") {
    ExchangeWatch watch = exchange_watch(5, patience);
    for (int step = 0; step < 30; ++step) {
        CHECK(observe(watch, swinging(0, 100)) == 0);
        CHECK_FALSE(only_the_same(watch));
    }
    CHECK(watch.frozen.empty());
    CHECK(frozen_count(watch) == 0);
}

TEST_CASE("A node that swings alone is noticed after the given patience and frozen as it stands") {
    ExchangeWatch watch = exchange_watch(5, patience);
    int step = 0;
    CHECK(observe(watch, swinging(step, 100)) == 0);
    while (!only_the_same(watch) && step < 50) CHECK(observe(watch, swinging(++step, 100)) == 1);
    CHECK(step == 1 + patience);  // the first swing is new, and then for `patience` steps nothing is
    freeze(watch);
    CHECK(watch.frozen == FlowDirections{no_flow, swinging(step, 100)[1], no_flow, no_flow, no_flow});
    CHECK(frozen_count(watch) == 1);
    CHECK(frozen_mask(watch) == std::vector<std::uint8_t>{0, 1, 0, 0, 0});
}

TEST_CASE("As long as other nodes turn too nothing is frozen") {
    ExchangeWatch watch = exchange_watch(5, patience);
    for (int step = 0; step <= 4; ++step) observe(watch, swinging(step, 4));  // node 3 turns at step 4
    int step = 4;
    while (!only_the_same(watch) && step < 50) observe(watch, swinging(++step, 4));
    CHECK(step == 4 + static_cast<int>(patience));
    freeze(watch);
    CHECK(frozen_mask(watch) == std::vector<std::uint8_t>{0, 1, 0, 0, 0});  // node 3 turned once, before
}

TEST_CASE("A node that has stopped swinging is let go") {
    ExchangeWatch watch = exchange_watch(5, patience);
    int step = 0;
    for (; step < 4; ++step) observe(watch, swinging(step, 100));
    for (int i = 0; i < 3 * static_cast<int>(patience); ++i) observe(watch, swinging(3, 100));
    CHECK_FALSE(only_the_same(watch));
}
