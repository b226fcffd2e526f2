// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "thalweg/evolve/model.hpp"
#include "thalweg/study/parameters.hpp"

namespace thalweg::study {

/// The processes that an experiment asks for. Throws Error where one of its numbers is missing.
evolve::Model model_of(const Experiment&);

}  // namespace thalweg::study
