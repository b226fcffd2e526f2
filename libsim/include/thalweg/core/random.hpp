// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace thalweg {

/// Philox 4×32-10 (Salmon et al. 2011): 128 random bits as a pure function of a counter and a key, so that the draw for
/// node i is the same whichever thread asks for it, and in whatever order.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key);

/// Uniform number in [0, 1) with 53 random bits: the draw numbered `number` of the stream `stream` of `seed`.
double uniform_at(std::uint64_t seed, std::uint32_t stream, std::uint64_t number);

/// The draws of one stream one after the other.
class Random {
  public:
    Random(std::uint64_t seed, std::uint32_t stream) : seed_(seed), stream_(stream) {}

    /// Next uniform number in [0, 1).
    double uniform() { return uniform_at(seed_, stream_, number_++); }
    /// Next normal number, mean 0 and standard deviation 1 (Box & Muller 1958).
    double normal();
    /// Next whole number in [0, count).
    std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(uniform() * count); }

  private:
    std::uint64_t seed_;
    std::uint32_t stream_;
    std::uint64_t number_ = 0;
};

}  // namespace thalweg
