// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/rays.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "thalweg/core/parallel.hpp"

namespace thalweg::render {
namespace {

/// Lifts rays off the surface that they start from: a hundredth of a cell of a DEM of 5000² cells, and well above the
/// rounding of floats.
constexpr double lift = 2e-6;

}  // namespace

Rays::Rays(const TriangleSurface& ground, const TriangleSurface& sides)
    : device_(rtcNewDevice("set_affinity=0")) {
    if (!device_) throw std::bad_alloc();
    scene_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Vector low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
    for (const TriangleSurface* s : {&ground, &sides}) {
        for (const auto& t : s->triangles) {
            for (const Index v : t) {
                low = {std::min(low.x, s->x[v]), std::min(low.y, s->y[v]), std::min(low.z, s->z[v])};
                high = {std::max(high.x, s->x[v]), std::max(high.y, s->y[v]), std::max(high.z, s->z[v])};
            }
        }
    }
    middle_ = 0.5 * (low + high);
    size_ = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
    attach(ground, 0);
    if (!sides.triangles.empty()) attach(sides, 1);
    {
        const ThreadLimit one(1);  // not by the device's own setting, which would hold for our threads, too
        rtcCommitScene(scene_.get());
    }
    if (rtcGetDeviceError(device_.get()) != RTC_ERROR_NONE) throw std::bad_alloc();
}

void Rays::attach(const TriangleSurface& s, Index id) {
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), std::max<Index>(1, s.size())));
    auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), s.triangles.size()));
    if (vertices == nullptr || corners == nullptr) {
        rtcReleaseGeometry(geometry);
        throw std::bad_alloc();
    }
    for (Index v = 0; v < s.size(); ++v) {
        const Vector place = (1 / size_) * (Vector{s.x[v], s.y[v], s.z[v]} - middle_);
        for (const double coordinate : {place.x, place.y, place.z}) {
            *vertices++ = std::isfinite(coordinate) ? static_cast<float>(coordinate) : 0.0f;  // no triangle uses it
        }
    }
    for (const auto& t : s.triangles) corners = std::copy(t.begin(), t.end(), corners);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene_.get(), geometry, id);
    rtcReleaseGeometry(geometry);
}

RTCRay Rays::ray(const Vector& from, const Vector& along, double distance) const {
    const Vector origin = (1 / size_) * (from - middle_);
    RTCRay ray{};
    ray.org_x = static_cast<float>(origin.x);
    ray.org_y = static_cast<float>(origin.y);
    ray.org_z = static_cast<float>(origin.z);
    ray.dir_x = static_cast<float>(along.x);
    ray.dir_y = static_cast<float>(along.y);
    ray.dir_z = static_cast<float>(along.z);
    ray.tnear = 0;
    ray.tfar = static_cast<float>(distance / size_);
    ray.mask = 0xffffffff;
    return ray;
}

Hit Rays::first(const Vector& from, const Vector& along) const {
    RTCRayHit query{};
    query.ray = ray(from, along, std::numeric_limits<double>::infinity());
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_.get(), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {.surface = query.hit.geomID,
            .triangle = query.hit.primID,
            .u = query.hit.u,
            .v = query.hit.v,
            .normal = {query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z}};
}

bool Rays::blocked(const Vector& from, const Vector& normal, const Vector& along, double distance) const {
    RTCRay query = ray(from + lift * size_ * normal, along, distance);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_.get(), &context, &query);
    return query.tfar < 0;
}

}  // namespace thalweg::render
