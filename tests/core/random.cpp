// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/core/random.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

using namespace thalweg;

namespace {

using Words4 = std::array<std::uint32_t, 4>;
using Words2 = std::array<std::uint32_t, 2>;

}  // namespace

// The known answers that the authors of the generator publish with it (Random123, kat_vectors, philox4x32 10).
TEST_CASE("Philox gives the published known answers") {
    CHECK(philox(Words4{0, 0, 0, 0}, Words2{0, 0}) == Words4{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
    constexpr std::uint32_t ones = 0xffffffff;
    CHECK(philox(Words4{ones, ones, ones, ones}, Words2{ones, ones}) ==
          Words4{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
    CHECK(philox(Words4{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, Words2{0xa4093822, 0x299f31d0}) ==
          Words4{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
}

TEST_CASE("A stream gives the draws that its numbers name") {
    Random stream(7, 3);
    for (std::uint64_t number = 0; number < 100; ++number) CHECK(stream.uniform() == uniform_at(7, 3, number));
}

TEST_CASE("Seeds, streams and numbers beyond 32 bits give other draws") {
    const double here = uniform_at(1, 2, 3);
    CHECK(here != uniform_at(1 + (std::uint64_t{1} << 32), 2, 3));
    CHECK(here != uniform_at(1, 4, 3));
    CHECK(here != uniform_at(1, 2, 3 + (std::uint64_t{1} << 32)));
}

TEST_CASE("Uniform draws fill [0, 1) evenly") {
    Random stream(11, 0);
    constexpr int bins = 64;
    constexpr int draws = 640000;
    std::array<int, bins> counts{};
    for (int i = 0; i < draws; ++i) {
        const double value = stream.uniform();
        REQUIRE(value >= 0);
        REQUIRE(value < 1);
        ++counts[static_cast<std::size_t>(value * bins)];
    }
    double chi2 = 0;
    for (int count : counts) chi2 += std::pow(count - draws / bins, 2) / (draws / bins);
    CHECK(chi2 > 31.7);  // 0.01 % and 99.99 % of chi square with 63 degrees of freedom, rounded outwards
    CHECK(chi2 < 114);
}

TEST_CASE("Neighbouring seeds, streams and numbers are uncorrelated") {
    constexpr int draws = 100000;
    double seeds = 0, streams = 0, numbers = 0;
    for (std::uint32_t i = 0; i < draws; ++i) {
        const double here = uniform_at(5, 5, i) - 0.5;
        seeds += here * (uniform_at(6, 5, i) - 0.5);
        streams += here * (uniform_at(5, 6, i) - 0.5);
        numbers += here * (uniform_at(5, 5, i + 1) - 0.5);
    }
    const double four_sigma = 4 * std::sqrt(draws) / 12;
    CHECK(std::abs(seeds) < four_sigma);
    CHECK(std::abs(streams) < four_sigma);
    CHECK(std::abs(numbers) < four_sigma);
}

TEST_CASE("Normal draws have the moments of the normal distribution") {
    Random stream(3, 1);
    constexpr int draws = 400000;
    std::array<double, 4> moment{};
    for (int i = 0; i < draws; ++i) {
        const double value = stream.normal();
        REQUIRE(std::isfinite(value));
        for (int power = 0; power < 4; ++power) moment[power] += std::pow(value, power + 1) / draws;
    }
    const double root = std::sqrt(draws);  // four standard errors each: variances 1, 2, 15, 96
    CHECK(std::abs(moment[0]) < 4 / root);
    CHECK(std::abs(moment[1] - 1) < 4 * std::sqrt(2) / root);
    CHECK(std::abs(moment[2]) < 4 * std::sqrt(15) / root);
    CHECK(std::abs(moment[3] - 3) < 4 * std::sqrt(96) / root);
}

TEST_CASE("Whole draws cover their range and nothing else") {
    Random stream(2, 9);
    std::vector<int> counts(7, 0);
    for (int i = 0; i < 70000; ++i) {
        const std::uint32_t value = stream.below(7);
        REQUIRE(value < 7);
        ++counts[value];
    }
    for (int count : counts) CHECK(std::abs(count - 10000) < 4 * std::sqrt(10000 * 6.0 / 7));
    for (int i = 0; i < 10; ++i) CHECK(stream.below(1) == 0);
}
