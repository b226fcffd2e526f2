// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <limits>

#include "evolve/hillslope_patches.hpp"

namespace thalweg::evolve {

/// The derivatives of an energy W(|∇h|) at the gradient g: the flux is even·g, its derivative along v is
/// even·v + along·(g·v)·g.
struct Conduction {
    double even, along;
    Plane operator()(const Plane& g, const Plane& v) const {
        const double share = along * dot(g, v);
        return {even * v.x + share * g.x, even * v.y + share * g.y};
    }
};

/// The energy per area whose derivative by the gradient is the flux of creep: D/2·|∇h|², or with a critical slope Sc >
/// 0 −D·Sc²/2·ln(1 − |∇h|²/Sc²), convex, and infinite from Sc on.
struct CreepLaw {
    double diffusivity;
    double critical_slope;  ///< infinity: linear

    bool allows(const Plane& g) const { return dot(g, g) < critical_slope * critical_slope; }

    double energy(const Plane& g) const {
        if (std::isinf(critical_slope)) return 0.5 * diffusivity * dot(g, g);
        if (!allows(g)) return std::numeric_limits<double>::infinity();
        const double critical_square = critical_slope * critical_slope;
        return -0.5 * diffusivity * critical_square * std::log1p(-dot(g, g) / critical_square);
    }

    Conduction conduction(const Plane& g) const {
        if (std::isinf(critical_slope)) return {diffusivity, 0};
        const double critical_square = critical_slope * critical_slope;
        const double room = 1 - dot(g, g) / critical_square;
        return {diffusivity / room, 2 * diffusivity / (critical_square * room * room)};
    }
};

}  // namespace thalweg::evolve
