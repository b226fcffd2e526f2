// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/grow/grow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "grow/candidates.hpp"
#include "grow/growing_tree.hpp"
#include "grow/junction.hpp"
#include "grow/plane.hpp"
#include "grow/trunk.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/mesh/triangulate.hpp"

namespace thalweg::grow {
namespace {

// Shares of C, ours where Kelley et al. (1988) are silent.
constexpr double shortest_split_link = 0.2;  // halved, when nothing else can grow, down to the second value
constexpr double shortest_split_at_last = 0.02;
constexpr double room_beyond_source = 0.5;
constexpr double least_width_of_side = 0.5;
constexpr double shortest_tributary = 0.5;  // of the shortest link that is split
constexpr double least_divide_share = 0.1;  // of the angle: a divide along a link would leave that side nothing
constexpr double density_met = 0.01;        // so much length may be missing: under 1 % in a basin of one C²

constexpr Index looked_ahead = 16;     // candidates
constexpr Index fits_in_cache = 5000;  // links: 300 bytes each

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

constexpr Index draws_per_step = 16;
constexpr Index tries_per_side = 4;

/// What is drawn: each has a stream of random numbers of its own.
enum class Draw : std::uint32_t { junction = 0x67726f00, length, side, lengthening, sidewall, divide };

constexpr Side opposite(Side side) { return side == Side::left ? Side::right : Side::left; }

/// mean + Rand·delta, Rand uniform on [−1, 1], kept within 0.05–0.95 of the whole.
double drawn_share(double mean, double delta, double uniform) {
    return std::clamp(mean + (2 * uniform - 1) * delta, 0.05, 0.95);
}

/// Room for what usually grows in a basin of so many C²: a network that outgrows it takes more.
void reserve(GrowingTree& tree, double squares) {
    const double links = std::min(3 * squares, 4e6);  // a gigabyte, of which only what is used is ever taken
    tree.links.reserve(static_cast<std::size_t>(links));
    tree.streams.reserve(static_cast<std::size_t>(links / 2));
    tree.junctions.reserve(static_cast<std::size_t>(links / 2));
    tree.sources.reserve(static_cast<Index>(links / 2));
    tree.basin.reserve(static_cast<Index>(5 * links), static_cast<Index>(4 * links));
}

class Grower {
  public:
    Grower(GrowingTree tree, const Dials& dials, double basin_area);
    void place_bends(std::size_t bends, const Point& origin);
    Growth run(const Point& origin, Stages&);

  private:
    double uniform(Draw, std::uint64_t number) const;
    double excess(Index link) const;
    double beyond_source(Index link) const;
    double missing_length() const;
    void enter(Index link);
    bool take_candidate(Index& link);
    void look_ahead() const;
    bool density_reached() const;
    bool ease_rules();
    void lengthen(Index link);
    bool add_tributary(Index link);
    Side drawn_side(const GrowingLink&, double share_of_link, double number_drawn) const;
    bool is_wide_enough(const GrowingLink&, Side) const;
    std::array<double, 2> drawn_sidewalls(Index link) const;
    std::optional<DivideShares> drawn_divides(std::uint64_t draw_number) const;
    StopReason grow_until_stopped(const Point& origin, Stages&);
    void keep_stage(const Point& origin, Stages&) const;
    Network network(const Point& origin) const;

