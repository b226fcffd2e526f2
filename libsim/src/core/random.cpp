// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/core/random.hpp"

#include <cmath>
#include <numbers>

namespace thalweg {
namespace {

// Multipliers and key increments of Salmon et al. (2011), table 2.
constexpr std::uint64_t multiplier_0 = 0xD2511F53;
constexpr std::uint64_t multiplier_1 = 0xCD9E8D57;
constexpr std::uint32_t golden_ratio = 0x9E3779B9;
constexpr std::uint32_t root_three = 0xBB67AE85;

}  // namespace

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
    for (int round = 0; round < 10; ++round) {
        const std::uint64_t product_0 = multiplier_0 * counter[0];
        const std::uint64_t product_1 = multiplier_1 * counter[2];
        counter = {
            static_cast<std::uint32_t>(product_1 >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(product_1),
            static_cast<std::uint32_t>(product_0 >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(product_0)};
        key[0] += golden_ratio;
        key[1] += root_three;
    }
    return counter;
}

double uniform_at(std::uint64_t seed, std::uint32_t stream, std::uint64_t number) {
    const auto bits = philox({static_cast<std::uint32_t>(number), static_cast<std::uint32_t>(number >> 32), stream, 0},
                             {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
    const std::uint64_t word = std::uint64_t{bits[1]} << 32 | bits[0];
    return static_cast<double>(word >> 11) * 0x1p-53;
}

double Random::normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));  // 1 − uniform is in (0, 1]: no log of zero
    return radius * std::cos(2 * std::numbers::pi * uniform());
}

}  // namespace thalweg
