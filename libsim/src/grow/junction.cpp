// SPDX-License-Identifier: GPL-3.0-or-later
#include "grow/junction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "grow/plane.hpp"

namespace thalweg::grow {
namespace {

using std::numbers::pi;

constexpr double shortest_link_of_c = 1e-3;
constexpr double shortest_divide_of_c = 1e-6;  // of C
constexpr double tolerance_of_c = 1e-9;  // of C: far above rounding in a basin of a million links, far below a link
constexpr double furthest_turned_link = 0.95;  // of the way to the polygon's edge
constexpr double furthest_tributary = 0.95;    // the same
constexpr DivideShares halves{.across = 0.5, .below = 0.5, .above = 0.5};

/// A link at the junction as the divides see it: its direction and what lies on either hand, facing away.
struct LinkAtJunction {
    double angle_rad;
    JunctionAt junction;
    double gradient;
    double slope_on_left;
    double slope_on_right;
};

double divide_between(const LinkAtJunction& first, const LinkAtJunction& second) {
    return divide_direction({first.angle_rad, first.junction, first.gradient, first.slope_on_left},
                            {second.angle_rad, second.junction, second.gradient, second.slope_on_right});
}

void add_ray(JunctionPlan& plan, const Point& upstream, Arm arm, double angle_rad) {
    plan.rays[plan.ray_count++] = {arm, angle_rad, {plan.place, turned(upstream, angle_rad)}, {}};
}

/// Directions of all that will leave the junction, counter-clockwise from the downstream link.
void set_directions(const GrowingLink& link, const Flint& flint, const Point& upstream, JunctionPlan& plan) {
    const auto& [left_slope, right_slope] = link.sidewall_slope;
    const double below = gradient(flint, plan.magnitude + 1);
    const LinkAtJunction down_by_right{-pi, JunctionAt::upper_end, below, right_slope, left_slope};
    const LinkAtJunction down_by_left{pi, JunctionAt::upper_end, below, right_slope, left_slope};
    const double hand = plan.draw.side == Side::left ? 1 : -1;
    const LinkAtJunction up{-hand * plan.turn_rad, JunctionAt::lower_end, gradient(flint, plan.magnitude), left_slope,
                            right_slope};
    const LinkAtJunction tributary{hand * plan.angle_rad, JunctionAt::lower_end, gradient(flint, 1),
                                   plan.draw.sidewall_slope[0], plan.draw.sidewall_slope[1]};
    const bool on_left = plan.draw.side == Side::left;
    const LinkAtJunction& right = on_left ? up : tributary;
    const LinkAtJunction& left = on_left ? tributary : up;
    const auto add_link = [&](bool is_tributary, const LinkAtJunction& at) {
        if (is_tributary) add_ray(plan, upstream, Arm::tributary, at.angle_rad);
        if (!is_tributary && plan.turn_rad > 0 && plan.bend_of == none)
            add_ray(plan, upstream, Arm::upstream_link, at.angle_rad);
    };
    const auto& drawn = plan.draw.divides;
    const auto parting = [&](const LinkAtJunction& first, const LinkAtJunction& second, double drawn_share) {
        if (!drawn) return divide_between(first, second);
        return first.angle_rad + drawn_share * (second.angle_rad - first.angle_rad);
    };
    const DivideShares share = drawn.value_or(DivideShares{});
    add_ray(plan, upstream, Arm::divide, parting(down_by_right, right, on_left ? share.across : share.below));
    add_link(!on_left, right);
    add_ray(plan, upstream, Arm::divide, parting(right, left, on_left ? 1 - share.above : share.above));
    add_link(on_left, left);
    add_ray(plan, upstream, Arm::divide, parting(left, down_by_left, 1 - (on_left ? share.below : share.across)));
}

/// Number of rays that start into the right polygon, if the upstream link stays where it is.
Index rays_to_the_right(const JunctionPlan& plan) {
    const double hand = plan.draw.side == Side::left ? 1 : -1;
    Index count = 0;
    while (count < plan.ray_count && plan.rays[count].angle_rad < -hand * plan.turn_rad) ++count;
    return count;
}

/// Meets rays [begin, end) with the polygon of `first`, keeping what they met nearer before.
void meet_polygon(const GrowingTree& tree, Index first, std::span<const Index> skipped, double tolerance, Index begin,
                  Index end, JunctionPlan& plan) {
    constexpr Index other_walk = Index{1} << 30;  // the left polygon's sides come after the right one's
    std::array<Ray, 5> rays;
    std::array<Hit, 5> hits;
    for (Index i = begin; i < end; ++i) rays[i] = plan.rays[i].ray;
    find_hits(tree.basin, first, skipped, std::span(rays).subspan(begin, end - begin), tolerance,
              std::span(hits).subspan(begin, end - begin));
    const bool is_left = first == tree.links[plan.link].edge;
    for (Index i = begin; i < end; ++i) {
        if (hits[i].half_edge == none) continue;
        if (is_left) hits[i].order += other_walk;
        Hit& nearest = plan.rays[i].hit;
        if (nearest.half_edge == none || hits[i].distance < nearest.distance) nearest = hits[i];
    }
}

void meet_polygons(const GrowingTree& tree, double tolerance, JunctionPlan& plan) {
    const Index edge = tree.links[plan.link].edge;
    if (plan.turn_rad > 0 && plan.bend_of == none) {  // both polygons become one
        const Index head = head_of(tree, plan.link);
        const std::array skipped{edge, head};
        meet_polygon(tree, edge ^ 1, skipped, tolerance, 0, plan.ray_count, plan);
        meet_polygon(tree, edge, skipped, tolerance, 0, plan.ray_count, plan);
        for (PlannedRay& planned : plan.rays) {  // the head's upper end stays, the head does not
            if (planned.hit.half_edge == (head ^ 1)) planned.hit.half_edge = tree.basin.next(head);
        }
    } else {
        const std::array skipped{edge, plan.bend_of == none ? edge : plan.bend_of};
        const Index right = rays_to_the_right(plan);
        meet_polygon(tree, edge ^ 1, skipped, tolerance, 0, right, plan);
        meet_polygon(tree, edge, skipped, tolerance, right, plan.ray_count, plan);
    }
}

/// Whether a ray ends on a channel, or on the way on from a source to the divide.
bool ends_on_trunk(const Subdivision& basin, const Hit& hit) {
    const auto is_trunk = [&](Index half_edge) {
        return basin.kind(half_edge) == EdgeKind::channel || basin.kind(half_edge) == EdgeKind::head;
    };
    return hit.half_edge == none || is_trunk(hit.half_edge) ||
           (hit.at_origin && is_trunk(basin.previous(hit.half_edge)));
}

/// Directions of what lies on either hand of a ray of a bend.
std::array<double, 2> between_links(const JunctionPlan& plan, Index ray) {
    const double hand = plan.draw.side == Side::left ? 1 : -1;
    const double up = -hand * plan.turn_rad, tributary = hand * plan.angle_rad;
    const std::array links{-pi, std::min(up, tributary), std::max(up, tributary), pi};
    Index divides_before = 0;
    for (Index i = 0; i < ray; ++i) divides_before += plan.rays[i].arm == Arm::divide;
    return {links[divides_before], links[divides_before + 1]};
}

/// Turns a divide of a bend that ends on the trunk to the nearest of 64 directions in which it does not.
bool turn_past_trunk(const GrowingTree& tree, const Point& downstream, double tolerance, Index number,
                     JunctionPlan& plan) {
    constexpr int directions = 64;
    PlannedRay& planned = plan.rays[number];
    if (!ends_on_trunk(tree.basin, planned.hit)) return true;
    if (planned.arm != Arm::divide) return false;
    const auto [from, to] = between_links(plan, number);
    const double wanted = planned.angle_rad;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 1; i < directions; ++i) {
        const double angle = from + (to - from) * i / directions;
        if (std::abs(angle - wanted) >= least) continue;
        JunctionPlan turned_plan = plan;
        turned_plan.rays[number] = {Arm::divide, angle, {plan.place, turned(downstream, angle)}, {}};
        meet_polygons(tree, tolerance, turned_plan);
        if (ends_on_trunk(tree.basin, turned_plan.rays[number].hit)) continue;
        least = std::abs(angle - wanted);
        planned = turned_plan.rays[number];
    }
    return std::isfinite(least);
}

/// A tributary drawn too short is made as short as may be, if that far it is to the polygon's edge.
void reach_shortest(JunctionPlan& plan) {
    for (const PlannedRay& planned : std::span(plan.rays).first(plan.ray_count)) {
        if (planned.arm != Arm::tributary) continue;
        const double least = (1 + 1e-9) * plan.draw.shortest_m / planned.hit.distance;  // rounding must not fall below
        plan.draw.share_of_way = std::min(std::max(plan.draw.share_of_way, least), furthest_tributary);
    }
}

/// Whether every ray arrives, far enough out, and in another place than its neighbours.
bool can_be_told_apart(const GrowingTree& tree, const JunctionPlan& plan, double c) {
    for (Index i = 0; i < plan.ray_count; ++i) {
        const Hit& hit = plan.rays[i].hit;
        if (hit.half_edge == none || hit.distance < shortest_divide_of_c * c) return false;
        if (i == 0) continue;
        const Hit& before = plan.rays[i - 1].hit;
        if (norm(hit.place - before.place) < shortest_divide_of_c * c) return false;
        if (hit.order < before.order) return false;
        if (hit.order > before.order) continue;
        const Point& start = tree.basin.point(tree.basin.origin(hit.half_edge));
        if (norm(hit.place - start) <= norm(before.place - start)) return false;
    }
    return true;
}

/// Whether the links are long enough; only then the tributary is cut to what is missing.
bool set_lengths(const GrowingLink& link, double shortest_link, JunctionPlan& plan) {
    plan.lower_length_m = plan.draw.share_of_link * link.length_m;
    plan.upstream_length_m = (1 - plan.draw.share_of_link) * link.length_m;
    for (const PlannedRay& planned : std::span(plan.rays).first(plan.ray_count)) {
        if (planned.arm == Arm::tributary) {
            plan.tributary_length_m = plan.draw.share_of_way * planned.hit.distance;
        } else if (planned.arm == Arm::upstream_link) {
            plan.upstream_length_m = std::min(plan.upstream_length_m, furthest_turned_link * planned.hit.distance);
        }
    }
    const bool fits = plan.tributary_length_m >= plan.draw.shortest_m && plan.upstream_length_m >= shortest_link;
    plan.tributary_length_m = std::min(plan.tributary_length_m, plan.draw.longest_m);
    return fits;
}

/// Draws a ray's line; returns its half-edge from the junction.
Index draw_line(Subdivision& basin, Index from, const PlannedRay& planned) {
    const Hit& hit = planned.hit;
    const Index to = hit.at_origin ? hit.half_edge : basin.insert_vertex(hit.half_edge, hit.place);
    return basin.connect(from, to, EdgeKind::divide);
}

/// Makes a line from the junction a channel up to a source, and the head from there on.
void put_source(Subdivision& basin, Index edge, const PlannedRay& planned, double length_m) {
    const Index head = basin.insert_vertex(edge, planned.ray.start + length_m * planned.ray.direction);
    basin.set_kind(edge, EdgeKind::channel);
    basin.set_kind(head, EdgeKind::head);
}

struct NewEdges {
    Index upstream;
    Index tributary;
};

NewEdges cut_polygons(Subdivision& basin, Index edge, const JunctionPlan& plan) {
    const bool is_bend = plan.bend_of != none, turns = plan.turn_rad > 0 && !is_bend;
    const Index upper_half = is_bend ? plan.bend_of : basin.insert_vertex(edge, plan.place);
    NewEdges made{upper_half, none};
    if (turns) {
        basin.remove(basin.next(upper_half));
        basin.remove(upper_half);
    }
    const Index right = turns ? plan.ray_count : rays_to_the_right(plan);
    for (Index i = plan.ray_count; i-- > 0;) {  // backwards: what a ray met stays where it was on its polygon's walk
        const PlannedRay& planned = plan.rays[i];
        const Index line = draw_line(basin, i < right ? edge ^ 1 : upper_half, planned);
        if (planned.arm == Arm::divide) continue;
        const bool is_tributary = planned.arm == Arm::tributary;
        (is_tributary ? made.tributary : made.upstream) = line;
        put_source(basin, line, planned, is_tributary ? plan.tributary_length_m : plan.upstream_length_m);
    }
    return made;
}

void measure_polygons(const Subdivision& basin, GrowingLink& link) {
    link.area_m2 = {basin.area(link.edge), basin.area(link.edge ^ 1)};
}

}  // namespace

