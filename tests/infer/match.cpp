// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/infer/match.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "thalweg/core/error.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/core/random.hpp"

using namespace thalweg;
using infer::Match;
using infer::match;
using infer::MatchOptions;

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// s = p + noise, in each coordinate alone, of standard deviation `sd`.
infer::RandomModel noisy_copy(double sd) {
    return [sd](std::span<const double> p, std::uint64_t seed) {
        Random random(seed, 9);
        std::vector<double> s;
        for (const double value : p) s.push_back(value + sd * random.normal());
        return s;
    };
}

/// A bent model: both statistics depend on both parameters.
std::vector<double> bent(std::span<const double> p, std::uint64_t seed) {
    Random random(seed, 10);
    const double a = p[0], b = p[1];
    return {std::exp(a) + 0.5 * b + 0.1 * random.normal(), a * a + 2 * b + 0.2 * random.normal()};
}

}  // namespace

TEST_CASE("A linear model with normal noise gives the estimate that theory gives") {
    // Prior: uniform on [0, 12], variance 12; noise 2: the estimate is (s/4 + 6/12)/(1/4 + 1/12), its variance 3.
    const MatchOptions options{.ranges = {{0, 12}, {0, 12}}, .most_rounds = 4, .draws = 20000, .seed = 3};
    const std::vector<double> target{4, 9};
    const Match found = match(noisy_copy(2), target, options);
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(found.parameters[i].value == Approx((target[i] / 4 + 0.5) * 3).margin(0.05));
        CHECK(found.parameters[i].standard_error == Approx(std::sqrt(3.0)).epsilon(0.02));
    }
}

TEST_CASE("Rounds go on until two have moved nothing, and then more would not change the estimate") {
    const auto rounds = [](Index most, Index draws) {
        return match(bent, std::vector<double>{2.5, 3},
                     {.ranges = {{-2, 2}, {-3, 3}}, .most_rounds = most, .draws = draws, .seed = 5});
    };
    const Match one = rounds(1, 300), two = rounds(2, 300), enough = rounds(20, 300);
    CHECK(one.rounds == 1);
    CHECK_FALSE(one.has_settled);
    CHECK(one.last_step > 2);  // from the middle of the ranges
    double moved = 0;          // by the second round, in its errors
    for (std::size_t i = 0; i < 2; ++i) {
        moved = std::max(
            moved, std::abs(two.parameters[i].value - one.parameters[i].value) / two.parameters[i].standard_error);
    }
    CHECK(two.last_step == Approx(moved));
    CHECK(enough.has_settled);
    CHECK(enough.rounds < 20);
    CHECK(enough.last_step < 0.3);
    const Match many = rounds(20, 20000);
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(std::abs(many.parameters[i].value - enough.parameters[i].value) < many.parameters[i].standard_error / 2);
    }
    const Match nothing = match(bent, std::vector<double>{std::nan(""), std::nan("")},
                                {.ranges = {{-2, 2}, {-3, 3}}, .draws = 100, .seed = 5});
    CHECK(nothing.rounds == 0);
    CHECK_FALSE(nothing.has_settled);
}

namespace {

/// Three statistics of one parameter, which a target need not agree on.
std::vector<double> three_copies(std::span<const double> p, std::uint64_t seed) {
    Random random(seed, 15);
    return {p[0] + 0.1 * random.normal(), p[0] + 0.1 * random.normal(), p[0] + 0.1 * random.normal()};
}

}  // namespace

TEST_CASE("Where a model cannot make such statistics, the errors widen by the root of how far off they are") {
    const MatchOptions options{.ranges = {{-50, 50}}, .draws = 4000, .seed = 2};
    const Match agreed = match(three_copies, std::vector<double>{0.4, 0.5, 0.6}, options);
    CHECK(agreed.parameters[0].value == Approx(0.5).margin(0.01));
    CHECK(agreed.parameters[0].standard_error == Approx(0.1 / std::sqrt(3.0)).epsilon(0.05));
    CHECK(agreed.reduced_chi2 == Approx(1).epsilon(0.1));  // (1 + 0 + 1)/2
    // Mean 1, squares 100 times larger: χ²/ν = (10² + 0 + 10²)/2.
    const Match apart = match(three_copies, std::vector<double>{0, 1, 2}, options);
    CHECK(apart.parameters[0].value == Approx(1).margin(0.01));
    CHECK(apart.reduced_chi2 == Approx(100).epsilon(0.1));
    CHECK(apart.parameters[0].standard_error == Approx(1 / std::sqrt(3.0)).epsilon(0.05));
    CHECK(apart.degrees_of_freedom == Approx(2).margin(0.01));
    // Two degrees of freedom: Student's 4.30.
    CHECK(apart.parameters[0].interval95[1] == Approx(1 + 4.303 / std::sqrt(3.0)).epsilon(0.05));
}

