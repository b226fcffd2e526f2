// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "thalweg/channel/growth_measures.hpp"
#include "thalweg/grow/grow.hpp"

namespace thalweg::study {

/// One dial with where it comes from.
struct FittedDial {
    std::string name;  ///< key in the [growth] table
    Estimate value;
    Index count;  ///< of what was measured for it
    std::string source;
    bool identified;  ///< false: the network says little about it
};

/// One measure of a landscape beside that of networks grown with the fitted dials.
struct MeasureCheck {
    std::string name;
    double measured;
    double grown_mean, grown_sd;  ///< over the seeds
};

/// How networks are to grow beyond the dials.
struct GrowthRules {
    grow::UpstreamLink upstream_link = grow::Dials{}.upstream_link;
    grow::Stop stop = grow::Dials{}.stop;
};

struct DialsFit {
    grow::Dials dials;
    std::vector<FittedDial> table;
    std::vector<MeasureCheck> check;
    std::vector<std::string> notes;
    // As in infer::Match:
    Index rounds = 0;
    double last_step = 0;
    bool converged = false;
    double reduced_chi2 = 0;
    double degrees_of_freedom = 0;
};

/// C and Flint's law as measured (what growth does not take is told in `notes`), all other dials by default. Throws
/// Error for measures without C or Flint's law.
grow::Dials dials_as_measured(const channel::GrowthMeasures&, const GrowthRules&, std::vector<std::string>& notes);

/// Dials with which networks grow in a basin that measure like the one that was measured. C, Flint's law and
/// the divides' shares are taken as measured. The others are found by growing (infer::match): the place of a junction
/// on its stream, the way to the divide, sidewalls and sides are changed by what grows later, so the dial is not what
/// is measured. The check is over 20 further seeds. Throws Error for what `grow` refuses, and for measures without C or
/// Flint's law.
DialsFit fit_dials(const grow::Basin&, const channel::GrowthMeasures&, std::uint64_t seed, const GrowthRules& = {});

}  // namespace thalweg::study
