// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/measure.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "study/basin_statistics.hpp"
#include "study/carved_rivers.hpp"
#include "study/channel_choice.hpp"
#include "study/conditioning.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/terrain/accumulate.hpp"
#include "thalweg/terrain/d_infinity.hpp"
#include "thalweg/terrain/flats.hpp"
#include "thalweg/terrain/lakes.hpp"
#include "thalweg/terrain/multiple_flow.hpp"
#include "thalweg/terrain/route.hpp"

namespace thalweg::study {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double total_area(const RoutedTerrain& terrain) {
    double area = 0;
    for (const Index node : terrain.graph.order) area += terrain.cell_area_m2[node];
    return area;
}

/// Basins of the statistics: from the threshold on or, where channels have heads, all that hold a channel.
std::vector<terrain::Basin> basins_in_use(const RoutedTerrain& terrain, const MeasureOptions& options,
                                          double threshold_m2, std::span<const std::uint8_t> channels) {
    auto basins = terrain::basins(terrain.graph, terrain.drainage_area_m2, terrain.complete,
                                  options.heads ? 0 : threshold_m2, options.edge_basins);
    if (options.heads) std::erase_if(basins, [&](const terrain::Basin& basin) { return !channels[basin.outlet]; });
    return basins;
}

std::size_t count(const std::vector<std::uint8_t>& flags) {
    return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), std::uint8_t{1}));
}

Index highest(const std::vector<Index>& numbers) {
    return numbers.empty() ? 0 : *std::max_element(numbers.begin(), numbers.end());
}

/// Nodes where rivers end; several may end in one.
Index count_outlets(const channel::StreamNetwork& network) {
    std::vector<Index> ends;
    for (Index link = 0; link < network.size(); ++link) {
        if (network.downstream[link] == none) ends.push_back(network.nodes_of(link).back());
    }
    std::sort(ends.begin(), ends.end());
    return static_cast<Index>(std::unique(ends.begin(), ends.end()) - ends.begin());
}

ChannelStatistics channel_statistics(const Statistics& s, double threshold_m2, double basin_area_m2) {
    const channel::StreamNetwork& network = s.network;
    ChannelStatistics c{};
    c.threshold_area_m2 = threshold_m2;
    c.basin_area_m2 = basin_area_m2;
    c.links = network.size();
    std::vector<std::uint8_t> has_upstream(network.size(), 0);
    for (const Index below : network.downstream) {
        if (below != none && !std::exchange(has_upstream[below], std::uint8_t{1})) ++c.junctions;
    }
    for (Index link = 0; link < network.size(); ++link) {
        c.sources += !has_upstream[link];
        c.total_length_m += network.length_m[link];
    }
    c.outlets = count_outlets(network);
    c.drainage_density_per_m =
        basin_area_m2 > 0 ? c.total_length_m / basin_area_m2 : std::numeric_limits<double>::quiet_NaN();
    return c;
}

/// From the channel threshold to a tenth of the largest basin; what is larger knows the basin's own size.
PowerLawFit exceedance_in_largest_basin(const RoutedTerrain& terrain, const Statistics& s, double threshold_m2,
                                        double largest_m2) {
    std::vector<std::uint8_t> inside(s.basin_of.size());
    for (std::size_t node = 0; node < inside.size(); ++node) inside[node] = s.basin_of[node] == 0;
    return channel::area_exceedance(terrain.drainage_area_m2, inside, threshold_m2, 0.1 * largest_m2);
}

/// Drainage area where channels begin: least, median, largest.
std::array<double, 3> source_areas(const RoutedTerrain& terrain, std::span<const std::uint8_t> channels) {
    std::vector<double> areas;
    for (const Index head : channel::channel_heads(terrain.graph, channels)) {
        areas.push_back(terrain.drainage_area_m2[head]);
    }
    if (areas.empty()) return {nan, nan, nan};
    const auto [least, most] = std::ranges::minmax(areas);
    return {least, quantile(std::move(areas), 0.5), most};
}

