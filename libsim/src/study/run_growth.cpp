// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/run_growth.hpp"

#include <algorithm>
#include <cmath>

#include "study/noting.hpp"
#include "thalweg/study/compare.hpp"
#include "thalweg/study/fit_growth.hpp"
#include "thalweg/study/grow.hpp"

namespace thalweg::study {
namespace {

namespace fs = std::filesystem;

fs::path step_folder(const fs::path& study, const char* step) {
    fs::create_directory(study / step);
    return study / step;
}

/// Cells along the longer side of the basin's outline, as large as the DEM's.
Index resolution_like(const Raster& raster, const grow::Basin& basin) {
    const auto cells = std::ranges::count_if(raster.values, [](double z) { return !std::isnan(z); });
    const double cell_m = std::sqrt(data_area(raster) / static_cast<double>(cells));
    const auto [west, east] = std::ranges::minmax_element(basin.outline, {}, &Point::x);
    const auto [south, north] = std::ranges::minmax_element(basin.outline, {}, &Point::y);
    return static_cast<Index>(std::ceil(std::max(east->x - west->x, north->y - south->y) / cell_m));
}

/// What is not a dial is the study's: tensions, widths, roughness, formats.
Experiment grown_experiment(const Experiment& study, const GrowthFit& fit, const Catchment& catchment) {
    const Experiment found = growth_experiment(fit, "../growth_fit/basin.gpkg");
    Experiment e = study;
    e.basin = found.basin;
    e.growth.channel_maintenance_m = found.growth.channel_maintenance_m;
    e.growth.sidewall_reach_m = found.growth.sidewall_reach_m;
    e.growth.dials = found.growth.dials;
    if (!e.output.resolution) e.output.resolution = resolution_like(catchment.raster, fit.site.basin);
    return e;
}

}  // namespace

void run_growth_steps(const Experiment& e, const Catchment& catchment, const MeasureOptions& options,
                      const fs::path& study, const Messages& messages) {
    messages.progress("growing networks to find the dials");
    const grow::Dials& asked = e.growth.dials;
    const GrowthFit fit =
        fit_growth(catchment, options, e.seed, {.upstream_link = asked.upstream_link, .stop = asked.stop});
    for (const std::string& warning : fit.site.warnings) messages.warning(warning);
    write_growth_fit(fit, "raster", step_folder(study, "growth_fit"));
    grow(grown_experiment(e, fit, catchment), catchment, step_folder(study, "grow"), messages);

    const NamedRaster grown = read_dem(study / "grow/elevation.tif", {}, {});
    MeasureOptions measuring = options;
    const Point& outlet = fit.site.basin.outlet;
    measuring.catchment_outlet =
        nearest_cell_with_data(grown.raster, {outlet.x / fit.site.unit_m, outlet.y / fit.site.unit_m});
    analyze(grown, measuring, step_folder(study, "grown"), about("grown", messages));
    compare(study / "basin", study / "grown",
            {.read = {}, .measure = measuring, .realisations = e.study.realisations, .model_of_b = study / "grow"},
            step_folder(study, "compare_grown"), messages);
}

}  // namespace thalweg::study
