// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "thalweg/core/raster.hpp"

namespace thalweg::study {

/// How heights were made, as far as they show it. Shares are NaN where there is nothing to take them of.
///
/// Striping: with d the difference of a height from the mean of its two neighbours across the rows, the share of d's
/// mean square that whole rows have in common, Σ cells·(mean d of the row)² / Σ d². Where cells go their own ways over
/// a few cells' distance, as terrain does, this is a few over the number of columns (3 to 12 on sixteen real DEMs);
/// stripes, as of old photogrammetric profiles, raise it. Columns likewise. Rows and columns with under half their
/// cells do not count.
struct HeightSurvey {
    double most_frequent_m;      ///< value, of a sample of the cells
    double most_frequent_share;  ///< of the cells with data that have it
    double zero_share;           ///< of the cells with data at exactly 0
    double level_share;          ///< of neighbours east–west those of one height, that value's apart
    double median_step_m;        ///< between neighbours of different height
    double row_striping, column_striping;
    double repeated_rows, repeated_columns;  ///< share that equals the one before, constant ones apart
};

/// Surveys all cells, or every so many rows of a raster of more than four million. Linear, one thread.
HeightSurvey survey_heights(const Raster&);

/// What of it the user should know, one sentence each; `vertical_quantum_m` as `channel::vertical_quantum` finds it.
std::vector<std::string> survey_hints(const HeightSurvey&, const Raster&, double vertical_quantum_m);

}  // namespace thalweg::study