std::optional<JunctionPlan> plan_junction(const GrowingTree& tree, const Dials& dials, Index number,
                                          const TributaryDraw& draw) {
    const GrowingLink& link = tree.links[number];
    const Point& lower = tree.basin.point(tree.basin.origin(link.edge));
    const Point along = tree.basin.point(tree.basin.target(link.edge)) - lower;
    const double c = dials.channel_maintenance_m;
    JunctionPlan plan{};
    plan.link = number;
    plan.draw = draw;
    plan.magnitude = tree.magnitude(number);
    plan.place = lower + draw.share_of_link * along;
    const double below = gradient(dials.flint, plan.magnitude + 1);
    plan.angle_rad = junction_angle(below, gradient(dials.flint, 1));
    const bool turns = dials.upstream_link == UpstreamLink::turns && link.is_exterior();
    plan.turn_rad = turns ? junction_angle(below, gradient(dials.flint, plan.magnitude)) : 0;
    set_directions(link, dials.flint, (1 / norm(along)) * along, plan);
    meet_polygons(tree, tolerance_of_c * c, plan);
    if (!can_be_told_apart(tree, plan, c) || !set_lengths(link, shortest_link_of_c * c, plan)) return std::nullopt;
    return plan;
}

bool is_straight(const GrowingTree& tree, Index link) {
    const Index edge = tree.links[link].edge;
    return !tree.links[link].is_exterior() || tree.basin.kind(tree.basin.next(edge)) != EdgeKind::channel;
}

