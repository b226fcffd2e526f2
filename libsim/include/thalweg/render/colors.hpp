// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/point.hpp"
#include "thalweg/render/picture.hpp"

namespace thalweg::render {

/// Rise over run of every cell, central differences over the neighbours that have data; 0 where none has, NaN at no
/// data.
std::vector<double> gradients(const Grid&, std::span<const double> heights_m);

/// One light neutral colour.
std::vector<Rgb> clay_colors(std::size_t count);

/// Tints by height, from green lowlands over ochre to white.
std::vector<Rgb> elevation_colors(std::span<const double> heights_m);

/// What nature's colours depend on, cell by cell.
struct Nature {
    std::span<const Point> places;      ///< m; for the mottling of plants
    std::span<const double> heights;    ///< m
    std::span<const double> gradient;   ///< rise over run
    std::span<const double> water;      ///< 0 land – 1 water; empty: none
    std::optional<double> tree_line_m;  ///< default: at two thirds of the relief
    std::optional<double> snow_line_m;  ///< default: at 85 % of the relief, but not below 3000 m
};

/// The colouring by elevation, location and gradient of Kelley, Malin & Nielson (1988, §5): water along channels,
/// meadows on gentle slopes, forest up to the tree line, rock where it is steeper than plants hold (30° to 42°), snow
/// above the snow line but on faces above 45° to 58°. Mottled by Perlin noise of the place.
std::vector<Rgb> natural_colors(const Nature&);

}  // namespace thalweg::render