NetworkStatistics network_statistics(const RoutedTerrain& terrain, const Statistics& s, double threshold_m2,
                                     double largest_m2) {
    const auto longest = channel::longest_upstream_lengths(terrain.graph);
    NetworkStatistics n{.tokunaga = channel::tokunaga(s.network),
                        .hack = channel::hack_law(s.network, terrain.drainage_area_m2, longest),
                        .links = channel::link_lengths(s.network),
                        .flint = channel::flint_law(s.network),
                        .junction_reach_m = channel::junction_reach(s.network),
                        .junctions = {},
                        .cis_trans = {},
                        .main_streams = channel::main_streams(s.network),
                        .pfafstetter = channel::pfafstetter_codes(s.network),
                        .width = channel::width_function(s.network),
                        .area_exceedance = exceedance_in_largest_basin(terrain, s, threshold_m2, largest_m2)};
    const channel::OffsetOf unknown = [](Index, Index) {
        return Point{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
    };
    const channel::OffsetOf& offset = terrain.offset_m ? terrain.offset_m : unknown;
    n.junctions = channel::junction_angles(s.network, offset, n.junction_reach_m, n.flint.exponent.value);
    if (terrain.offset_m) n.cis_trans = channel::cis_trans_links(s.network, offset, n.junction_reach_m);
    return n;
}

double share(std::size_t part, std::size_t whole) {
    return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : nan;
}

/// Steps down in the basins that are as the ground has them, and how many are not.
struct NaturalSteps {
    std::vector<std::uint8_t> node;  ///< 1 where the step from it is natural
    std::size_t others = 0;
};

NaturalSteps natural_steps(const RoutedTerrain& terrain, std::span<const double> ground_m,
                           std::span<const Index> basin_of) {
    NaturalSteps natural{.node = std::vector<std::uint8_t>(basin_of.size())};
    const auto unchanged = [&](Index node) { return terrain.elevation_m[node] == ground_m[node]; };
    for (Index node = 0; node < natural.node.size(); ++node) {
        const Index receiver = terrain.graph.receiver[node];
        if (basin_of[node] == none || receiver == none) continue;
        natural.node[node] = unchanged(node) && unchanged(receiver);
        natural.others += natural.node[node] == 0;
    }
    return natural;
}

SlopeAreaByNodes slope_area_by_nodes(const RoutedTerrain& terrain, std::span<const double> ground_m,
                                     std::span<const Index> basin_of, double channels_from_m2) {
    const auto& area = terrain.divided_area_m2.empty() ? terrain.drainage_area_m2 : terrain.divided_area_m2;
    const NaturalSteps natural = natural_steps(terrain, ground_m, basin_of);
    channel::NodeSlopeBins nodes = channel::node_slope_bins(terrain.graph, area, terrain.elevation_m, natural.node);
    std::vector<channel::SlopeAreaBin> of_channels;
    std::ranges::copy_if(nodes.bins, std::back_inserter(of_channels),
                         [&](const auto& bin) { return bin.area_m2 >= channels_from_m2; });
    SlopeAreaByNodes s{.law = channel::fit_slope_area(std::move(of_channels)),
                       .fitted_from_m2 = channels_from_m2,
                       .looked_at = nodes.looked_at,
                       .left_out = natural.others,
                       .level_share = share(nodes.level, nodes.looked_at),
                       .turnover = channel::hillslope_turnover(nodes.bins)};
    s.law.bins = std::move(nodes.bins);
    return s;
}

SlopeAreaByLinks slope_area_by_links(const RoutedTerrain& terrain, const channel::StreamNetwork& network) {
    const auto points = channel::link_slopes(network, terrain.graph, terrain.drainage_area_m2);
    return {.law = channel::fit_slope_area(channel::slope_area_bins(points)),
            .level_share = share(network.size() - points.size(), network.size())};
}

/// Relief of the largest basin of the statistics, or of everything where there is none: what 2.5 % are taken of.
double reference_relief(const RasterMeasurement& m, std::span<const double> ground_m, double threshold_m2,
                        const MeasureOptions& options) {
    std::vector<std::uint8_t> channels;
    if (options.heads) channels = channel_nodes(m.terrain, options, threshold_m2);
    const auto basins = basins_in_use(m.terrain, options, threshold_m2, channels);
    const auto labels = terrain::basin_labels(m.terrain.graph, std::span(basins).first(basins.empty() ? 0 : 1));
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
    for (const Index node : m.terrain.graph.order) {
        if (!basins.empty() && labels[node] != 0) continue;
        lowest = std::min(lowest, ground_m[node]);
        highest = std::max(highest, ground_m[node]);
    }
    return highest - lowest;
}

void report_changes(const Raster& raster, const std::vector<double>& surface, ConditioningReport& report) {
    for (Index node = 0; node < raster.grid.size(); ++node) {
        const double change = surface[node] - raster.values[node];
        if (std::isnan(change) || change == 0) continue;
        ++report.cells_changed;
        report.volume_m3 += std::abs(change) * raster.grid.area(node);
        (change > 0 ? report.filled_m3 : report.cut_m3) += std::abs(change) * raster.grid.area(node);
    }
}

std::vector<channel::SlopeAreaPoint> segments(const RoutedTerrain& carved, const MeasureOptions& options,
                                              std::span<const double> ground_m, double relief, RasterMeasurement& m) {
    m.vertical_quantum_m = channel::vertical_quantum(ground_m);
    m.segment_drop_m = std::max(0.025 * relief, 3 * m.vertical_quantum_m);
    if (!(m.segment_drop_m > 0)) return {};
    const auto channels = channels_in_use(carved, options, *options.channel_area_m2);
    return channel::fixed_drop_segments(carved.graph, carved.drainage_area_m2, carved.elevation_m, channels,
                                        {.drop_m = m.segment_drop_m, .smallest_drop_m = 3 * m.vertical_quantum_m});
}

double relief_of(const std::vector<double>& elevation_m) {
    if (elevation_m.empty()) return 0;
    const auto [lowest, highest] = std::ranges::minmax_element(elevation_m);
    return *highest - *lowest;
}

/// Drainage area by the routing that was asked for, on the surface before it was carved; empty for D8.
std::vector<double> divided_area(const Grid& grid, std::span<const double> surface, const RoutedTerrain& terrain,
                                 Routing routing) {
    if (routing == Routing::d8) return {};
    const FlowDirections& single = terrain.graph.receiver.directions();
    const terrain::MultipleFlow flow = routing == Routing::dinf ? terrain::d_infinity(grid, surface, single)
                                                                : terrain::multiple_flow(grid, surface, single);
    return terrain::accumulate(flow, terrain::cell_areas(grid));
}

/// Orders of every node: last, since the other statistics take as much memory again while they work.
void add_orders(const terrain::FlowGraph& graph, std::span<const std::uint8_t> channels, Statistics& s) {
    s.strahler_of = channel::strahler_orders(graph, channels);
    s.shreve_of = channel::shreve_magnitudes(graph, channels);
    s.channels.max_strahler = highest(s.strahler_of);
    s.channels.max_shreve = highest(s.shreve_of);
    for (BasinStatistics& basin : s.basins) {
        basin.max_strahler = s.strahler_of[basin.basin.outlet];
        basin.max_shreve = s.shreve_of[basin.basin.outlet];
    }
}

}  // namespace

