// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "thalweg/core/index.hpp"
#include "thalweg/core/statistics.hpp"

namespace thalweg::infer {

/// A random model: the statistics of one outcome with these parameters; NaN where one is undefined. The same seed gives
/// the same outcome. It is called from several threads.
using RandomModel = std::function<std::vector<double>(std::span<const double> parameters, std::uint64_t seed)>;

struct MatchOptions {
    std::vector<std::array<double, 2>> ranges;  ///< of the parameters: what is thought possible beforehand, evenly
    Index rounds = 4;
    Index draws = 300;  ///< outcomes in each round
    std::uint64_t seed = 1;
};

struct Match {
    std::vector<Estimate> parameters;      ///< within their ranges
    std::vector<std::uint8_t> identified;  ///< 1 where the statistics have at least halved what the range left open
    Index outcomes;                        ///< with all statistics, of those of the last round
    Index rounds;                          ///< fewer than asked for where no statistic can be used
    double last_step;  ///< by how many of its standard errors the last round moved the parameter that it moved most
};

/// The parameters of a random model, given the statistics of one outcome: what is measured need not be what was put in,
/// only depend on it.
///
/// In each round the parameters are drawn over a box and the statistics regressed on them and their products, s = r(p)
/// + e. With the residuals' covariance Σ and the ranges' own mean p₀ and variance V (of a uniform distribution, L²/12),
/// the estimate is that of least (s* − r)ᵀ Σ⁻¹ (s* − r) + (p − p₀)ᵀ V⁻¹ (p − p₀), its covariance (RᵀΣ⁻¹R + V⁻¹)⁻¹ with
/// the slopes R there: what the statistics leave open stays near the middle of its range, with an error as wide. The
/// next box is the estimate and three errors about it, so that the regression need hold there only (Gaussian indirect
/// inference; Gouriéroux, Monfort & Renault 1993; Wood 2010). The errors include the chance in the one outcome that was
/// measured.
///
/// Statistics whose target is NaN, or that a tenth of the first round's outcomes lack, are left out; so are outcomes
/// that lack one of the others. Same bytes for any number
/// of threads. Throws Error where a round has fewer outcomes with all of them than one and a half times the
/// regression's terms, (P + 1)(P + 2)/2 for P parameters.
Match match(const RandomModel&, std::span<const double> target, const MatchOptions&);

}  // namespace thalweg::infer
