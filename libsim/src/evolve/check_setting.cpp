// SPDX-License-Identifier: GPL-3.0-or-later
#include "evolve/check_setting.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "thalweg/core/error.hpp"

namespace thalweg::evolve {
namespace {

void check_count(const char* what, std::size_t found, std::size_t needed) {
    if (found == needed) return;
    throw Error(fmt::format("a landscape of {} nodes needs as many values of {}, not {}", needed, what, found));
}

}  // namespace

void check_setting(Index nodes, const Landscape& landscape, const Setting& setting) {
    check_count("elevation", landscape.elevation_m.size(), nodes);
    check_count("uplift", setting.uplift_m_per_yr.size(), nodes);
    check_count("rainfall", setting.rainfall.size(), nodes);
    check_count("boundary", setting.boundary.size(), nodes);
    if (!setting.relative_erodibility.empty()) {
        check_count("relative erodibility", setting.relative_erodibility.size(), nodes);
    }
    check_history(setting.uplift_factor, "uplift");
    check_history(setting.base_level_m, "base level");
    const auto& factor = setting.uplift_factor.value;
    if (!std::ranges::all_of(factor, [](double value) { return value >= 0; })) {
        throw Error("the history of uplift falls below zero: subsidence is a falling base level");
    }
}

void check_river(const River& river) {
    const auto finite_and_not_negative = [](double value) { return value >= 0 && std::isfinite(value); };
    if (!finite_and_not_negative(river.k)) {
        throw Error(fmt::format("the erodibility k must be zero or more, not {}", river.k));
    }
    if (!finite_and_not_negative(river.m)) {
        throw Error(fmt::format("the area exponent m must be zero or more, not {}", river.m));
    }
    if (!(river.n >= 0.3 && river.n <= 5)) {
        throw Error(fmt::format("the slope exponent n must lie between 0.3 and 5, not {}", river.n));
    }
    if (!(river.flow_exponent > 0 && std::isfinite(river.flow_exponent))) {
        throw Error(
            fmt::format("the exponent of multiple flow must be a positive number, not {}", river.flow_exponent));
    }
    if (!finite_and_not_negative(river.g)) {
        throw Error(fmt::format("the deposition coefficient G must be zero or more, not {}", river.g));
    }
    if (!(river.talus_slope > 0)) {
        throw Error(fmt::format("the talus slope must be positive, not {}", river.talus_slope));
    }
}

void check_hillslope(const Hillslope& hillslope) {
    const auto sound = [](double value) { return value >= 0 && std::isfinite(value); };
    if (!sound(hillslope.diffusivity_m2_per_yr)) {
        throw Error(
            fmt::format("the hillslope diffusivity must be zero or more, not {}", hillslope.diffusivity_m2_per_yr));
    }
    if (!sound(hillslope.critical_slope)) {
        throw Error(fmt::format("the critical slope must be positive, or zero for linear diffusion, not {}",
                                hillslope.critical_slope));
    }
}

void check_step(double dt_yr) {
    if (dt_yr > 0 && std::isfinite(dt_yr)) return;
    throw Error(fmt::format("the time step must be a positive number of years, not {}", dt_yr));
}

void check_frozen(Index nodes, const FlowDirections& frozen) {
    if (!frozen.empty()) check_count("frozen directions", frozen.size(), nodes);
}

}  // namespace thalweg::evolve
