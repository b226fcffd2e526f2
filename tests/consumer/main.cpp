// SPDX-License-Identifier: GPL-3.0-or-later
// Takes something from each installed library that hides a third party, so that a missing link dependency shows.
#include <cstdlib>
#include <vector>

#include "thalweg/core/grid.hpp"
#include "thalweg/infer/versions.hpp"
#include "thalweg/io/versions.hpp"
#include "thalweg/mesh/versions.hpp"
#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/route.hpp"

int main() {
    // A pit of depth 3 in a plain at 5 fills to the plain.
    const thalweg::Grid grid = thalweg::plane_grid(3, 3, 10, 10);
    const std::vector<double> pit{5, 5, 5, 5, 2, 5, 5, 5, 5};
    const auto filled = thalweg::terrain::fill(grid, pit, thalweg::terrain::data_edge(grid, pit));
    const bool named = !thalweg::io::library_versions().empty() && !thalweg::mesh::library_versions().empty() &&
                       !thalweg::infer::library_versions().empty();
    return filled[4] == 5 && named ? EXIT_SUCCESS : EXIT_FAILURE;
}