TEST_CASE("That the mean comes from few outcomes is in the errors") {
    // Regressed on 20 outcomes evenly over the box, the mean in its middle has 9/(4·20) of their variance. The scatter
    // of three statistics from 17 degrees of freedom, inverted, makes variances 15/17 of what they are (Wishart).
    double sum = 0;
    constexpr int trials = 2000;
    for (std::uint64_t seed = 1; seed <= trials; ++seed) {
        const Match found = match(three_copies, std::vector<double>{0.5, 0.5, 0.5},
                                  {.ranges = {{-50, 50}}, .most_rounds = 1, .draws = 20, .seed = 100 * seed});
        sum += std::pow(found.parameters[0].standard_error, 2) / (0.01 / 3);
    }
    CHECK(sum / trials == Approx(15.0 / 17 * (1 + 9.0 / 80)).epsilon(0.04));
}

TEST_CASE("On average what is left is as large as chance makes it, and never widens what is known") {
    double sum = 0;
    constexpr int trials = 200;
    for (std::uint64_t seed = 1; seed <= trials; ++seed) {
        const Match found = match(three_copies, three_copies(std::vector<double>{0.3}, 9000 + seed),
                                  {.ranges = {{0, 1}}, .draws = 100, .seed = 100 * seed});
        sum += found.reduced_chi2;
        CHECK(found.parameters[0].standard_error > 0.045);
    }
    CHECK(sum / trials == Approx(1).margin(0.25));  // each has a standard deviation of about 1
}

TEST_CASE("A parameter that changes nothing stays in the middle of its range, with an error as wide") {
    const auto model = [](std::span<const double> p, std::uint64_t seed) {
        Random random(seed, 11);
        return std::vector<double>{p[0] + 0.01 * random.normal()};
    };
    const Match found =
        match(model, std::vector<double>{0.3}, {.ranges = {{0, 1}, {2, 4}}, .most_rounds = 4, .draws = 300, .seed = 1});
    CHECK(found.parameters[0].value == Approx(0.3).margin(0.005));
    CHECK(found.parameters[1].value == Approx(3).margin(0.1));
    CHECK(found.parameters[1].standard_error == Approx(2 / std::sqrt(12.0)).epsilon(0.05));
    CHECK(found.identified[0] == 1);
    CHECK(found.identified[1] == 0);
}

TEST_CASE("The intervals of a bent model cover the truth as often as they say") {
    int covered = 0, all = 0;
    for (std::uint64_t seed = 1; seed <= 150; ++seed) {
        Random random(seed, 12);
        const std::vector<double> truth{-0.8 + 1.6 * random.uniform(), 0.2 + 0.6 * random.uniform()};
        const auto target = bent(truth, 5000 + seed);
        const Match found =
            match(bent, target, {.ranges = {{-1, 1}, {0, 1}}, .most_rounds = 4, .draws = 100, .seed = 77 * seed});
        for (std::size_t i = 0; i < 2; ++i, ++all) {
            covered += found.parameters[i].interval95[0] <= truth[i] && truth[i] <= found.parameters[i].interval95[1];
        }
    }
    CHECK(covered > 0.9 * all);
    CHECK(covered < 0.99 * all);
}

