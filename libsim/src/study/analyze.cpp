// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/analyze.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <optional>

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
    Json json{{"given", heads.given}, {"outside", heads.outside}, {"merged", heads.merged}};
    if (!heads.snap_m) return json;
    json["snap_m"] = *heads.snap_m;
    json["moved"] = heads.moved;
    json["mean_moved_m"] = heads.mean_moved_m;
    json["largest_moved_m"] = heads.largest_moved_m;
    return json;
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

/// The first test of a larger threshold that says that drops differ.
std::optional<channel::DropTest> differing_above(const std::vector<channel::DropTest>& tests, double threshold) {
    const auto found = std::ranges::find_if(
        tests, [&](const channel::DropTest& test) { return test.threshold > threshold && std::abs(test.t) >= 2; });
    if (found == tests.end()) return std::nullopt;
    return *found;
}

/// What is taken instead of the first threshold at which drops agree, and what speaks against that, too.
std::string lasting_words(const std::vector<channel::DropTest>& tests, double lasting) {
    const auto against = differing_above(tests, lasting);
    return fmt::format("; taken is {:g} m2, from which on they agree{}", lasting,
                       against ? fmt::format(" but at {:g} m2 (t = {:.2f} of {} and {} streams)", against->threshold,
                                             against->t, against->first_order, against->higher_order)
                               : "");
}

/// Where drops of channels that begin finer or coarser than the choice speak against it.
void note_crossing_drops(const ChannelEvidence& evidence, std::vector<std::string>& notes) {
    const auto first = channel::first_threshold_by_drops(evidence.drop_tests);
    const auto lasting = channel::lasting_threshold_by_drops(evidence.drop_tests);
    if (!first || first == lasting || !differing_above(evidence.drop_tests, *first)) return;
    notes.push_back(fmt::format(
        "channels: the mean drops of streams agree at a threshold of {:g} m2 but differ again above it{}: look "
        "at drop_analysis before trusting the choice",
        *first, lasting ? lasting_words(evidence.drop_tests, *lasting) : ""));
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

/// Writes one number per cell, `value(cell)`.
template <class Value>
void write_cells(const Raster& dem, const std::filesystem::path& file, const io::Layer& layer, Value value) {
    const io::RowSource rows = [&](Index first_row, std::span<double> cells) {
        const std::size_t first = std::size_t{first_row} * dem.grid.cols;
        for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = value(first + i);
    };
    io::write_raster(file, dem.grid, dem.placement, rows, layer);
}

/// ESRI's codes: 1 << slot, 0 where water leaves, 255 without data.
int esri_code(Slot slot) { return slot == no_flow ? 0 : 1 << slot; }

/// What is known once water is routed, of arrays that stay where they are.
struct RoutedLayers {
    std::span<const double> elevation_m, drainage_area_m2;
    terrain::Receivers receiver;
};

RoutedLayers routed_layers(const RoutedTerrain& terrain) {
    const bool divided = !terrain.divided_area_m2.empty();
    return {terrain.elevation_m, divided ? terrain.divided_area_m2 : terrain.drainage_area_m2, terrain.graph.receiver};
}

void write_routed(const Raster& dem, const RoutedLayers& m, const std::filesystem::path& folder) {
    const auto& z = dem.values;
    io::write_raster(folder / "filled.tif", dem.grid, dem.placement, m.elevation_m,
                     {.nodata = {}, .description = "conditioned elevation (m)"});
    write_cells(dem, folder / "drainage_area.tif", {.nodata = {}, .description = "drainage area (m2)"},
                [&](std::size_t cell) { return std::isnan(z[cell]) ? z[cell] : m.drainage_area_m2[cell]; });
    const FlowDirections& directions = m.receiver.directions();
    write_cells(dem, folder / "flow_direction.tif",
                {.type = io::CellType::uint8,
                 .nodata = 255,
                 .description = "D8 direction (ESRI codes, 0 outlet)",
                 .colors = direction_colors()},
                [&](std::size_t cell) { return std::isnan(z[cell]) ? 255 : esri_code(directions[cell]); });
}

void write_orders(const Raster& dem, const Statistics& s, const std::filesystem::path& folder) {
    write_cells(dem, folder / "strahler.tif",
                {.type = io::CellType::uint8,
                 .nodata = {},
                 .description = "Strahler order (0: no channel)",
                 .colors = order_colors()},
                [&](std::size_t cell) { return s.strahler_of[cell]; });
    write_cells(dem, folder / "shreve.tif",
                {.type = io::CellType::int32, .nodata = {}, .description = "Shreve magnitude (0: no channel)"},
                [&](std::size_t cell) { return s.shreve_of[cell]; });
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
    std::future<HeightSurvey> surveyed = std::async(std::launch::async, [&] { return survey_heights(dem.raster); });
    RasterMeasurement m = measure_raster(dem.raster, options, [&](const RoutedTerrain& terrain) {
        return std::async(std::launch::async, [&dem, &folder, layers = routed_layers(terrain)] {
            write_routed(dem.raster, layers, folder);
        });
    });
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
    const HeightSurvey survey = surveyed.get();
    const std::vector<std::string> hints = survey_hints(survey, dem.raster, m.vertical_quantum_m);
    summary["ingest"] = ingest_json(dem, m, survey, hints);
    explain_null("ingest", summary["ingest"],
                 "there are too few cells of different height, or none whose roughness is more than rounding", notes);
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
    std::future<void> orders = std::async(std::launch::async, [&] { write_orders(dem.raster, m.statistics, folder); });
    write_tables(dem.raster, m.statistics, folder);
    orders.get();
    std::string text = text_of(summary);
    write_text(folder / "summary.json", text);
    return text;
}

}  // namespace thalweg::study
