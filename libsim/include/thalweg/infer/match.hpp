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
    Index most_rounds = 12;
    Index draws = 300;  ///< outcomes in each round
    std::uint64_t seed = 1;
};

struct Match {
    std::vector<Estimate> parameters;      ///< within their ranges
    std::vector<std::uint8_t> identified;  ///< 1 where the statistics have at least halved what the range left open
    Index outcomes = 0;                    ///< with all statistics, of all rounds
    Index rounds = 0;
    double last_step = 0;  ///< by how many of its standard errors the last round moved the parameter that it moved most
    bool has_settled = false;       ///< the last two rounds moved no parameter by more than 0.3 of its standard errors
    double degrees_of_freedom = 0;  ///< ν
    double reduced_chi2 = 0;  ///< χ²/ν at the estimate: far above 1 where the model cannot make such statistics
};

/// The parameters of a random model, given the statistics of one outcome: what is measured need not be what was put in,
/// only depend on it.
///
/// In each round the parameters are drawn over a box and the statistics of all outcomes in it, of this round and those
/// before, regressed on them and their products, s = r(p) + e. With the residuals' covariance Σ and the ranges' own
/// mean p₀ and variance V (of a uniform distribution, L²/12), the estimate is that of least χ² + (p − p₀)ᵀ V⁻¹ (p − p₀)
/// within the box, χ² = (s* − r)ᵀ Σ⁻¹ (s* − r). Its covariance is (RᵀR/f + V⁻¹)⁻¹ with the whitened slopes R there:
/// what the statistics leave open stays near the middle of its range, with an error as wide. In f stand how few
/// outcomes r comes from, 1 + its variance over Σ, and χ²/ν where that exceeds 1, for a model that cannot meet the
/// statistics cannot tell its parameters as well as its own scatter promises; ν is their number less the trace of what
/// the parameters take up, so that χ²/ν is 1 on average where the model is true. The next box is the estimate and three
/// errors about it, so that the regression need hold there only, and rounds go on until two in a row have moved nothing
/// (Gaussian indirect inference; Gouriéroux, Monfort & Renault 1993; Wood 2010). The errors include the chance in
/// the one outcome that was measured.
///
/// Intervals are 1.96 errors wide, and Student's for ν (2 at least) where χ²/ν exceeds 2: so few degrees hardly tell
/// how far off the model is.
///
/// Statistics whose target is not finite, that a tenth of the first round's outcomes lack, or that are the same in all
/// of them are left out; so are outcomes that lack one of the others. Same bytes for any number of threads. Throws
/// Error for a range without width, and where a box holds fewer outcomes with all of them than one and a half times the
/// regression's terms, (P + 1)(P + 2)/2 for P parameters.
Match match(const RandomModel&, std::span<const double> target, const MatchOptions&);

}  // namespace thalweg::infer
