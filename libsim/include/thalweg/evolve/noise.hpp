// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thalweg/core/point.hpp"

namespace thalweg::evolve {

/// Improved Perlin noise (Perlin 2002) in the plane, about −1 … 1, period 256, with a permutation drawn from the seed.
class PerlinNoise {
  public:
    explicit PerlinNoise(std::uint64_t seed);
    double operator()(double x, double y) const;

  private:
    std::vector<std::uint8_t> permutation_;
};

/// Fractal sum of octaves; `scale` lattice cells lie across the length `extent_m` in the first octave.
struct Fractal {
    int octaves = 5;
    double lacunarity = 2;
    double persistence = 0.5;
    double scale = 40;
};

/// amplitude·|fBm| at every position: the initial surface of a simulation (m).
std::vector<double> perlin_surface(std::span<const Point> positions, double extent_m, double amplitude_m,
                                   std::uint64_t seed, const Fractal& = {});

/// amplitude·(uniform in [0, 1)) for each of `count` nodes.
std::vector<double> uniform_surface(std::size_t count, double amplitude_m, std::uint64_t seed);

}  // namespace thalweg::evolve
