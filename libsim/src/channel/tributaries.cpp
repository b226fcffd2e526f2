// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/tributaries.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "channel/directions.hpp"

namespace thalweg::channel {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Estimate estimate(double value, double standard_error, double count) {
    if (!(count >= 2)) return {value, nan, {nan, nan}};
    const double half = student_t95(count - 1) * standard_error;
    return {value, standard_error, {value - half, value + half}};
}

/// Distance of each link's upper end from the mouth of its stream.
std::vector<double> upper_ends(const StreamNetwork& network, const MainStreams& streams) {
    std::vector<double> upper(network.size());
    for (Index link = 0; link < network.size(); ++link) {
        const Index below = network.downstream[link];
        const bool same = below != none && streams.stream[below] == streams.stream[link];
        upper[link] = network.length_m[link] + (same ? upper[below] : 0);
    }
    return upper;
}

/// Third of the stream, 0 for the lowest.
std::size_t third_of(double place) { return std::min<std::size_t>(2, static_cast<std::size_t>(3 * place)); }

/// Counts how many of so many cases are as asked.
struct Count {
    Index yes = 0, all = 0;

    void add(bool is_so) {
        yes += is_so;
        ++all;
    }
    Share share() const {
        if (all == 0) return {0, nan, nan};
        const double value = static_cast<double>(yes) / all;
        return {all, value, std::sqrt(value * (1 - value) / all)};
    }
};

/// Whether a tributary counts as older than another one of the same parent that joins farther up.
bool is_older(const StreamNetwork& network, const Tributary& t, const Tributary& farther_up) {
    return network.area_m2[t.link] >= network.area_m2[farther_up.link];
}

/// Between which older neighbours each tributary of one parent has come in. `on_parent` are in order up the parent.
void divide_parent(const StreamNetwork& network, std::span<const Index> on_parent, std::vector<Tributary>& all) {
    std::vector<Index> older;  // those below that are older than all between them and here; the youngest last
    std::vector<double> lower(on_parent.size(), 0), upper(on_parent.size(), 1);
    std::vector<std::size_t> position;  // of the same
    for (std::size_t i = 0; i < on_parent.size(); ++i) {
        Tributary& t = all[on_parent[i]];
        while (!older.empty() && !is_older(network, all[older.back()], t)) {
            upper[position.back()] = t.place;
            older.pop_back();
            position.pop_back();
        }
        if (!older.empty()) {
            t.older_below = older.back();
            lower[i] = all[older.back()].place;
        }
        older.push_back(on_parent[i]);
        position.push_back(i);
    }
    for (std::size_t i = 0; i < on_parent.size(); ++i) {
        Tributary& t = all[on_parent[i]];
        t.division = (t.place - lower[i]) / (upper[i] - lower[i]);
    }
}

/// The tributaries of each parent, up along it.
std::vector<std::vector<Index>> by_parent(const std::vector<Tributary>& all, std::size_t streams) {
    std::vector<std::vector<Index>> lists(streams);
    for (Index i = 0; i < all.size(); ++i) lists[all[i].parent].push_back(i);
    return lists;
}

/// The tributary's link of two inflows: not of the stream below.
Index tributary_of(const JunctionInflows& in, const MainStreams& streams, Index below) {
    return streams.stream[in.link[0]] == streams.stream[below] ? in.link[1] : in.link[0];
}

}  // namespace

std::vector<Tributary> tributaries(const StreamNetwork& network, const MainStreams& streams, const OffsetOf& offset,
                                   double reach_m) {
    const auto inflows_of = junction_inflows(network);
    const auto upper = upper_ends(network, streams);
    std::vector<double> stream_length(streams.parent.size(), 0);
    for (Index link = 0; link < network.size(); ++link) stream_length[streams.stream[link]] += network.length_m[link];
    std::vector<Tributary> found;
    for (Index below = 0; below < network.size(); ++below) {
        const JunctionInflows& in = inflows_of[below];
        if (in.count != 2) continue;
        const Index link = tributary_of(in, streams, below);
        const Index main = in.link[0] == link ? in.link[1] : in.link[0];
        const bool left = is_left_of(network, offset, reach_m, {.below = below, .main = main, .tributary = link});
        found.push_back({.stream = streams.stream[link],
                         .link = link,
                         .parent = streams.stream[below],
                         .place = upper[below] / stream_length[streams.stream[below]],
                         .bank = left ? Bank::left : Bank::right,
                         .older_below = none,
                         .division = 0});
    }
    for (const auto& on_parent : by_parent(found, streams.parent.size())) divide_parent(network, on_parent, found);
    return found;
}

UniformDraw uniform_draw(std::span<const double> sample, std::span<const double> weights) {
    double sum = 0, sum_of_squares = 0, weighted = 0, squares = 0;
    for (std::size_t i = 0; i < sample.size(); ++i) {
        const double weight = weights.empty() ? 1 : weights[i];
        sum += weight;
        sum_of_squares += weight * weight;
        weighted += weight * sample[i];
    }
    const double mean = weighted / sum;
    for (std::size_t i = 0; i < sample.size(); ++i) {
        squares += (weights.empty() ? 1 : weights[i]) * (sample[i] - mean) * (sample[i] - mean);
    }
    const double independent = sum * sum / sum_of_squares;  // as many equal weights have the same error
    const double sd = independent > 1 ? std::sqrt(squares / sum * independent / (independent - 1)) : nan;
    const double delta = std::sqrt(3.0) * sd;
    return {.count = static_cast<Index>(sample.size()),
            .mean = estimate(mean, sd / std::sqrt(independent), independent),
            .delta = estimate(delta, delta * std::sqrt(0.2 / independent), independent)};  // its kurtosis is 1.8
}

UniformDraw junction_places(std::span<const Tributary> list) {
    std::vector<double> divisions;
    for (const Tributary& t : list) divisions.push_back(t.division);
    return uniform_draw(divisions);
}

SideChoices side_choices(std::span<const Tributary> list) {
    std::vector<Index> number_of;  // of the tributary that a stream is
    for (Index i = 0; i < list.size(); ++i) {
        if (list[i].stream >= number_of.size()) number_of.resize(list[i].stream + 1, none);
        number_of[list[i].stream] = i;
    }
    std::array<Count, 3> obtuse, opposite;
    for (const Tributary& t : list) {
        const Index parent = t.parent < number_of.size() ? number_of[t.parent] : none;
        if (parent != none) obtuse[third_of(t.place)].add(t.bank == list[parent].bank);
        if (t.older_below != none) opposite[third_of(t.place)].add(t.bank != list[t.older_below].bank);
    }
    SideChoices choices{};
    for (std::size_t third = 0; third < 3; ++third) {
        choices.obtuse[third] = obtuse[third].share();
        choices.opposite[third] = opposite[third].share();
    }
    return choices;
}

}  // namespace thalweg::channel
