// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thalweg/core/point.hpp"
#include "thalweg/evolve/noise.hpp"

namespace thalweg::evolve {

struct Box {
    Point low, high;
};

/// Throws Error if there are no positions.
Box bounding_box(std::span<const Point> positions);

/// How uplift, rain or rock vary over the domain's bounding box, relative to their largest value.
enum class Pattern {
    constant,  ///< 1 everywhere
    gradient,  ///< rising linearly along a direction, from 0 at the last corner of the box against it to 1 at the first
    stepped,   ///< the gradient cut into equal strips of 1/steps, 2/steps … 1
    diamond,   ///< 1 − |x|/a − |y|/b about the middle, a and b half the sides; 0 beyond
    radial,    ///< 1 in the middle, falling linearly to 0 at half the shorter side
    noise      ///< fractal noise, its values over the box spread from 0 to 1
};

struct Shape {
    Pattern pattern = Pattern::constant;
    double direction_deg = 0;                  ///< where gradient and steps rise to, clockwise from north
    int steps = 4;                             ///< of `stepped`
    NoiseVariant variant = NoiseVariant::fbm;  ///< of `noise`
    double noise_scale = 4;                    ///< first octave's lattice cells along the box's longer side
    std::uint64_t seed = 1;                    ///< of `noise`
};

/// The shape at every position, from 0 to 1. Noise is spread between its extremes on a lattice of 128 × 128 places over
/// the box, so that it does not depend on the positions; what lies beyond them is cut off.
/// Throws Error for fewer than one step or a noise scale that is not positive.
std::vector<double> pattern_values(const Shape&, const Box&, std::span<const Point> positions);

/// Lines along which something is lower or higher than elsewhere.
struct Corridor {
    std::vector<std::vector<Point>> lines;  ///< m
    double width_m;                         ///< of the whole corridor
    double value;                           ///< on the line, relative to 1 elsewhere
};

/// The corridors at every position: 1 + (value − 1)·(1 − (2d/width)²)², d the distance to the nearest of the lines,
/// where that is under half the width, and 1 elsewhere. Of several corridors the lowest of those below 1 times the
/// highest of those above 1 counts, divided by the highest value above 1 that any corridor has: never more than 1.
/// Cost: the places within the corridors' pieces, and a sort of the positions.
/// Throws Error for a width that is not positive or a value that is negative or not finite.
std::vector<double> corridor_values(std::span<const Corridor>, std::span<const Point> positions);

}  // namespace thalweg::evolve
