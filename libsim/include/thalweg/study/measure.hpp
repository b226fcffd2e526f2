// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <future>
#include <optional>
#include <span>
#include <vector>

#include "thalweg/channel/basin_shape.hpp"
#include "thalweg/channel/concavity.hpp"
#include "thalweg/channel/drop_analysis.hpp"
#include "thalweg/channel/extent.hpp"
#include "thalweg/channel/horton.hpp"
#include "thalweg/channel/knickpoints.hpp"
#include "thalweg/channel/laws.hpp"
#include "thalweg/channel/links.hpp"
#include "thalweg/channel/main_streams.hpp"
#include "thalweg/channel/network.hpp"
#include "thalweg/channel/profile.hpp"
#include "thalweg/channel/slope_area.hpp"
#include "thalweg/channel/tokunaga.hpp"
#include "thalweg/core/cell_areas.hpp"
#include "thalweg/core/raster.hpp"
#include "thalweg/terrain/basins.hpp"
#include "thalweg/terrain/breach.hpp"
#include "thalweg/terrain/hypsometry.hpp"

namespace thalweg::study {

/// What becomes of pits before routing.
enum class Conditioning {
    fill,   ///< filled to their pass, flats drained
    carve,  ///< cut through at their pass
    none,   ///< they keep their water
    breach  ///< led out where the least is cut away, within limits; the rest filled
};

/// How water is followed for the drainage area. The network's cells are joined by D8 always.
enum class Routing {
    d8,    ///< all to the neighbour of steepest descent
    dinf,  ///< D∞ (Tarboton 1997): to the two that enclose the steepest facet's direction
    mfd    ///< to all lower neighbours, by slope to the power of 1.1 (Freeman 1991)
};

/// What decides where channels begin.
enum class ChannelRule {
    area,        ///< the drainage area
    heads,       ///< points given by the user
    slope_area,  ///< drainage area times slope squared (Montgomery & Dietrich 1992)
    drop         ///< the least drainage area with constant stream drops (Broscoe 1959; Tarboton et al. 1991)
};

/// Cells where channels begin, as somebody mapped them.
struct ChannelHeads {
    std::vector<Index> cells;        ///< ascending, each once, all with data
    Index given = 0;                 ///< points, of which some may lie
    Index outside = 0;               ///< off the data: they say nothing about this terrain and are left out
    Index merged = 0;                ///< in a cell that another has
    std::optional<double> snap_m{};  ///< how far they might be moved to rivers; none: not at all
    Index moved = 0;                 ///< to another cell
    double mean_moved_m = 0, largest_moved_m = 0;  ///< over all on the data
};

/// Closed depressions that keep their water, each draining to its lowest cell: those that are as deep and as large as
/// is asked for, and those that hold one of the cells. Nothing asked for: none.
struct Endorheic {
    std::optional<double> depth_m{}, area_m2{};  ///< at the deepest; under water
    std::vector<Index> cells{};
    bool wanted() const { return depth_m || area_m2 || !cells.empty(); }
};

/// Rasters of the surface's shape, written beside the others.
struct DerivativeOptions {
    std::optional<double> relief_radius_m{};  ///< default: ten cells, rounded to 1-2-5
};

struct MeasureOptions {
    Conditioning conditioning = Conditioning::fill;
    terrain::BreachLimits breach_limits{};
    Endorheic endorheic{};
    Routing routing = Routing::d8;
    std::optional<double> channel_area_m2;  ///< default: 0.1 % of the area, rounded to 1-2-5
    ChannelRule channels = ChannelRule::area;
    std::optional<ChannelHeads> heads{};    ///< for ChannelRule::heads
    std::optional<double> slope_area_m2{};  ///< for ChannelRule::slope_area; default: by constant drops
    terrain::EdgeBasins edge_basins = terrain::EdgeBasins::drop;
    std::optional<Index> catchment_outlet{};          ///< the raster is one catchment that leaves here: its
                                                      ///< rim is a divide, not a cut
    double theta = 0.45;                              ///< concavity for chi and ksn
    std::optional<double> knickpoint_prominence_m{};  ///< default: 5 % of the rivers' relief, at least a segment's drop
    std::optional<DerivativeOptions> derivatives{};   ///< none: not written
};

/// A terrain once it is routed: a DEM, a simulated mesh and a grown network look the same from here on.
struct RoutedTerrain {
    terrain::FlowGraph graph;
    std::vector<double> elevation_m;  ///< on which the flow falls (filled or carved); NaN: no data
    CellAreas cell_area_m2;
    std::vector<double> drainage_area_m2;   ///< of the graph's trees
    std::vector<double> divided_area_m2{};  ///< where flow divides, along that flow; else empty
    std::vector<std::uint8_t> complete;     ///< 1 where the whole upslope area is known
    channel::OffsetOf offset_m;             ///< from node to node; empty: angles are not known
};

/// Everything that is known of one basin. Measures of channels are of those in the statistics.
struct BasinStatistics {
    terrain::Basin basin;
    double relief_m = 0;
    terrain::Hypsometry hypsometry = {};
    double length_m = 0;     ///< straight, from the outlet to the farthest node
    double perimeter_m = 0;  ///< NaN where the topology does not tell it (a mesh)
    channel::BasinShape shape = {};
    double asymmetry_percent = 0;  ///< share of the area on the trunk's right; NaN: no trunk, or angles not known
    double channel_length_m = 0;
    double drainage_density_per_m = 0;
    Index sources = 0;
    Index max_strahler = 0, max_shreve = 0;  ///< at the outlet
    channel::SlopeArea slope_area = {};      ///< of the slope–area points that lie in it
    std::array<double, 3> ksn_quartiles{};   ///< of its channel nodes' ksn; NaN where none is known
};

/// Channels and what is counted on them. Lengths in metres, areas in m².
struct ChannelStatistics {
    ChannelRule rule;
    double threshold_area_m2;                ///< NaN where channels do not begin by area
    std::array<double, 3> source_area_m2{};  ///< least, median and largest drainage area where channels begin
    double basin_area_m2;                    ///< area of the basins used
    terrain::EdgeBasins edge_basins{};       ///< whether catchments that the edge cuts count
    double share_used;                       ///< of the channel nodes, in complete catchments
    Index nodes;                             ///< channel nodes used
    Index sources, links, junctions, outlets;
    double total_length_m;
    double drainage_density_per_m;  ///< total length over the area of the basins used
    Index max_strahler, max_shreve;
};

/// What is counted and fitted on the links of a network.
struct NetworkStatistics {
    channel::Tokunaga tokunaga;
    PowerLawFit hack;  ///< main-stream length (m) of area (m²)
    channel::LinkLengths links;
    PowerLawFit flint;  ///< slope of 2·magnitude − 1
    double junction_reach_m;
    channel::JunctionAngles junctions;
    channel::CisTrans cis_trans;
    channel::MainStreams main_streams;      ///< rows: links
    std::vector<std::int64_t> pfafstetter;  ///< per link
    channel::WidthFunction width;
    PowerLawFit area_exceedance;  ///< of the largest basin; the exponent is −β
};

/// Long profiles of the channels in χ, at the asked concavity.
struct ChiStatistics {
    double theta, reference_area_m2;
    channel::Profile profile;
    std::vector<double> chi_m, ksn;  ///< per node of the profile; NaN where ksn is not known
    double ksn_median;
    channel::Concavity concavity;
    double knickpoint_prominence_m;  ///< from which on a knickpoint counts; 0: the profile has no relief
    std::vector<channel::Knickpoint> knickpoints;
};

/// Slope–area by single nodes, hillslopes and all: those in the basins whose height, and that of their receiver,
/// conditioning has left alone.
struct SlopeAreaByNodes {
    channel::SlopeArea law;  ///< all bins; the line is that of the ones from `fitted_from_m2` on
    double fitted_from_m2;   ///< where channels begin
    std::size_t looked_at;   ///< nodes
    std::size_t left_out;    ///< nodes that conditioning changed, or their receiver
    double level_share;      ///< of the nodes looked at, without fall
    channel::Turnover turnover;
};

/// Slope–area by links.
struct SlopeAreaByLinks {
    channel::SlopeArea law;
    double level_share;  ///< of the links, without fall
};

/// Every statistic of one terrain.
struct Statistics {
    terrain::Hypsometry hypsometry;
    ChannelStatistics channels;
    std::vector<channel::OrderStatistics> strahler;
    channel::HortonRatios horton;
    NetworkStatistics network_laws;
    channel::SlopeArea slope_area;
    std::vector<channel::SlopeAreaPoint> slope_area_points;
    SlopeAreaByNodes slope_area_nodes;
    SlopeAreaByLinks slope_area_links;
    ChiStatistics chi;
    std::vector<BasinStatistics> basins;
    channel::StreamNetwork network;
    std::vector<Index> strahler_of;  ///< order of each channel node, 0 elsewhere
    std::vector<Index> shreve_of;    ///< magnitude of each channel node, 0 elsewhere
    std::vector<Index> basin_of;     ///< number of each node's basin, `none` outside
};

/// The one pipeline behind analyze, simulate and compare: `slopes` are the slope–area points measured on the terrain in
/// the way that suits it (segments of carved profiles on a raster, nodes on a mesh); `ground_m` is the surface before
/// any conditioning, of which the hypsometry and the relief are taken; `chi` the long profiles (measure_chi).
Statistics measure(const RoutedTerrain&, std::span<const double> ground_m, const MeasureOptions&,
                   std::vector<channel::SlopeAreaPoint> slopes, ChiStatistics chi);

/// Adds to the basins what takes their perimeters (m): those measured on a grid whose cells are labelled as the basins
/// are numbered.
void add_perimeters(std::span<const double> perimeter_m, Statistics&);

/// The threshold that the options ask for, or the default for the terrain's area.
double channel_threshold(const RoutedTerrain&, const MeasureOptions&);

/// 1 where channels run by the options, in complete catchments or not: from the heads or, without any, where the
/// drainage area (that of divided flow, here or upstream) reaches `threshold_m2`.
std::vector<std::uint8_t> channel_nodes(const RoutedTerrain&, const MeasureOptions&, double threshold_m2);

/// Long profiles on the terrain along which slopes are measured (carved, on a raster): ksn over falls of at least
/// `drop_m`, channels from `threshold_m2`.
ChiStatistics measure_chi(const RoutedTerrain& carved, const MeasureOptions&, double threshold_m2, double drop_m);

/// On what the choice of channels rests.
struct ChannelEvidence {
    std::vector<channel::DropTest> drop_tests{};  ///< empty where nothing was left to be chosen
    std::optional<double> slope_area_m2{};        ///< threshold of A·S², where that is the rule
};

/// How a DEM was made to drain.
struct ConditioningReport {
    Index pits = 0;  ///< lakes: pits (or flats) that drained nowhere
    Index cells_changed = 0;
    double volume_m3 = 0;  ///< filled and cut away
    double filled_m3 = 0, cut_m3 = 0;
    Index endorheic_basins = 0;  ///< depressions that keep their water
    Index flat_cells = 0;        ///< that needed a direction by the flat rule
};

/// A measured DEM with the rasters that the measuring made.
struct RasterMeasurement {
    RoutedTerrain terrain;
    ConditioningReport conditioning;
    Index valid_cells = 0;
    double area_m2 = 0;
    double segment_drop_m = 0;  ///< of the slope–area segments
    double vertical_quantum_m = 0;
    ChannelEvidence channel_evidence;
    Statistics statistics;
};

/// Conditions, routes and measures a DEM. Throws Error when there is nothing to measure. `when_routed` is called before
/// the statistics; what it returns may read the terrain meanwhile and is waited for, however measuring ends.
RasterMeasurement measure_raster(const Raster&, const MeasureOptions&,
                                 const std::function<std::future<void>(const RoutedTerrain&)>& when_routed = {});

/// Area of the cells with data, m².
double data_area(const Raster&);

/// The nearest, in the logarithm, of 1, 2 and 5 times powers of ten.
double rounded_to_1_2_5(double target);

/// The threshold of channels by default: 0.1 % of the area rounded to 1, 2 or 5 times a power of ten.
double default_channel_area(double area_m2);

/// The same for a raster that is one catchment, and at least 50 cells: small catchments have no valleys finer than
/// that.
double catchment_channel_area(const Raster&);

}  // namespace thalweg::study
