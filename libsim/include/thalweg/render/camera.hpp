// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <numbers>

#include "thalweg/core/point.hpp"
#include "thalweg/core/triangle_surface.hpp"

namespace thalweg::render {

/// East, north, up (m); also directions.
struct Vector {
    double x = 0, y = 0, z = 0;
};

inline Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector operator*(double s, const Vector& a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector cross(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vector unit(const Vector&);  ///< of length 1 in the same direction

/// Towards a compass bearing (clockwise from the north) and an angle above the horizon, radians.
Vector direction(double azimuth, double elevation);

/// How one wants to look at a terrain. Radians.
struct View {
    double azimuth = 200 * std::numbers::pi / 180;       ///< bearing from the terrain to the viewer
    double elevation = 30 * std::numbers::pi / 180;      ///< of the viewer above the horizon, up to π/2: straight down
    double field_of_view = 30 * std::numbers::pi / 180;  ///< across the longer side of the picture
    Index width = 1280, height = 800;                    ///< pixels
    double margin = 0.04;                                ///< left free on each side, of the picture's side
};

/// A pinhole camera. Pixel coordinates run from the upper left corner of the picture, so that the first pixel's centre
/// is (0.5, 0.5).
struct Camera {
    Vector eye;
    Vector right, up, forward;       ///< unit vectors
    double half_width, half_height;  ///< of the picture, at distance 1 along `forward`
    Index width, height;             ///< pixels

    /// Where a place appears; meaningless behind the eye.
    Point project(const Vector& place) const;
    /// From the eye through a place of the picture; not of unit length (1 along `forward`).
    Vector ray(const Point& pixel) const;
};

/// The camera of that view from which the vertices that triangles use fill the picture exactly, up to the margin: the
/// nearest such place. Throws Error for surfaces without triangles, and for a view that cannot be: no pixels, a field
/// of view outside 0–170°, an elevation outside 0–90°.
Camera fitting_camera(const View&, const TriangleSurface&, const TriangleSurface& sides = {});

}  // namespace thalweg::render
