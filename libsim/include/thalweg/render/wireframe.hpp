// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "thalweg/core/grid.hpp"
#include "thalweg/core/triangle_surface.hpp"
#include "thalweg/render/camera.hpp"
#include "thalweg/render/picture.hpp"

namespace thalweg::render {

/// A straight line of a drawing, in pixels.
struct Stroke {
    Point from, to;
};

using Edge = std::pair<Index, Index>;

/// The grid's lines: from every cell with data to its eastern and southern neighbour with data.
std::vector<Edge> grid_edges(const Grid&, std::span<const double> heights_m);

/// What can be seen of the edges between a surface's vertices, hidden lines removed: every edge is cut into pieces of a
/// 24th, each tried by a ray to the eye, and where sight changes the place is halved in eight times. In the order of
/// the edges; the same for any number of threads.
std::vector<Stroke> visible_strokes(const TriangleSurface&, std::span<const Edge>, const Camera&);

/// Draws lines of a width (pixels) over a picture, smoothly.
void draw(Picture&, std::span<const Stroke>, double line_width, const Rgb&);

/// A triangle of a drawing with its colour.
struct Facet {
    std::array<Point, 3> corners;  ///< pixels
    Rgb color;
};

/// The surface's triangles from the farthest to the nearest, by the distance of their middles from the eye: painted in
/// this order nearer ones cover farther ones. Lit without shadows: light from the sun by Lambert's law, and the whole
/// sky for what lies level, half of it for what stands upright.
struct Light;
struct Model;
std::vector<Facet> painted_facets(const Model&, const Camera&, const Light&);

/// A drawing as an SVG file: facets, then strokes, on white.
std::string svg_of(Index width, Index height, std::span<const Facet>, std::span<const Stroke>, double line_width);

}  // namespace thalweg::render
