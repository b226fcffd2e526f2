// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thalweg/core/point.hpp"

namespace thalweg::evolve {

/// Improved Perlin noise (Perlin 2002), about −1 … 1, 0 at whole numbers, period 256 in each direction. In the plane it
/// is the slice z = 0 of the noise in space.
class PerlinNoise {
  public:
    /// The 256 numbers in an order drawn from the seed.
    explicit PerlinNoise(std::uint64_t seed);
    /// A given order, for example Perlin's own. Throws Error unless it holds each of 0 … 255 once.
    explicit PerlinNoise(std::span<const std::uint8_t> permutation);
    double operator()(double x, double y, double z = 0) const;

  private:
    std::uint8_t lattice_hash(unsigned x, unsigned y, unsigned z) const;
    std::vector<std::uint8_t> permutation_;
};

/// Fractal sum of octaves (fractional Brownian motion): octave i has frequency lacunarity^i and weight persistence^i,
/// the weights scaled to add up to 1. `scale` lattice cells lie across the length `extent_m` in the first octave. Each
/// octave is shifted by a seeded offset, so that its zeros do not fall together with those of the others.
struct Fractal {
    int octaves = 5;
    double lacunarity = 2;
    double persistence = 0.5;
    double scale = 40;
};

enum class NoiseVariant {
    fbm,     ///< the sum itself, −1 … 1
    billow,  ///< of absolute values, 0 … 1: rounded hills between creases
    ridge,   ///< of 1 − absolute values, 0 … 1: crests
    warped   ///< fBm at places that two other fBm have moved by up to two lattice cells along x and y
};

/// The variant at every position. Throws Error unless extent_m and the scale are positive and there is at least one
/// octave.
std::vector<double> fractal_noise(std::span<const Point> positions, double extent_m, std::uint64_t seed, NoiseVariant,
                                  const Fractal&);

/// amplitude·|fBm| at every position: the initial surface of a simulation (m). Throws Error unless extent_m is positive
/// and there is at least one octave.
std::vector<double> perlin_surface(std::span<const Point> positions, double extent_m, double amplitude_m,
                                   std::uint64_t seed, const Fractal& = {});

/// amplitude·(uniform in [0, 1)) for each of `count` nodes.
std::vector<double> uniform_surface(std::size_t count, double amplitude_m, std::uint64_t seed);

}  // namespace thalweg::evolve
