// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/analyze.hpp"

#include <fmt/format.h>

#include "study/derivative_rasters.hpp"
#include "study/ingest.hpp"
#include "study/layer_styles.hpp"
#include "study/report_json.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/statistics.hpp"
#include "thalweg/io/polygonize.hpp"
#include "thalweg/io/table_file.hpp"
#include "thalweg/study/manifest.hpp"
#include "thalweg/study/output_folder.hpp"
#include "thalweg/study/tables.hpp"

namespace thalweg::study {
namespace {

Json heads_json(const ChannelHeads& heads) {
    return {{"given", heads.given}, {"outside", heads.outside}, {"merged", heads.merged}};
}

/// What the choice of channels rests on.
void add_evidence(Json& channels, const ChannelEvidence& evidence) {
    if (evidence.slope_area_m2) channels["threshold_slope_area_m2"] = *evidence.slope_area_m2;
    if (evidence.drop_tests.empty()) return;
    Json tests = Json::array();
    for (const channel::DropTest& test : evidence.drop_tests) {
        tests.push_back({{"threshold_m2", test.threshold},
                         {"first_order_streams", test.first_order},
                         {"higher_order_streams", test.higher_order},
                         {"first_order_drop_m", number(test.first_mean_m)},
                         {"higher_order_drop_m", number(test.higher_mean_m)},
                         {"t", number(test.t)}});
    }
    channels["drop_analysis"] = tests;
}

/// Where drops of channels that begin finer or coarser than the choice speak against it.
void note_crossing_drops(const ChannelEvidence& evidence, std::vector<std::string>& notes) {
    const auto chosen = channel::threshold_by_drops(evidence.drop_tests);
    const auto lasting = channel::lasting_threshold_by_drops(evidence.drop_tests);
    if (!chosen || lasting == chosen) return;
    notes.push_back(fmt::format(
        "channels: the mean drops of streams agree at a threshold of {:g} m2 but differ again above it{}: look "
        "at drop_analysis before trusting the choice",
        *chosen, lasting ? fmt::format(", and agree from {:g} m2 on", *lasting) : ""));
}

/// Channels of a few cells are hillslopes: on small rasters the default comes to that.
void note_small_channels(const RasterMeasurement& m, std::vector<std::string>& notes) {
    constexpr double enough = 10;
    const double cells = m.statistics.channels.threshold_area_m2 / m.area_m2 * m.valid_cells;
    if (!(cells < enough)) return;
    notes.push_back(
        fmt::format("channels: they begin where {:.2g} cells come together, so that hillslopes count as rivers; give a "
                    "larger --channel-area-m2 or a finer DEM",
                    std::max(cells, 1.0)));
}

Json outlet_json(const OutletReport& o) {
    return {{"x", o.given.x},     {"y", o.given.y},       {"snapped_x", o.snapped.x}, {"snapped_y", o.snapped.y},
            {"snap_m", o.snap_m}, {"moved_m", o.moved_m}, {"area_m2", o.area_m2},     {"complete", o.complete}};
}

/// ESRI's codes: 1 << slot, 0 where water leaves, 255 without data.
std::vector<double> esri_codes(const FlowDirections& directions, std::span<const double> elevation_m) {
    std::vector<double> codes(directions.size());
    for (std::size_t i = 0; i < codes.size(); ++i) {
        if (std::isnan(elevation_m[i]))
            codes[i] = 255;
        else
            codes[i] = directions[i] == no_flow ? 0 : 1 << directions[i];
    }
    return codes;
}

/// The areas, which nobody needs afterwards, with holes where there are no data.
std::vector<double> take_area(const Raster& dem, RasterMeasurement& m) {
    const bool divided = !m.terrain.divided_area_m2.empty();
    std::vector<double> area = std::move(divided ? m.terrain.divided_area_m2 : m.terrain.drainage_area_m2);
    for (std::size_t i = 0; i < area.size(); ++i) {
        if (std::isnan(dem.values[i])) area[i] = dem.values[i];
    }
    return area;
}

void write_rasters(const Raster& dem, RasterMeasurement& m, const std::filesystem::path& folder) {
    const auto write = [&](const char* name, std::span<const double> values, io::Layer layer) {
        io::write_raster(folder / name, dem.grid, dem.placement, values, layer);
    };
    write("filled.tif", m.terrain.elevation_m, {.nodata = {}, .description = "conditioned elevation (m)"});
    write("drainage_area.tif", take_area(dem, m), {.nodata = {}, .description = "drainage area (m2)"});
    write("flow_direction.tif", esri_codes(m.terrain.graph.receiver.directions(), dem.values),
          {.type = io::CellType::uint8,
           .nodata = 255,
           .description = "D8 direction (ESRI codes, 0 outlet)",
           .colors = direction_colors()});
    const auto as_numbers = [](const std::vector<Index>& values) {
        return std::vector<double>(values.begin(), values.end());
    };
    write("strahler.tif", as_numbers(m.statistics.strahler_of),
          {.type = io::CellType::uint8,
           .nodata = {},
           .description = "Strahler order (0: no channel)",
           .colors = order_colors()});
    write("shreve.tif", as_numbers(m.statistics.shreve_of),
          {.type = io::CellType::int32, .nodata = {}, .description = "Shreve magnitude (0: no channel)"});
}

void write_tables(const Raster& dem, const Statistics& s, const std::filesystem::path& folder) {
    const PositionOf position = positions(dem);
    auto outlines = io::cell_outlines(dem, s.basin_of, static_cast<Index>(s.basins.size()));
    io::write_geopackage(folder / "network.gpkg", network_layers(s, position, std::move(outlines)),
                         dem.placement.crs_wkt);
    write_statistics(s, position, folder);
    io::write_csv(folder / "slope_area_points.csv", slope_area_points_table(s.slope_area_points));
}

}  // namespace

NamedRaster read_dem(const std::filesystem::path& path, const io::ReadOptions& options, const Messages& messages) {
    messages.progress(fmt::format("reading {}", path.string()));
    io::ReadResult result = io::read_raster(path, options);
    const std::string sha256 = sha256_of(path);
    const std::optional<Origin> origin = origin_of(path, sha256, result.warnings);
    for (const std::string& warning : result.warnings) messages.warning(warning);
    return {.raster = std::move(result.raster),
            .file = path.filename().string(),
            .sha256 = sha256,
            .crs_name = result.crs_name,
            .warnings = std::move(result.warnings),
            .origin = origin,
            .vertical_unit_m = result.vertical_unit_m,
            .void_cells = result.void_cells};
}

std::string analyze(const NamedRaster& dem, const MeasureOptions& options, const std::filesystem::path& folder,
                    const Messages& messages) {
    messages.progress("routing flow and measuring");
    RasterMeasurement m = measure_raster(dem.raster, options);
    // A catchment that was cut out looks whole, whatever the data around it.
    const bool cut = dem.outlet && !dem.outlet->complete;
    for (BasinStatistics& basin : m.statistics.basins) basin.basin.complete &= !cut;
    std::vector<std::string> notes = dem.warnings;
    Json summary = terrain_json(input_of(dem, m), m.statistics, positions(dem.raster),
                                conditioning_json(m.conditioning, options.conditioning), notes);
    add_evidence(summary["channels"], m.channel_evidence);
    explain_null("channels.drop_analysis", summary["channels"].value("drop_analysis", Json::array()),
                 "t needs two streams of the first order and two of higher ones", notes);
    note_crossing_drops(m.channel_evidence, notes);
    note_small_channels(m, notes);
    if (options.heads) summary["channels"]["heads"] = heads_json(*options.heads);
    if (dem.outlet) summary["outlet"] = outlet_json(*dem.outlet);
    summary["measured_on"] = "raster";
    summary["routing"] = routing_name(options.routing);
    summary["slope_area"]["segment_drop_m"] = m.segment_drop_m;
    summary["slope_area"]["vertical_quantum_m"] = m.vertical_quantum_m;
    const HeightSurvey survey = survey_heights(dem.raster);
    const std::vector<std::string> hints = survey_hints(survey, dem.raster, m.vertical_quantum_m);
    summary["ingest"] = ingest_json(dem, m, survey, hints);
    explain_null("ingest", summary["ingest"], "there are too few cells of different height", notes);
    messages.report(ingest_line(dem, m));
    for (const std::string& hint : hints) messages.warning(hint);
    for (const std::string& note : notes) {
        if (note.starts_with("channels:")) messages.warning(note);
    }
    messages.progress("writing");
    if (options.derivatives) {
        summary["derivatives"] = write_derivatives(dem.raster, *options.derivatives, folder);
        explain_null("derivatives", summary["derivatives"],
                     "no cell has all eight neighbours, or the surface is level where they are", notes);
    }
    summary["notes"] = notes;
    write_rasters(dem.raster, m, folder);
    write_tables(dem.raster, m.statistics, folder);
    std::string text = text_of(summary);
    write_text(folder / "summary.json", text);
    return text;
}

}  // namespace thalweg::study