double data_area(const Raster& raster) {
    double area = 0;
    for (Index node = 0; node < raster.grid.size(); ++node) {
        if (!std::isnan(raster.values[node])) area += raster.grid.area(node);
    }
    return area;
}

double default_channel_area(double area_m2) { return rounded_to_1_2_5(1e-3 * area_m2); }

double rounded_to_1_2_5(double target) {
    const double decade = std::pow(10.0, std::floor(std::log10(target)));
    double best = decade;
    for (const double candidate : {2 * decade, 5 * decade, 10 * decade}) {
        if (std::abs(std::log(candidate / target)) < std::abs(std::log(best / target))) best = candidate;
    }
    return best;
}

double catchment_channel_area(const Raster& raster) {
    constexpr double smallest_cells = 50;
    const double area = data_area(raster);
    const auto cells =
        std::count_if(raster.values.begin(), raster.values.end(), [](double z) { return !std::isnan(z); });
    return default_channel_area(std::max(area, 1000 * smallest_cells * area / static_cast<double>(cells)));
}

Statistics measure(const RoutedTerrain& terrain, std::span<const double> ground_m, const MeasureOptions& options,
                   std::vector<channel::SlopeAreaPoint> slopes, ChiStatistics chi) {
    const double threshold = channel_threshold(terrain, options);

    Statistics s;
    s.hypsometry = terrain::hypsometry(ground_m, terrain.cell_area_m2);
    const auto all_channels = channel_nodes(terrain, options, threshold);
    const auto channels = channels_in_use(terrain, options, threshold);
    s.network = channel::stream_network(terrain.graph, channels, terrain.drainage_area_m2, terrain.elevation_m);

    const auto basins = basins_in_use(terrain, options, threshold, all_channels);
    s.basin_of = terrain::basin_labels(terrain.graph, basins);
    const double basin_area =
        std::accumulate(basins.begin(), basins.end(), 0.0, [](double sum, const auto& b) { return sum + b.area_m2; });

    s.channels = channel_statistics(s, options.heads ? nan : threshold, basin_area);
    s.channels.rule = options.channels;
    s.channels.edge_basins = options.edge_basins;
    s.channels.source_area_m2 = source_areas(terrain, channels);
    s.channels.nodes = static_cast<Index>(count(channels));
    const std::size_t everywhere = count(all_channels);
    s.channels.share_used = everywhere > 0 ? static_cast<double>(s.channels.nodes) / static_cast<double>(everywhere)
                                           : std::numeric_limits<double>::quiet_NaN();
    s.strahler = channel::strahler_statistics(s.network);
    s.horton = channel::horton_ratios(s.strahler);
    const double channels_from = options.heads ? s.channels.source_area_m2[0] : threshold;
    s.network_laws = network_statistics(terrain, s, channels_from, basins.empty() ? 0 : basins.front().area_m2);
    s.slope_area_nodes = slope_area_by_nodes(terrain, ground_m, s.basin_of, channels_from);
    s.slope_area_links = slope_area_by_links(terrain, s.network);
    s.slope_area = channel::fit_slope_area(channel::slope_area_bins(slopes));
    s.slope_area_points = std::move(slopes);
    s.chi = std::move(chi);
    s.basins = basin_statistics(terrain, ground_m, basins, s);
    add_orders(terrain.graph, channels, s);
    return s;
}

