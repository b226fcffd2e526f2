// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "thalweg/study/domain.hpp"

namespace thalweg::study {

/// The cells labelled 0 with a margin of one cell where the raster has one, NaN for the others; `outlet` is one of
/// them.
Catchment cut_out(const Raster&, std::span<const Index> label, Index outlet);

}  // namespace thalweg::study
