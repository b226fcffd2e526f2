// SPDX-License-Identifier: GPL-3.0-or-later
#include "grow/candidates.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <queue>
#include <vector>

#include "grow/source_order.hpp"
#include "thalweg/core/random.hpp"

using namespace thalweg;
using namespace thalweg::grow;

TEST_CASE("Candidates come in the order of a plain heap, whatever is entered between") {
    Random random(20261128, 1);
    for (int trial = 0; trial < 50; ++trial) {
        const double largest = std::pow(10, 12 * random.uniform());
        Candidates candidates(largest);
        std::priority_queue<Candidate> plain;
        const double octaves = trial % 3 == 0 ? 80 : 4;  // far beyond the bins kept, and narrow
        for (int step = 0; step < 4000; ++step) {
            const bool fills = step < 1000 || (step > 2500 && step < 3000);
            if (fills || random.uniform() < 0.4) {
                double excess = largest * std::exp2(1 - octaves * random.uniform());
                if (random.uniform() < 0.1) excess = largest / 4;  // ties
                const Candidate entered{excess, static_cast<Index>(step)};
                candidates.push(entered);
                plain.push(entered);
            } else {
                Candidate taken{};
                REQUIRE(candidates.pop(taken) == !plain.empty());
                if (plain.empty()) continue;
                REQUIRE(taken.link == plain.top().link);
                REQUIRE(taken.excess == plain.top().excess);
                plain.pop();
            }
        }
        for (Candidate taken{}; candidates.pop(taken); plain.pop()) REQUIRE(taken.link == plain.top().link);
        REQUIRE(plain.empty());
        Candidate taken{};
        REQUIRE_FALSE(candidates.pop(taken));  // nothing of before comes back, and what enters now is found
        for (Index link = 0; link < 30; ++link) candidates.push({largest / (1 + link % 7), link});
        Candidate before{2 * largest, 0};
        for (Index number = 0; number < 30; ++number) {
            REQUIRE(candidates.pop(taken));
            REQUIRE(taken < before);
            before = taken;
        }
        REQUIRE_FALSE(candidates.pop(taken));
    }
}

TEST_CASE("The larger excess comes first, of equal ones the older link") {
    CHECK(Candidate{1, 5} < Candidate{2, 9});
    CHECK_FALSE(Candidate{2, 9} < Candidate{1, 5});
    CHECK(Candidate{1, 6} < Candidate{1, 5});
    CHECK_FALSE(Candidate{1, 5} < Candidate{1, 6});
    Candidates candidates(1);
    for (const Index link : {3, 1, 2}) candidates.push({0.5, link});
    Candidate taken{};
    for (const Index link : {1, 2, 3}) {
        REQUIRE(candidates.pop(taken));
        CHECK(taken.link == link);
    }
}

TEST_CASE("What is said to come next comes next") {
    Candidates candidates(100);
    for (Index link = 0; link < 40; ++link) candidates.push({99.5 + 0.01 * link, link});
    Candidate taken{};
    REQUIRE(candidates.pop(taken));
    CHECK(taken.link == 39);
    const auto next = candidates.upcoming(3);
    REQUIRE(next.size() == 3);
    for (Index i = 0; i < 3; ++i) CHECK(next[i].link == 36 + i);
}

TEST_CASE("The sources between two marks are counted as a walk along the row counts them") {
    Random random(20261128, 2);
    SourceOrder order;
    std::vector<Index> row{SourceOrder::opening(0), SourceOrder::source(0)};
    for (Index stream = 1; stream < 6000; ++stream) {
        // in the first half all over the row, then all in one place, which splits the same blocks again and again
        const std::size_t behind = stream < 3000 ? random.below(row.size() - 1) : row.size() / 3;
        order.add_stream(row[behind]);
        const Index opening = SourceOrder::opening(stream);
        const Index source = SourceOrder::source(stream);
        row.insert(row.begin() + static_cast<std::ptrdiff_t>(behind) + 1, {opening, source});
        REQUIRE(order.count(opening, source) == 1);
        if (stream % 500 != 0) continue;
        Index sources = 0;
        for (const Index mark : row) {
            sources += mark & 1;
            REQUIRE(order.count(row.front(), mark) == sources);
        }
    }
}
