// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/evolve/noise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "thalweg/core/error.hpp"
#include "thalweg/core/random.hpp"

namespace thalweg::evolve {
namespace {

// Streams of the seed that belong to this file ("per", "oct", "uni"), so that no two uses share their draws.
constexpr std::uint32_t permutation_stream = 0x706572;
constexpr std::uint32_t offset_stream = 0x6f6374;
constexpr std::uint32_t surface_stream = 0x756e69;

double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }

double mix(double share, double from, double to) { return from + share * (to - from); }

/// Product of (x, y, z) with one of the twelve directions to the edges of a cube, four of them listed twice.
double gradient(unsigned hash, double x, double y, double z) {
    constexpr std::array<std::array<double, 3>, 16> directions{{{1, 1, 0},
                                                                {-1, 1, 0},
                                                                {1, -1, 0},
                                                                {-1, -1, 0},
                                                                {1, 0, 1},
                                                                {-1, 0, 1},
                                                                {1, 0, -1},
                                                                {-1, 0, -1},
                                                                {0, 1, 1},
                                                                {0, -1, 1},
                                                                {0, 1, -1},
                                                                {0, -1, -1},
                                                                {1, 1, 0},
                                                                {0, -1, 1},
                                                                {-1, 1, 0},
                                                                {0, -1, -1}}};
    const auto& d = directions[hash & 15U];
    return d[0] * x + d[1] * y + d[2] * z;
}

/// A coordinate as the lattice cell that holds it (0 … 255) and the position inside that cell.
struct LatticePosition {
    unsigned cell;
    double inside;

    explicit LatticePosition(double value) {
        const double whole = std::floor(value);
        inside = value - whole;
        cell = static_cast<unsigned>(whole - 256 * std::floor(whole / 256));
    }
};

void check_fractal(double extent_m, const Fractal& fractal) {
    if (extent_m > 0 && fractal.scale > 0 && fractal.octaves >= 1) return;
    throw Error(
        fmt::format("fractal noise needs a positive extent and scale and at least one octave, not {} m, {} and {}",
                    extent_m, fractal.scale, fractal.octaves));
}

double total_weight(const Fractal& fractal) {
    double weight = 1;
    double weights = 0;
    for (int octave = 0; octave < fractal.octaves; ++octave) {
        weights += std::abs(weight);
        weight *= fractal.persistence;
    }
    return weights;
}

double of_variant(NoiseVariant variant, double octave) {
    if (variant == NoiseVariant::billow) return std::abs(octave);
    return variant == NoiseVariant::ridge ? 1 - std::abs(octave) : octave;
}

/// Octaves added up by their weights, each as the variant wants it; `seed` shifts them.
std::vector<double> summed(const PerlinNoise& noise, std::span<const Point> positions, double extent_m,
                           std::uint64_t seed, NoiseVariant variant, const Fractal& fractal) {
    std::vector<double> sum(positions.size(), 0.0);
    double frequency = fractal.scale / extent_m;
    double weight = 1;
    for (int octave = 0; octave < fractal.octaves; ++octave) {
        const double shift_x = 256 * uniform_at(seed, offset_stream, 2 * octave);
        const double shift_y = 256 * uniform_at(seed, offset_stream, 2 * octave + 1);
        for (std::size_t i = 0; i < positions.size(); ++i) {
            const double own = noise(positions[i].x * frequency + shift_x, positions[i].y * frequency + shift_y);
            sum[i] += weight * of_variant(variant, own);
        }
        weight *= fractal.persistence;
        frequency *= fractal.lacunarity;
    }
    return sum;
}

}  // namespace

PerlinNoise::PerlinNoise(std::uint64_t seed) : permutation_(256) {
    std::iota(permutation_.begin(), permutation_.end(), std::uint8_t{0});
    Random random(seed, permutation_stream);
    for (std::uint32_t left = 256; left > 1; --left)
        std::swap(permutation_[left - 1], permutation_[random.below(left)]);
}

PerlinNoise::PerlinNoise(std::span<const std::uint8_t> permutation)
    : permutation_(permutation.begin(), permutation.end()) {
    std::vector<std::uint8_t> sorted = permutation_;
    std::ranges::sort(sorted);
    bool complete = sorted.size() == 256;
    for (unsigned i = 0; complete && i < 256; ++i) complete = sorted[i] == i;
    if (!complete) throw Error("Perlin noise needs each of the numbers 0 to 255 once as its permutation");
}

std::uint8_t PerlinNoise::lattice_hash(unsigned x, unsigned y, unsigned z) const {
    const auto at = [&](unsigned index) { return unsigned{permutation_[index & 255U]}; };
    return static_cast<std::uint8_t>(at(at(at(x) + y) + z));
}

double PerlinNoise::operator()(double x, double y, double z) const {
    const LatticePosition px(x), py(y), pz(z);
    const auto corner = [&](unsigned i, unsigned j, unsigned k) {
        return gradient(lattice_hash(px.cell + i, py.cell + j, pz.cell + k), px.inside - i, py.inside - j,
                        pz.inside - k);
    };
    const double u = fade(px.inside);
    const double v = fade(py.inside);
    const auto layer = [&](unsigned k) {
        return mix(v, mix(u, corner(0, 0, k), corner(1, 0, k)), mix(u, corner(0, 1, k), corner(1, 1, k)));
    };
    const double w = fade(pz.inside);
    return w == 0 ? layer(0) : mix(w, layer(0), layer(1));
}

std::vector<double> fractal_noise(std::span<const Point> positions, double extent_m, std::uint64_t seed,
                                  NoiseVariant variant, const Fractal& fractal) {
    check_fractal(extent_m, fractal);
    const PerlinNoise noise(seed);
    const double weight = total_weight(fractal);
    std::vector<Point> places(positions.begin(), positions.end());
    if (variant == NoiseVariant::warped) {
        const double reach_m = 2 * extent_m / fractal.scale;
        const auto shift_x = summed(noise, positions, extent_m, seed + 1, NoiseVariant::fbm, fractal);
        const auto shift_y = summed(noise, positions, extent_m, seed + 2, NoiseVariant::fbm, fractal);
        for (std::size_t i = 0; i < places.size(); ++i) {
            places[i].x += reach_m * shift_x[i] / weight;
            places[i].y += reach_m * shift_y[i] / weight;
        }
    }
    std::vector<double> values = summed(noise, places, extent_m, seed, variant, fractal);
    for (double& value : values) value /= weight;
    return values;
}

std::vector<double> perlin_surface(std::span<const Point> positions, double extent_m, double amplitude_m,
                                   std::uint64_t seed, const Fractal& fractal) {
    check_fractal(extent_m, fractal);
    std::vector<double> surface = summed(PerlinNoise(seed), positions, extent_m, seed, NoiseVariant::fbm, fractal);
    const double weight = total_weight(fractal);
    for (double& height : surface) height = amplitude_m * std::abs(height) / weight;
    return surface;
}

std::vector<double> uniform_surface(std::size_t count, double amplitude_m, std::uint64_t seed) {
    std::vector<double> surface(count);
    for (std::size_t i = 0; i < count; ++i) surface[i] = amplitude_m * uniform_at(seed, surface_stream, i);
    return surface;
}

}  // namespace thalweg::evolve
