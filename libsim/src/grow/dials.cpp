// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "thalweg/core/error.hpp"
#include "thalweg/grow/grow.hpp"

namespace thalweg::grow {
namespace {

void check_range(std::string_view dial, double value, double least, double most) {
    if (value >= least && value <= most) return;
    throw Error(fmt::format("{} is {}: it must be from {} to {}", dial, value, least, most));
}

}  // namespace

void check_dials(const Dials& dials) {
    check_range("channel_maintenance_m", dials.channel_maintenance_m, 1e-9, 1e9);
    check_range("mean_junction", dials.mean_junction, 0, 1);
    check_range("delta_junction", dials.delta_junction, 0, 1);
    check_range("mean_length", dials.mean_length, 1e-3, 1);
    check_range("delta_length", dials.delta_length, 0, 1);
    check_range("flint_p", dials.flint.p, 1e-9, 10);
    check_range("flint_q", dials.flint.q, -2, -0.05);
    check_range("delta_sidewall_angle_deg", dials.delta_sidewall_angle_deg, 0, 44);
    const double delta = dials.delta_sidewall_angle_deg;
    check_range("sidewall_angle_deg", dials.sidewall_angle_deg, 1 + delta, 89 - delta);
    if (!(dials.sidewall_reach_m > 0)) {
        throw Error(fmt::format("sidewall_reach_m is {}: it must be above 0", dials.sidewall_reach_m));
    }
    for (const auto& [place, divide] :
         {std::pair{"across", dials.divide_across}, {"below", dials.divide_below}, {"above", dials.divide_above}}) {
        check_range(fmt::format("divide_{}", place), divide.mean, 0.1, 0.9);
        check_range(fmt::format("delta_divide_{}", place), divide.delta, 0, 0.8);
    }
    check_range("lower_bias", dials.lower_bias, 0, 1);
    check_range("middle_bias", dials.middle_bias, 0, 1);
}

}  // namespace thalweg::grow
