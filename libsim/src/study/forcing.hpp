// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "thalweg/evolve/history.hpp"
#include "thalweg/study/domain.hpp"
#include "thalweg/study/parameters.hpp"

namespace thalweg::study {

/// What drives a simulation and changes in time.
struct Forcing {
    evolve::History uplift_factor;          ///< relative to the uplift of the domain
    std::optional<double> uplift_m_per_yr;  ///< largest rate of an uplift history that is given as rates
    evolve::History base_level_m;
};

/// Reads the tables that an experiment names. Throws Error, with the line, where a table is no history: a missing
/// column, a field that is no number, times that go back, a third row of one time, an uplift below zero. Throws Error
/// where the solver knows no time.
Forcing read_forcing(const Experiment&);

/// The experiment with the largest rate of the uplift history as its uplift, where there is one.
Experiment with_forced_rate(Experiment, const Forcing&);

/// Hands the histories to the domain's setting and puts the start onto the first base level: a surface of noise as a
/// whole, of any other the outlets alone.
void drive_in_time(Domain&, const Experiment&, const Forcing&);

}  // namespace thalweg::study
