// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/divides.hpp"

#include <algorithm>
#include <cmath>

#include "channel/directions.hpp"
#include "channel/valley_map.hpp"
#include "thalweg/core/statistics.hpp"

namespace thalweg::channel {
namespace {

constexpr std::size_t least_cells = 6;

/// The three links at a junction, counter-clockwise from the one below, and their directions.
struct Star {
    std::array<Index, 3> link;
    std::array<Point, 3> direction;
};

Star star_at(const StreamNetwork& network, const OffsetOf& offset, const JunctionInflows& in, Index below,
             double reach_m) {
    const auto up = [&](Index link) { return upstream_direction(network.nodes_of(link), offset, reach_m); };
    Star star{{below, in.link[0], in.link[1]},
              {downstream_direction(network.nodes_of(below), offset, reach_m), up(in.link[0]), up(in.link[1])}};
    if (turn(star.direction[0], star.direction[1]) > turn(star.direction[0], star.direction[2])) {
        std::swap(star.link[1], star.link[2]);
        std::swap(star.direction[1], star.direction[2]);
    }
    return star;
}

/// A cell near a junction.
struct NearCell {
    Point away;
    Index valley;
};

/// Cells within the reach of a junction that drain to a link. What drains to the junction itself is of both sides.
std::vector<NearCell> cells_near(const Grid& grid, const OffsetOf& offset, std::span<const Index> foot,
                                 std::span<const Index> link_of, Index center, double reach_m) {
    const Index row = grid.row(center), col = grid.col(center);
    const double height =
        grid.north_south.empty() ? grid.east_west[row] : grid.north_south[std::min(row, grid.rows - 2)];
    const auto rows = static_cast<Index>(reach_m / height) + 1,
               cols = static_cast<Index>(reach_m / grid.east_west[row]) + 1;
    std::vector<NearCell> cells;
    for (Index r = row - std::min(row, rows); r <= std::min(grid.rows - 1, row + rows); ++r) {
        for (Index c = col - std::min(col, cols); c <= std::min(grid.cols - 1, col + cols); ++c) {
            const Index node = r * grid.cols + c;
            if (foot[node] == none || foot[node] == center) continue;
            const Point away = offset(center, node);
            if (std::hypot(away.x, away.y) <= reach_m) cells.push_back({away, link_of[foot[node]]});
        }
    }
    return cells;
}

/// A cell between two links, by its direction from the first one.
struct CellInSector {
    double angle_rad;
    bool is_of_first;
};

/// The direction that leaves the fewest cells on the wrong side.
double parting_angle(std::vector<CellInSector> cells, double sector) {
    std::sort(cells.begin(), cells.end(),
              [](const CellInSector& a, const CellInSector& b) { return a.angle_rad < b.angle_rad; });
    // Of a divide before the first cell the first link's are all wrong; each cell that it passes changes that by one.
    long wrong = 0, least = 0;
    double first = 0, last = cells.front().angle_rad;  // of the best directions
    for (std::size_t i = 0; i < cells.size(); ++i) {
        wrong += cells[i].is_of_first ? -1 : 1;
        const double next = i + 1 < cells.size() ? cells[i + 1].angle_rad : sector;
        if (wrong > least || !(next > cells[i].angle_rad)) continue;
        if (wrong < least) first = cells[i].angle_rad;
        least = wrong;
        last = next;
    }
    return (first + last) / 2;
}

}  // namespace

std::vector<JunctionDivide> junction_divides(const Grid& grid, const terrain::FlowGraph& graph,
                                             const StreamNetwork& network, double reach_m) {
    const auto offset = offsets(grid);
    const auto link_of = link_of_nodes(network, graph.size());
    const std::vector<Index> foot = valleys(graph, offset, link_of).foot;
    const auto inflows_of = junction_inflows(network);
    std::vector<JunctionDivide> found;
    for (Index below = 0; below < network.size(); ++below) {
        const JunctionInflows& in = inflows_of[below];
        if (in.count != 2) continue;
        const double near =
            std::min({reach_m, network.length_m[below], network.length_m[in.link[0]], network.length_m[in.link[1]]});
        const Star star = star_at(network, offset, in, below, near);
        const auto cells = cells_near(grid, offset, foot, link_of, network.nodes_of(below).front(), near);
        for (std::size_t i = 0; i < 3; ++i) {
            const std::array links{star.link[i], star.link[(i + 1) % 3]};
            const double sector = turn(star.direction[i], star.direction[(i + 1) % 3]);
            std::vector<CellInSector> between;
            for (const NearCell& cell : cells) {
                const double angle = turn(star.direction[i], cell.away);
                if (angle > sector || (cell.valley != links[0] && cell.valley != links[1])) continue;
                between.push_back({angle, cell.valley == links[0]});
            }
            if (between.size() < least_cells) continue;
            found.push_back({below, links, sector, parting_angle(std::move(between), sector)});
        }
    }
    return found;
}

DividesByPlace divide_angles(std::span<const JunctionDivide> divides, const MainStreams& streams) {
    struct Sample {
        std::vector<double> share, angle, sector;
    };
    Sample across, below, above;
    const auto is_of_stream = [&](Index link, Index link_below) {
        return streams.stream[link] == streams.stream[link_below];
    };
    for (const JunctionDivide& d : divides) {
        const auto [first, second] = d.links;
        const bool is_below_first = first == d.below, is_below_second = second == d.below;
        const bool is_between_inflows = !is_below_first && !is_below_second;
        // From the link below, or from the tributary: which of the two that is.
        const bool from_first = is_between_inflows ? !is_of_stream(first, d.below) : is_below_first;
        const Index inflow = is_below_first ? second : first;
        Sample& sample = is_between_inflows ? above : is_of_stream(inflow, d.below) ? across : below;
        const double angle = from_first ? d.angle_rad : d.sector_rad - d.angle_rad;
        sample.share.push_back(angle / d.sector_rad);
        sample.angle.push_back(angle);
        sample.sector.push_back(d.sector_rad);
    }
    const auto angles = [](const Sample& s) {
        return DivideAngles{.share = uniform_draw(s.share),
                            .mean_rad = mean(s.angle),
                            .sd_rad = standard_deviation(s.angle),
                            .sector_mean_rad = mean(s.sector)};
    };
    return {.across = angles(across), .below = angles(below), .above = angles(above)};
}

}  // namespace thalweg::channel