TEST_CASE("Statistics that are always the same, or not finite, tell nothing and harm nothing") {
    const auto model = [](std::span<const double> p, std::uint64_t seed) {
        Random random(seed, 16);
        const double infinite = seed % 7 == 0 ? -std::numeric_limits<double>::infinity() : p[1];
        return std::vector<double>{p[0] + 0.1 * random.normal(), 0.37, infinite, p[1] + 0.1 * random.normal()};
    };
    const double infinity = std::numeric_limits<double>::infinity();
    const MatchOptions options{.ranges = {{0, 1}, {0, 1}}, .draws = 400, .seed = 3};
    const Match found = match(model, std::vector<double>{0.4, 0.5, infinity, 0.7}, options);
    CHECK(found.parameters[0].value == Approx(0.4).margin(0.03));
    CHECK(found.parameters[1].value == Approx(0.7).margin(0.04));
    CHECK(found.parameters[0].standard_error == Approx(0.095).epsilon(0.2));
    CHECK(found.reduced_chi2 < 10);
    const auto same = [](std::span<const double>, std::uint64_t) { return std::vector<double>{0.1 + 0.2}; };
    CHECK_FALSE(match(same, std::vector<double>{0.3}, options).has_settled);
    const auto exact = [](std::span<const double> p, std::uint64_t) { return std::vector<double>{p[0] + p[1] / 2}; };
    const Match sum = match(exact, std::vector<double>{0.6}, options);
    CHECK(sum.parameters[0].value + sum.parameters[1].value / 2 == Approx(0.6).margin(1e-4));
    CHECK(sum.parameters[0].standard_error > 0.05);
    CHECK_THROWS_AS(match(exact, std::vector<double>{0.6}, {.ranges = {{0, 1}, {1, 1}}}), Error);
}

TEST_CASE("Estimates stay in their ranges, and statistics that were not measured are left out") {
    const MatchOptions options{.ranges = {{0, 1}, {0, 1}}, .most_rounds = 3, .draws = 200, .seed = 1};
    const Match beyond = match(noisy_copy(0.01), std::vector<double>{1.7, unknown}, options);
    CHECK(beyond.parameters[0].value == Approx(1).margin(1e-12));
    CHECK(beyond.parameters[0].interval95[1] <= 1);
    CHECK(beyond.identified[1] == 0);
    const Match nothing = match(noisy_copy(0.01), std::vector<double>{unknown, unknown}, options);
    CHECK(nothing.parameters[0].value == 0.5);
    CHECK(nothing.identified[0] == 0);
}

TEST_CASE("Statistics that repeat each other do no harm") {
    const auto model = [](std::span<const double> p, std::uint64_t seed) {
        Random random(seed, 13);
        const double s = p[0] + 0.1 * random.normal();
        return std::vector<double>{s, 1 - s};
    };
    const Match found =
        match(model, std::vector<double>{0.4, 0.6}, {.ranges = {{0, 1}}, .most_rounds = 3, .draws = 400, .seed = 1});
    CHECK(found.parameters[0].value == Approx(0.4).margin(0.03));
    CHECK(found.parameters[0].standard_error == Approx(0.0945).epsilon(0.15));  // 1/√(100 + 12)
}

TEST_CASE("A statistic that outcomes often lack is left out, and too few whole outcomes are refused") {
    const auto rare = [](std::span<const double> p, std::uint64_t seed) {
        Random random(seed, 14);
        return std::vector<double>{p[0] + 0.1 * random.normal(), seed % 5 == 0 ? unknown : p[0]};
    };
    const Match found =
        match(rare, std::vector<double>{0.4, 0.9}, {.ranges = {{0, 1}}, .most_rounds = 2, .draws = 200, .seed = 1});
    CHECK(found.parameters[0].value == Approx(0.4).margin(0.03));
    CHECK(found.outcomes == 400);  // of both rounds
    const auto later = [](std::span<const double> p, std::uint64_t seed) {
        return std::vector<double>{seed > 300 ? unknown : p[0]};
    };
    CHECK_THROWS_AS(match(later, std::vector<double>{0.4}, {.ranges = {{0, 1}}}), Error);
}

TEST_CASE("A match is the same for any number of threads") {
    const MatchOptions options{.ranges = {{-1, 1}, {0, 1}}, .most_rounds = 3, .draws = 100, .seed = 4};
    const auto with = [&](int threads) {
        const ThreadLimit limit(threads);
        return match(bent, std::vector<double>{1.5, 1.2}, options).parameters;
    };
    const auto one = with(1), three = with(3);
    for (std::size_t i = 0; i < one.size(); ++i) CHECK(one[i].value == three[i].value);
}
