// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "thalweg/core/triangle_surface.hpp"
#include "thalweg/render/camera.hpp"
#include "thalweg/render/picture.hpp"

namespace thalweg::render {

enum class Shading {
    smooth,  ///< normals at the vertices, the mean of the triangles around weighted by their area
    facets   ///< every triangle plain
};

/// What is drawn: a terrain with a colour at each of its vertices, and, where it is a block, its sides in one colour.
/// Vertices that no triangle uses are left out (and may be NaN).
struct Model {
    TriangleSurface ground;
    std::vector<Rgb> color;  ///< reflectance of each of the ground's vertices, 0–1
    TriangleSurface sides;
    Rgb side_color;
    std::vector<Vector> side_normals =
        {};                     ///< unit vectors by which each of the sides' triangles is lit; empty: its own
    double side_clearance = 0;  ///< with these: the sides are lit as if they stood so much further out
    Shading shading = Shading::smooth;
};

struct Light {
    Vector to_sun{0, 0, 1};      ///< unit vector; a sun at or under the horizon gives no light
    double sun_radius = 0.0047;  ///< radians; makes the edges of shadows soft
    Rgb sun{1, 1, 1};            ///< reflected by a white plane that faces the sun
    Rgb sky{0, 0, 0};            ///< reflected by a white plane under the open sky
};

struct Sampling {
    Index samples = 16;  ///< per pixel; 1: its centre
    Index sky_rays = 4;  ///< per sample; 0: no sky light
};

/// The model in the camera's picture: rays against the triangles (Embree), Lambert's law, shadows of the sun, and the
/// sky's light (the same from everywhere) from directions weighted by the cosine. Places in the pixel and directions
/// come from low-discrepancy sequences (additive recurrence by the plastic number, Roberts 2018) shifted by a hash of
/// the pixel's number: the same bytes for any number of threads. No light is passed from slope to slope.
/// Throws Error for samples 0, a model without triangles, or a colour list of another length than the vertices.
Picture trace(const Model&, const Camera&, const Light&, const Sampling&);

}  // namespace thalweg::render
