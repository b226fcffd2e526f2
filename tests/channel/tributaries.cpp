// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/tributaries.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/flow_trees.hpp"

using namespace thalweg;
using namespace thalweg::channel;
using support::graph_of;
using support::network_of;

namespace {

OffsetOf offsets_of(const std::vector<Point>& at) {
    return [&at](Index from, Index to) { return Point{at[to].x - at[from].x, at[to].y - at[from].y}; };
}

/// A tributary of a drawn comb: where it joins the trunk, on which hand looking upstream, and how long it is.
struct Tooth {
    Index at;
    int right;  ///< 1: to the east, −1: to the west
    Index length;
};

/// A trunk that runs north from the mouth in unit steps, with straight tributaries that rise to the north-east or west.
struct Comb {
    std::vector<Index> receiver{none};
    std::vector<Point> at{{0, 0}};

    Comb(Index trunk, const std::vector<Tooth>& teeth) {
        for (Index i = 1; i <= trunk; ++i) {
            receiver.push_back(i - 1);
            at.push_back({0, double(i)});
        }
        for (const Tooth& tooth : teeth) grow(tooth.at, {0.8 * tooth.right, 0.6}, tooth.length);
    }
    /// Returns the uppermost node.
    Index grow(Index below, Point step, Index length) {
        for (Index i = 0; i < length; ++i) {
            receiver.push_back(below);
            at.push_back({at[below].x + step.x, at[below].y + step.y});
            below = static_cast<Index>(receiver.size()) - 1;
        }
        return below;
    }
    StreamNetwork network() const { return network_of(graph_of(receiver)); }
    std::vector<Tributary> tributaries() const {
        const StreamNetwork rivers = network();
        const OffsetOf offset = offsets_of(at);
        return channel::tributaries(rivers, straightest_streams(rivers, offset, 1), offset, 1);
    }
};

}  // namespace

TEST_CASE("Straight streams carry on though the river from the side is larger") {
    const Comb comb(8, {{4, 1, 20}});
    const StreamNetwork rivers = comb.network();
    const MainStreams by_area = main_streams(rivers);
    const MainStreams straight = straightest_streams(rivers, offsets_of(comb.at), 1);
    REQUIRE(rivers.size() == 3);
    for (Index link = 1; link < 3; ++link) {
        const bool is_side = comb.at[rivers.nodes_of(link).front()].x > 0;
        CHECK((by_area.stream[link] == by_area.stream[0]) == is_side);
        CHECK((straight.stream[link] == straight.stream[0]) == !is_side);
    }
}

TEST_CASE("Tributaries of a drawn trunk have the places, banks and divisions worked out by hand") {
    // Up the trunk of ten: small from the east at 2, largest from the west at 5, middling from the east at 8.
    const Comb comb(10, {{2, 1, 1}, {5, -1, 6}, {8, 1, 3}});
    const auto found = comb.tributaries();
    REQUIRE(found.size() == 3);
    CHECK(found[0].place == Approx(0.2));
    CHECK(found[1].place == Approx(0.5));
    CHECK(found[2].place == Approx(0.8));
    CHECK(found[0].bank == Bank::left);  // looking down, that is south
    CHECK(found[1].bank == Bank::right);
    CHECK(found[2].bank == Bank::left);
    CHECK(found[0].older_below == none);
    CHECK(found[1].older_below == none);
    CHECK(found[2].older_below == 1);
    CHECK(found[0].division == Approx(2 / 5.0));  // between the mouth and the one at 5
    CHECK(found[1].division == Approx(0.5));      // the first of all
    CHECK(found[2].division == Approx(3 / 5.0));  // between the one at 5 and the source
    const UniformDraw places = junction_places(found);
    CHECK(places.count == 3);
    CHECK(places.mean.value == Approx(0.5));
    CHECK(places.delta.value == Approx(std::sqrt(3.0) * 0.1));
}

