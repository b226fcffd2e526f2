// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/model.hpp"

#include <cmath>
#include <numbers>

#include "thalweg/core/error.hpp"

namespace thalweg::study {
namespace {

evolve::River river_of(const Experiment& e) {
    if (!e.river.k) throw Error("river.k (erodibility) is needed");
    if (!e.river.m) throw Error("river.m (exponent of the drainage area) is needed");
    evolve::River river{.k = *e.river.k,
                        .m = *e.river.m,
                        .n = e.river.n,
                        .receiver = e.river.receiver,
                        .flow = e.river.flow,
                        .flow_exponent = e.river.flow_exponent,
                        .g = e.deposition.g};
    if (e.hillslope.talus_angle_deg) {
        const double angle = *e.hillslope.talus_angle_deg;
        if (angle < 90) river.talus_slope = std::tan(angle * std::numbers::pi / 180);
    }
    return river;
}

evolve::Hillslope hillslope_of(const Experiment& e) {
    const evolve::Hillslope hillslope{e.hillslope.diffusivity_m2_per_yr, e.hillslope.critical_slope};
    if (hillslope.critical_slope > 0 && hillslope.diffusivity_m2_per_yr == 0) {
        throw Error("hillslope.critical_slope has no effect without hillslope.diffusivity_m2_per_yr: give both");
    }
    if (hillslope.diffusivity_m2_per_yr > 0 && e.time.solver == Solver::steady) {
        throw Error(
            "hillslope.diffusivity_m2_per_yr needs time.solver = \"implicit\": the steady solver knows rivers and the "
            "talus limit only");
    }
    return hillslope;
}

}  // namespace

evolve::Model model_of(const Experiment& e) { return {.river = river_of(e), .hillslope = hillslope_of(e)}; }

}  // namespace thalweg::study