    GrowingTree tree_;
    Dials dials_;
    const double c_;
    const double wanted_length_;
    const double link_limit_;
    double shortest_split_;  ///< m
    Candidates candidates_;
    std::uint64_t step_ = 0;
    std::uint64_t taken_ = 0;
    Index lengthened_ = 0;
    Index refused_ = 0;
    Index last_resorts_ = 0;
};

Grower::Grower(GrowingTree tree, const Dials& dials, double basin_area)
    : tree_(std::move(tree)),
      dials_(dials),
      c_(dials.channel_maintenance_m),
      wanted_length_(basin_area / c_),
      link_limit_(std::min(1000 + 400 * basin_area / (c_ * c_), 4e8)),
      shortest_split_(shortest_split_link * c_),
      candidates_(basin_area) {
    reserve(tree_, basin_area / (c_ * c_));
    tree_.links[0].sidewall_slope = drawn_sidewalls(0);
}

double Grower::uniform(Draw draw, std::uint64_t number) const {
    return uniform_at(dials_.seed, static_cast<std::uint32_t>(draw), number);
}

double Grower::excess(Index link) const { return tree_.links[link].area() - c_ * tree_.links[link].length_m; }

/// 0 for interior links.
double Grower::beyond_source(Index link) const {
    if (!tree_.links[link].is_exterior()) return 0;
    const Index head = head_of(tree_, link);
    return norm(tree_.basin.point(tree_.basin.target(head)) - tree_.basin.point(tree_.basin.origin(head)));
}

double Grower::missing_length() const {
    return dials_.stop == Stop::density ? wanted_length_ - tree_.length_m : std::numeric_limits<double>::infinity();
}

void Grower::enter(Index link) {
    const bool long_enough = tree_.links[link].length_m >= shortest_split_;
    const bool may_grow = long_enough || beyond_source(link) > room_beyond_source * c_;
    if (excess(link) > 0 && may_grow) candidates_.push({excess(link), link});
}

/// The link with the largest excess. It is as it was when it was entered: only the link that was taken grows, within
/// its own polygons, and enters anew with those that it gave rise to. So no link waits twice, and none that was refused
/// does.
bool Grower::take_candidate(Index& link) {
    Candidate top{};
    if (!candidates_.pop(top)) return false;
    if (++taken_ % looked_ahead == 0) look_ahead();
    link = top.link;
    return true;
}

void Grower::look_ahead() const {
    if (tree_.links.size() < fits_in_cache) return;
    std::array<Index, looked_ahead> links{};
    Index count = 0;
    for (const Candidate& candidate : candidates_.upcoming(looked_ahead)) links[count++] = candidate.link;
    fetch_ahead(tree_, std::span(links).first(count));
}

bool Grower::density_reached() const { return missing_length() < density_met * c_; }

/// Where straight lines have run into dead ends and the density is still to be met: first exterior links may turn, then
/// shorter links may be split and shorter tributaries made. All links, also those refused, get another chance.
bool Grower::ease_rules() {
    if (dials_.stop != Stop::density || shortest_split_ <= shortest_split_at_last * c_) return false;
    if (dials_.upstream_link == UpstreamLink::keeps_line) {
        dials_.upstream_link = UpstreamLink::turns;
    } else {
        shortest_split_ = std::max(shortest_split_ / 2, shortest_split_at_last * c_);
    }
    ++last_resorts_;
    refused_ = 0;
    for (Index link = 0; link < tree_.links.size(); ++link) enter(link);
    return true;
}

/// Moves a source on, straight ahead.
void Grower::lengthen(Index number) {
    GrowingLink& link = tree_.links[number];
    const double share = drawn_share(dials_.mean_length, dials_.delta_length, uniform(Draw::lengthening, step_));
    const double gain = std::min(share * beyond_source(number), missing_length());
    const Point lower = tree_.basin.point(tree_.basin.origin(link.edge));
    const Index source = tree_.basin.target(link.edge);
    const Point along = tree_.basin.point(source) - lower;
    tree_.basin.move_vertex(source, lower + ((link.length_m + gain) / link.length_m) * along);
    link.length_m += gain;
    link.area_m2 = {tree_.basin.area(link.edge), tree_.basin.area(link.edge ^ 1)};
    tree_.streams[link.stream].length_m += gain;
    tree_.length_m += gain;
    ++lengthened_;
    enter(number);
}

bool Grower::is_wide_enough(const GrowingLink& link, Side side) const {
    return link.area_m2[static_cast<std::size_t>(side)] >= least_width_of_side * c_ * link.length_m;
}

Side Grower::drawn_side(const GrowingLink& link, double share_of_link, double number_drawn) const {
    const GrowingStream& stream = tree_.streams[link.stream];
    const double third = (link.start_m + share_of_link * link.length_m) / stream.length_m * 3;
    const bool is_lowest = link.mark == SourceOrder::opening(link.stream);
    Side favoured = Side::left;
    double share = 0.5;
    if (third < 1 && stream.junction != none) {
        favoured = tree_.junctions[stream.junction].side;  // a stream's obtuse side faces down its parent's valley
        share = dials_.lower_bias;
    } else if (third >= 1 && third < 2 && !is_lowest) {
        const Index tributary_below = link.mark / 2;  // the mark of a link is the source of the tributary at its foot
        favoured = opposite(tree_.junctions[tree_.streams[tributary_below].junction].side);
        share = dials_.middle_bias;
    }
    const Side side = number_drawn < share ? favoured : opposite(favoured);
    return is_wide_enough(link, side) ? side : opposite(side);
}

/// Tangents of the left and right sidewall's angle.
std::array<double, 2> Grower::drawn_sidewalls(Index link) const {
    std::array<double, 2> slope{};
    for (std::uint64_t side = 0; side < 2; ++side) {
        const double rand = 2 * uniform(Draw::sidewall, 2 * std::uint64_t{link} + side) - 1;
        const double angle_deg = dials_.sidewall_angle_deg + rand * dials_.delta_sidewall_angle_deg;
        slope[side] = std::tan(angle_deg * std::numbers::pi / 180);
    }
    return slope;
}

std::optional<DivideShares> Grower::drawn_divides(std::uint64_t draw_number) const {
    if (dials_.divides == Divides::slopes) return std::nullopt;
    const auto share = [&](const DrawnShare& dial, std::uint64_t which) {
        const double rand = 2 * uniform(Draw::divide, 3 * draw_number + which) - 1;
        return std::clamp(dial.mean + rand * dial.delta, least_divide_share, 1 - least_divide_share);
    };
    return DivideShares{.across = share(dials_.divide_across, 0),
                        .below = share(dials_.divide_below, 1),
                        .above = share(dials_.divide_above, 2)};
}

bool Grower::add_tributary(Index number) {
    const auto upper = static_cast<Index>(tree_.links.size());
    for (Index attempt = 0; attempt < 2 * tries_per_side; ++attempt) {
        const GrowingLink& link = tree_.links[number];
        const std::uint64_t draw_number = step_ * draws_per_step + attempt;
        const double place =
            drawn_share(dials_.mean_junction, dials_.delta_junction, uniform(Draw::junction, draw_number));
        Side side = drawn_side(link, place, uniform(Draw::side, draw_number));
        if (attempt >= tries_per_side) side = opposite(side);
        if (!is_wide_enough(link, side)) continue;
        const TributaryDraw draw{
            .share_of_link = place,
            .side = side,
            .share_of_way = drawn_share(dials_.mean_length, dials_.delta_length, uniform(Draw::length, draw_number)),
            .sidewall_slope = drawn_sidewalls(upper + 1),
            .divides = drawn_divides(draw_number),
            .shortest_m = shortest_tributary * shortest_split_,
            .longest_m = missing_length()};
        const auto plan = plan_junction(tree_, dials_, number, draw);
        if (!plan) continue;
        make_junction(tree_, *plan);
        for (const Index link_of_junction : {number, upper, upper + 1}) enter(link_of_junction);
        return true;
    }
    return false;
}

/// The trunk bends at junctions only, as rivers do: each bend gets a tributary on its outer side.
void Grower::place_bends(std::size_t bends, const Point& origin) {
    Index upper = 0;
    auto left = static_cast<double>(bends);
    // With `stop = links` C may be far larger than the basin.
    const double shortest = shortest_tributary * shortest_split_at_last * std::min(c_, tree_.length_m);
    for (; !is_straight(tree_, upper); ++step_, --left) {
        const TributaryDraw draw{
            .share_of_link = nan,
            .side = Side::left,
            .share_of_way = drawn_share(dials_.mean_length, dials_.delta_length, uniform(Draw::length, step_)),
            .sidewall_slope = drawn_sidewalls(static_cast<Index>(tree_.links.size()) + 1),
            .divides = drawn_divides(step_ * draws_per_step),
            .shortest_m = shortest,
            .longest_m = std::max(missing_length() / (left + 1), shortest)};
        const auto plan = plan_bend(tree_, dials_, upper, draw);
        if (!plan) {
            const Point& bend = tree_.basin.point(tree_.basin.target(tree_.links[upper].edge));
            throw TrunkError(
                TrunkFault::bend, tree_.junctions.size() + 1,
                fmt::format(
                    "the trunk bends at ({}, {}) where no tributary and divides reach the basin's edge past its "
                    "other bends: straighten it there",
                    bend.x + origin.x, bend.y + origin.y));
        }
        upper = static_cast<Index>(tree_.links.size());
        make_junction(tree_, *plan);
    }
    for (Index link = 0; link < tree_.links.size(); ++link) enter(link);
}

void Grower::keep_stage(const Point& origin, Stages& stages) const {
    const std::size_t kept = stages.networks.size();
    if (kept == stages.links.size() || tree_.links.size() < stages.links[kept]) return;
    stages.networks.push_back(network(origin));
}

Network Grower::network(const Point& origin) const {
    Network whole = finished(tree_, origin);
    whole.sidewall_reach_m = dials_.sidewall_reach_m;
    return whole;
}

StopReason Grower::grow_until_stopped(const Point& origin, Stages& stages) {
    Index link = none;
    for (;; ++step_) {
        keep_stage(origin, stages);
        if (density_reached()) return StopReason::density_reached;
        if (static_cast<double>(tree_.links.size()) > link_limit_) return StopReason::link_limit;
        if (!take_candidate(link)) {
            if (!ease_rules()) return StopReason::no_candidate;
            continue;
        }
        if (beyond_source(link) > room_beyond_source * c_) {
            lengthen(link);
        } else if (!add_tributary(link)) {
            ++refused_;
        }
    }
}

Growth Grower::run(const Point& origin, Stages& stages) {
    const StopReason reason = grow_until_stopped(origin, stages);
    return {network(origin), reason, lengthened_, refused_, last_resorts_};
}

void check_against_basin(const Dials& dials, const Basin& basin) {
    const double c = dials.channel_maintenance_m;
    const double area = mesh::polygon_area(basin.outline);
    const std::vector<Point> places = trunk_of(basin);
    double trunk = 0;
    for (std::size_t i = 1; i < places.size(); ++i) trunk += norm(places[i] - places[i - 1]);
    if (dials.stop == Stop::density && area / trunk <= c) {
        throw Error(fmt::format(
            "channel_maintenance_m is {}, but the trunk alone leaves {:.6g} m² of basin per metre of channel "
            "({:.6g} m² over {:.6g} m): give a smaller one, or a shorter trunk",
            c, area / trunk, area, trunk));
    }
    if (area > 1e8 * c * c) {
        throw Error(
            fmt::format("channel_maintenance_m is {}: a basin of {:.6g} m² would take more than 1e8 links", c, area));
    }
}

/// With a junction at every bend of the trunk, and nothing else yet.
Grower started(const Basin& basin, const Dials& dials) {
    check_against_basin(dials, basin);
    GrowingTree tree = cut_along_trunk(basin, dials.channel_maintenance_m);
    const double area = tree.links[0].area();
    Grower grower(std::move(tree), dials, area);
    grower.place_bends(basin.bends.size(), basin.outlet);
    return grower;
}

}  // namespace

Growth grow(const Basin& given, const Dials& dials) {
    Stages none_kept;
    return grow(given, dials, none_kept);
}

Growth grow(const Basin& given, const Dials& dials, Stages& stages) {
    check_dials(dials);
    const Basin basin = checked_basin(given);
    return started(basin, dials).run(basin.outlet, stages);
}

void check_trunk(const Basin& given, const Dials& dials) {
    check_dials(dials);
    started(checked_basin(given), dials);
}

}  // namespace thalweg::grow
