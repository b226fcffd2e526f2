// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "thalweg/core/raster.hpp"

namespace thalweg::study {

/// How heights were made, as far as they show it. Shares are NaN where there is nothing to take them of.
///
/// Striping: with d the difference of a height from the mean of its two neighbours across the rows, M its mean over a
/// row and h that of M from the mean of the two beside it, the share of d's square sum that is a row's own,
/// 12/35·Σ cells·h² / Σ d², the tenth of the rows with most left out; 12/35 makes it 1, but for that tenth, where rows
/// differ by independent offsets and by nothing else. Curvature that goes on over several rows (a cone, a bowl, a
/// ridge) has an M that its neighbours share, and the edge of a block or a seam stands in a few rows only: neither
/// counts. Where cells go their own ways over a few cells' distance, as terrain does, this is one or two over the
/// number of columns (0.3 to 2 on sixteen real DEMs); stripes, as of old photogrammetric profiles, raise it. Columns
/// likewise. Rows and columns with under half their cells do not count; NaN where there is no roughness beyond the
/// rounding of heights in single precision (a plane).
struct HeightSurvey {
    double most_frequent_m;      ///< value, of a sample of the cells; the lowest of several
    double most_frequent_share;  ///< of the cells with data that have it
    double zero_share;           ///< of the cells with data at exactly 0
    double level_share;          ///< of neighbours, in a sample of the cells, those of one height, that value's apart
    double median_step_m;        ///< between neighbours of different height, in the same sample
    double largest_m;            ///< magnitude of a height
    double row_roughness_m, column_roughness_m;  ///< root mean square of d, across the rows and across the columns
    double row_striping, column_striping;
    double repeated_rows, repeated_columns;  ///< share that equals the one beside, pairs of constant ones apart
};

/// Surveys all cells; where a sample is said, some 65 thousand of them, evenly spaced from the edges inwards. A raster
/// turned or mirrored has the same survey, rows and columns changing places. Linear, one thread.
HeightSurvey survey_heights(const Raster&);

/// What of it the user should know, one sentence each; `vertical_quantum_m` as `channel::vertical_quantum` finds it.
std::vector<std::string> survey_hints(const HeightSurvey&, const Raster&, double vertical_quantum_m);

}  // namespace thalweg::study
