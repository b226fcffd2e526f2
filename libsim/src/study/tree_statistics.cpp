// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/tree_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace thalweg::study {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr Estimate unknown{nan, nan, {nan, nan}};

/// Links' values at their upper vertices, where Hack's law looks for them.
std::vector<double> at_upper_ends(const grow::Network& network, const std::vector<double>& of_link) {
    std::vector<double> at(network.vertices.size(), nan);
    for (Index link = 0; link < network.size(); ++link) at[network.upper[link]] = of_link[link];
    return at;
}

channel::OffsetOf offsets(const grow::Network& network) {
    return [&network](Index from, Index to) {
        const Point& a = network.vertices[from];
        const Point& b = network.vertices[to];
        return Point{b.x - a.x, b.y - a.y};
    };
}

ChannelStatistics channels_of(const grow::Network& network, const channel::StreamNetwork& tree) {
    ChannelStatistics c{};
    c.threshold_area_m2 = nan;
    c.source_area_m2 = {nan, nan, nan};
    c.basin_area_m2 = grow::total_area(network);
    c.share_used = 1;
    c.nodes = tree.size() + 1;
    c.links = tree.size();
    c.junctions = static_cast<Index>(network.junctions.size());
    c.sources = c.junctions + 1;
    c.outlets = 1;
    c.total_length_m = grow::total_length(network);
    c.drainage_density_per_m = c.total_length_m / c.basin_area_m2;
    c.max_strahler = *std::ranges::max_element(tree.strahler);
    c.max_shreve = *std::ranges::max_element(tree.shreve);
    return c;
}

PowerLawFit flint_of_links(const channel::StreamNetwork& tree) {
    std::vector<double> twice_less_one, slope;
    for (Index link = 0; link < tree.size(); ++link) {
        twice_less_one.push_back(2.0 * tree.shreve[link] - 1);
        slope.push_back(tree.drop_m[link] / tree.length_m[link]);
    }
    return fit_power_law(twice_less_one, slope);
}

/// Squares of a plane, to find the places near one.
class Places {
  public:
    Places(std::span<const Point> places, double side) : places_(places), side_(side) {
        for (Index i = 0; i < places.size(); ++i) squares_.emplace(square_of(places[i]), i);
    }

    bool any_within(const Point& p, double distance) const {
        for (const double dx : {-side_, 0.0, side_}) {
            for (const double dy : {-side_, 0.0, side_}) {
                const auto [first, last] = squares_.equal_range(square_of({p.x + dx, p.y + dy}));
                for (auto at = first; at != last; ++at) {
                    const Point& q = places_[at->second];
                    if (std::hypot(q.x - p.x, q.y - p.y) <= distance) return true;
                }
            }
        }
        return false;
    }

  private:
    std::uint64_t square_of(const Point& p) const {
        const auto cell = [&](double v) { return static_cast<std::uint64_t>(std::llround(std::floor(v / side_))); };
        return cell(p.x) << 32 ^ (cell(p.y) & 0xffffffff);
    }

    std::span<const Point> places_;
    double side_;
    std::unordered_multimap<std::uint64_t, Index> squares_;
};

Index count_near(std::span<const Point> asked, std::span<const Point> places, double within_m) {
    const Places near(places, within_m);
    return static_cast<Index>(
        std::ranges::count_if(asked, [&](const Point& p) { return near.any_within(p, within_m); }));
}

/// Upper ends of links into which others flow.
std::vector<Point> junctions_of(const channel::StreamNetwork& network, const std::function<Point(Index)>& position) {
    std::vector<Index> nodes;
    for (Index link = 0; link < network.size(); ++link) {
        const Index below = network.downstream[link];
        if (below != none) nodes.push_back(network.nodes_of(below).front());
    }
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    std::vector<Point> places;
    for (const Index node : nodes) places.push_back(position(node));
    return places;
}

}  // namespace

TreeStatistics tree_statistics(const grow::Network& network, const channel::StreamNetwork& tree) {
    TreeStatistics s{
        .channels = channels_of(network, tree),
        .strahler = channel::strahler_statistics(tree),
        .horton = {},
        .laws = {.tokunaga = channel::tokunaga(tree),
                 .hack = channel::hack_law(tree, at_upper_ends(network, tree.area_m2),
                                           at_upper_ends(network, channel::longest_upstream_lengths(tree))),
                 .links = channel::link_lengths(tree),
                 .flint = channel::flint_law(tree),
                 .junction_reach_m = channel::junction_reach(tree),
                 .junctions = {},
                 .cis_trans = {},
                 .main_streams = channel::main_streams(tree),
                 .pfafstetter = channel::pfafstetter_codes(tree),
                 .width = channel::width_function(tree),
                 .area_exceedance = {unknown, unknown, nan}},
        .flint_links = flint_of_links(tree)};
    s.horton = channel::horton_ratios(s.strahler);
    const channel::OffsetOf offset = offsets(network);
    NetworkStatistics& laws = s.laws;
    laws.junctions = channel::junction_angles(tree, offset, laws.junction_reach_m, laws.flint.exponent.value);
    laws.cis_trans = channel::cis_trans_links(tree, offset, laws.junction_reach_m);
    return s;
}

TributaryAngles tributary_angles(const grow::Network& network, const grow::Flint& flint) {
    std::vector<double> drawn, howard;
    for (const grow::Junction& junction : network.junctions) {
        drawn.push_back(junction.angle_rad);
        howard.push_back(grow::junction_angle(grow::gradient(flint, network.magnitude[junction.downstream]),
                                              grow::gradient(flint, network.magnitude[junction.tributary])));
    }
    return {static_cast<Index>(drawn.size()), mean(drawn), standard_deviation(drawn), mean(howard),
            standard_deviation(howard)};
}

Recovery recovery(std::span<const Point> grown_junctions, double tree_length_m, const channel::StreamNetwork& found,
                  const std::function<Point(Index)>& position, double within_m) {
    const std::vector<Point> again = junctions_of(found, position);
    Recovery r{};
    r.grown = static_cast<Index>(grown_junctions.size());
    r.found = static_cast<Index>(again.size());
    r.recovered = count_near(grown_junctions, again, within_m);
    r.unmatched = r.found - count_near(again, grown_junctions, within_m);
    r.tree_length_m = tree_length_m;
    for (const double length : found.length_m) r.found_length_m += length;
    return r;
}

}  // namespace thalweg::study