std::optional<JunctionPlan> plan_bend(const GrowingTree& tree, const Dials& dials, Index number, TributaryDraw draw) {
    const GrowingLink& link = tree.links[number];
    const Subdivision& basin = tree.basin;
    const double c = std::min(dials.channel_maintenance_m, tree.streams[link.stream].length_m);
    JunctionPlan plan{};
    plan.link = number;
    plan.magnitude = tree.magnitude(number);
    plan.bend_of = basin.next(link.edge);
    plan.place = basin.point(basin.target(link.edge));
    const Point below = plan.place - basin.point(basin.origin(link.edge));
    const Point above = basin.point(basin.target(plan.bend_of)) - plan.place;
    plan.turn_rad = std::abs(std::atan2(cross(below, above), dot(below, above)));
    plan.lower_length_m = norm(below);
    draw.side = cross(below, above) > 0 ? Side::right : Side::left;
    draw.share_of_link = plan.lower_length_m / link.length_m;
    draw.divides = halves;
    plan.draw = draw;
    plan.angle_rad = junction_angle(gradient(dials.flint, plan.magnitude + 1), gradient(dials.flint, 1));
    const Point downstream = (1 / plan.lower_length_m) * below;
    set_directions(link, dials.flint, downstream, plan);
    meet_polygons(tree, tolerance_of_c * c, plan);
    for (Index ray = 0; ray < plan.ray_count; ++ray) {
        if (!turn_past_trunk(tree, downstream, tolerance_of_c * c, ray, plan)) return std::nullopt;
    }
    reach_shortest(plan);
    if (!can_be_told_apart(tree, plan, c) || !set_lengths(link, 0, plan)) return std::nullopt;
    return plan;
}

