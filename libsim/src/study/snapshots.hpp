// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "thalweg/core/raster.hpp"
#include "thalweg/evolve/landscape.hpp"

namespace thalweg::study {

/// Keeps the landscape of some steps on disk until the run is over: only then is it known from where to where the
/// colours must reach.
class Frames {
  public:
    /// Frames lie in `folder`; those of steps after `last_step`, which a stopped run left, are taken away.
    Frames(std::filesystem::path folder, Index last_step);

    void keep(Index step, const evolve::Landscape&);

    /// Pictures step-000100.png and elevation.nc in `folder`, from the frames and the finished landscape. `raster_of`
    /// makes the heightfield of a landscape.
    void write(Index last_step, const evolve::Landscape& finished,
               const std::function<Raster(const std::vector<double>&)>& raster_of,
               const std::filesystem::path& folder) const;

  private:
    std::filesystem::path folder_;
};

/// Red, green, blue and opacity of every cell: the height's colour between `lowest_m` and `highest_m`, shaded; clear at
/// no data.
std::vector<std::uint8_t> picture_of(const Raster& elevation_m, double lowest_m, double highest_m);

}  // namespace thalweg::study