double channel_threshold(const RoutedTerrain& terrain, const MeasureOptions& options) {
    return options.channel_area_m2.value_or(default_channel_area(total_area(terrain)));
}

ChiStatistics measure_chi(const RoutedTerrain& carved, const MeasureOptions& options, double threshold_m2,
                          double drop_m) {
    const auto channels = channels_in_use(carved, options, threshold_m2);
    ChiStatistics c{.theta = options.theta,
                    .reference_area_m2 = 1e6,
                    .profile = {},
                    .chi_m = {},
                    .ksn = {},
                    .ksn_median = 0,
                    .concavity = {},
                    .knickpoint_prominence_m = 0,
                    .knickpoints = {}};
    c.profile = channel::channel_profile(carved.graph, channels, carved.drainage_area_m2, carved.elevation_m);
    c.chi_m = channel::chi(c.profile, c.theta, c.reference_area_m2);
    c.ksn = channel::steepness(c.profile, c.chi_m, c.theta, c.reference_area_m2, drop_m);
    std::vector<double> known;
    std::ranges::copy_if(c.ksn, std::back_inserter(known), [](double value) { return !std::isnan(value); });
    c.ksn_median = quantile(std::move(known), 0.5);
    c.concavity = channel::concavity(c.profile);
    c.knickpoint_prominence_m =
        options.knickpoint_prominence_m.value_or(std::max(drop_m, 0.05 * relief_of(c.profile.elevation_m)));
    if (c.knickpoint_prominence_m > 0) {
        c.knickpoints =
            channel::knickpoints(c.profile, c.chi_m, c.theta, c.reference_area_m2, c.knickpoint_prominence_m);
    }
    return c;
}

RasterMeasurement measure_raster(const Raster& raster, const MeasureOptions& options,
                                 const std::function<std::future<void>(const RoutedTerrain&)>& when_routed) {
    RasterMeasurement m;
    const auto boundary = boundary_of(raster, options, m.conditioning.endorheic_basins);
    m.terrain.cell_area_m2 = CellAreas(raster.grid);
    CarvedRivers rivers = carved_rivers(raster, boundary, options, m.conditioning);

    Conditioned c = conditioned(raster, boundary, options, std::move(rivers.filled_m));
    m.conditioning.flat_cells = c.flat_cells;
    std::vector<double> surface = std::move(c.surface_m);
    terrain::GraphAndArea routed = terrain::graph_and_area(raster.grid, surface, std::move(c.directions));
    m.terrain.graph = std::move(routed.graph);
    m.terrain.drainage_area_m2 = std::move(routed.drainage_area_m2);
    m.terrain.divided_area_m2 = divided_area(raster.grid, surface, m.terrain, options.routing);
    m.terrain.complete = terrain::complete_catchments(raster.grid, m.terrain.graph, boundary);
    if (options.conditioning == Conditioning::carve) surface = terrain::carve(m.terrain.graph, surface);
    report_changes(raster, surface, m.conditioning);
    m.terrain.offset_m = channel::offsets(raster.grid);
    m.terrain.elevation_m = std::move(surface);

    std::future<void> meanwhile;  // if measuring fails it is waited for before the arrays go
    if (when_routed) meanwhile = when_routed(m.terrain);
    m.valid_cells = static_cast<Index>(m.terrain.graph.order.size());
    m.area_m2 = total_area(m.terrain);
    MeasureOptions resolved = with_channels_chosen(m.terrain, options, m.channel_evidence);
    if (!resolved.channel_area_m2) resolved.channel_area_m2 = default_channel_area(m.area_m2);
    const double threshold = *resolved.channel_area_m2;
    const double relief = reference_relief(m, raster.values, threshold, resolved);
    const MeasureOptions along = on_rivers(rivers, resolved);
    auto slopes = segments(rivers.terrain, along, raster.values, relief, m);
    ChiStatistics chi = measure_chi(rivers.terrain, along, threshold, m.segment_drop_m);
    name_raster_nodes(rivers, slopes, chi);
    m.statistics = measure(m.terrain, raster.values, resolved, std::move(slopes), std::move(chi));
    const auto basins = static_cast<Index>(m.statistics.basins.size());
    add_perimeters(terrain::basin_perimeters(raster.grid, m.statistics.basin_of, basins), m.statistics);
    if (meanwhile.valid()) meanwhile.get();
    return m;
}

}  // namespace thalweg::study