void make_junction(GrowingTree& tree, const JunctionPlan& plan) {
    const auto upper_number = static_cast<Index>(tree.links.size());
    const Index tributary_number = upper_number + 1;
    const auto stream = static_cast<Index>(tree.streams.size());
    const GrowingLink parent = tree.links[plan.link];
    const NewEdges made = cut_polygons(tree.basin, parent.edge, plan);

    GrowingLink lower = parent;
    lower.upstream = {upper_number, tributary_number};
    lower.length_m = plan.lower_length_m;
    GrowingLink upper = parent;
    upper.edge = made.upstream;
    upper.downstream = plan.link;
    upper.start_m = parent.start_m + lower.length_m;
    upper.length_m = plan.upstream_length_m;
    upper.mark = SourceOrder::source(stream);
    GrowingLink tributary;
    tributary.edge = made.tributary;
    tributary.downstream = plan.link;
    tributary.stream = stream;
    tributary.mark = SourceOrder::opening(stream);
    tributary.length_m = plan.tributary_length_m;
    tributary.sidewall_slope = plan.draw.sidewall_slope;
    for (GrowingLink* link : {&lower, &upper, &tributary}) measure_polygons(tree.basin, *link);

    for (const Index inflow : parent.upstream) {
        if (inflow != none) tree.links[inflow].downstream = upper_number;
    }
    tree.links[plan.link] = lower;
    tree.links.insert(tree.links.end(), {upper, tributary});
    tree.sources.add_stream(parent.mark);
    tree.streams[parent.stream].length_m += lower.length_m + upper.length_m - parent.length_m;
    tree.streams.push_back({tributary.length_m, static_cast<Index>(tree.junctions.size())});
    tree.junctions.push_back({.vertex = tree.basin.origin(made.tributary),
                              .downstream = none,
                              .upstream = none,
                              .tributary = tributary_number,
                              .side = plan.draw.side,
                              .magnitude = plan.magnitude + 1,
                              .angle_rad = plan.angle_rad,
                              .turn_rad = plan.turn_rad});
    tree.length_m += lower.length_m + upper.length_m + tributary.length_m - parent.length_m;
}

}  // namespace thalweg::grow