TEST_CASE("Sides are counted by thirds, on the obtuse side and opposite the older one below") {
    Comb comb(9, {{1, 1, 9}});    // the tributary to the north-east is the stream that is looked at
    const Index first = 10;       // its lowest node of its own; nine steps up from the junction
    const Point left{-0.6, 0.8};  // square to it, looking up; its obtuse side looks down the trunk: right
    const Point right{0.6, -0.8};
    comb.grow(first + 1, right, 1);  // two ninths up: lower third, obtuse
    comb.grow(first + 4, left, 3);   // five ninths: middle, no older one below, as it is the largest
    comb.grow(first + 6, left, 1);   // seven ninths: upper, not obtuse, same side as the older one below
    const SideChoices choices = side_choices(comb.tributaries());
    CHECK(choices.obtuse[0].count == 1);
    CHECK(choices.obtuse[0].value == 1);
    CHECK(choices.obtuse[1].count == 1);
    CHECK(choices.obtuse[1].value == 0);
    CHECK(choices.obtuse[2].value == 0);
    CHECK(choices.opposite[0].count == 0);
    CHECK(std::isnan(choices.opposite[0].value));
    CHECK(choices.opposite[1].count == 0);
    CHECK(choices.opposite[2].count == 1);
    CHECK(choices.opposite[2].value == 0);
    CHECK(choices.opposite[2].standard_error == 0);
}

TEST_CASE("A place where three rivers meet has no tributary") {
    Comb comb(6, {{3, 1, 2}});
    comb.grow(3, {-0.8, 0.6}, 2);
    CHECK(comb.tributaries().empty());
}

TEST_CASE("Divisions of random trees are those found by looking through all tributaries") {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        Random random(seed, 31);
        const auto graph = support::random_tree(60, random);
        std::vector<Point> at(graph.size());
        for (const Index node : graph.order) {
            if (graph.receiver[node] == none) continue;
            const double angle = 6.28 * random.uniform();
            at[node] = {at[graph.receiver[node]].x + std::cos(angle), at[graph.receiver[node]].y + std::sin(angle)};
        }
        const StreamNetwork rivers = network_of(graph);
        const OffsetOf offset = offsets_of(at);
        const auto all = tributaries(rivers, straightest_streams(rivers, offset, 1), offset, 1);
        CHECK(all.size() == 59);
        for (const Tributary& t : all) {
            double lower = 0, upper = 1;
            Index below = none;
            for (Index i = 0; i < all.size(); ++i) {
                const Tributary& other = all[i];
                if (other.parent != t.parent || other.link == t.link) continue;
                const bool is_below = other.place < t.place;
                const double area = rivers.area_m2[t.link], of_other = rivers.area_m2[other.link];
                if (is_below ? of_other < area : of_other <= area) continue;
                if (is_below && other.place > lower) {
                    lower = other.place;
                    below = i;
                }
                if (!is_below) upper = std::min(upper, other.place);
            }
            REQUIRE(t.older_below == below);
            REQUIRE(t.division == Approx((t.place - lower) / (upper - lower)));
        }
    }
}

TEST_CASE("The uniform distribution of a sample has its mean and spread, with errors that cover") {
    CHECK(std::isnan(uniform_draw(std::vector<double>{}).mean.value));
    CHECK(uniform_draw(std::vector<double>{0.3}).mean.value == 0.3);
    CHECK(std::isnan(uniform_draw(std::vector<double>{0.3}).delta.value));
    const UniformDraw two = uniform_draw(std::vector<double>{0.2, 0.4});
    CHECK(two.mean.value == Approx(0.3));
    CHECK(two.delta.value == Approx(std::sqrt(3.0) * std::sqrt(0.02)));
    CHECK(two.mean.standard_error == Approx(0.1));
    Random random(5, 32);
    int mean_covered = 0, delta_covered = 0;
    for (int trial = 0; trial < 500; ++trial) {
        std::vector<double> sample;
        for (int i = 0; i < 60; ++i) sample.push_back(0.4 + 0.2 * (2 * random.uniform() - 1));
        const UniformDraw draw = uniform_draw(sample);
        mean_covered += draw.mean.interval95[0] <= 0.4 && 0.4 <= draw.mean.interval95[1];
        delta_covered += draw.delta.interval95[0] <= 0.2 && 0.2 <= draw.delta.interval95[1];
    }
    CHECK(mean_covered > 460);
    CHECK(mean_covered < 495);
    CHECK(delta_covered > 460);
    CHECK(delta_covered < 497);
}

TEST_CASE("Equal weights change nothing, and whole weights count as so many values") {
    const std::vector<double> sample{0.1, 0.5, 0.7};
    const UniformDraw plain = uniform_draw(sample), weighted = uniform_draw(sample, std::vector<double>{4, 4, 4});
    CHECK(weighted.mean.value == Approx(plain.mean.value));
    CHECK(weighted.mean.standard_error == Approx(plain.mean.standard_error));
    CHECK(weighted.delta.value == Approx(plain.delta.value));
    CHECK(uniform_draw(sample, std::vector<double>{1, 2, 1}).mean.value == Approx(0.45));
}
