// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <memory>

#include "thalweg/render/camera.hpp"

namespace thalweg::render {

/// Where a ray meets a triangle.
struct Hit {
    Index surface = none;  ///< 0 the ground, 1 its sides; `none`: nowhere
    Index triangle = none;
    double u = 0, v = 0;  ///< weights of the triangle's second and third corner
    Vector normal;        ///< of the triangle, not of unit length
};

/// The triangles in Embree's tree. It is built by one thread, so that it is always the same, and in units of the
/// model's size around its middle, since Embree's numbers are floats.
class Rays {
  public:
    Rays(const TriangleSurface& ground, const TriangleSurface& sides);

    Hit first(const Vector& from, const Vector& along) const;

    /// Whether anything stands in the way from a place on the surface, seen from the side that `normal` (a unit vector)
    /// points to; up to `distance` (m).
    bool blocked(const Vector& from, const Vector& normal, const Vector& along, double distance) const;

  private:
    struct Release {
        void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
        void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
    };
    void attach(const TriangleSurface&, Index id);
    RTCRay ray(const Vector& from, const Vector& along, double distance) const;

    std::unique_ptr<RTCDeviceTy, Release> device_;
    std::unique_ptr<RTCSceneTy, Release> scene_;
    Vector middle_;
    double size_ = 1;  ///< m
};

}  // namespace thalweg::render
