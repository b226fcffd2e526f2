// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/io/polygonize.hpp"

#include <fmt/format.h>
#include <ogr_geometry.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "io/gdal_guard.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::io {
namespace {

/// A corner of the grid's cells: column and row counted from the north-west.
struct Corner {
    std::int64_t x;
    std::int64_t y;
    bool pinched;  ///< a cell of the same label lies diagonally across, so that rings may come by twice
};
using CornerRing = std::vector<Corner>;

struct CornerPart {
    CornerRing outer;
    std::vector<CornerRing> holes;
};
using CornerParts = std::vector<CornerPart>;

/// Twice the area, positive where the ring runs counter-clockwise on the map (rows grow southward).
std::int64_t doubled_area(const CornerRing& ring) {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Corner& a = ring[i];
        const Corner& b = ring[i + 1 < ring.size() ? i + 1 : 0];
        sum += b.x * a.y - a.x * b.y;
    }
    return sum;
}

/// Walks along the sides of cells of one label, the cell on the left. Heading 0 is east (along the cell's south side),
/// then north, west, south. Cells that touch at a corner only are kept apart. Cells passed are told their part.
class Tracer {
  public:
    Tracer(const Grid& grid, std::span<const Index> labels)
        : rows_(grid.rows), cols_(grid.cols), labels_(labels), seen_(labels.size(), 0), part_(labels.size(), none) {}

    /// A side lies on an outline if the cell beyond it has another label, and is new if no ring has passed it.
    bool is_new_side(Index node, int heading) const {
        const auto [dy, dx] = beyond(heading);
        return !(seen_[node] & (1 << heading)) && !same(node, node / cols_ + dy, node % cols_ + dx);
    }

    /// The part a cell belongs to, if its western neighbour has been asked; none if it is a part's first cell. A ring's
    /// highest sides are met first, so the ring west of a cell is known by the time the cell is reached.
    Index part_of(Index node) {
        if (part_[node] == none && node % cols_ > 0 && labels_[node - 1] == labels_[node])
            part_[node] = part_[node - 1];
        return part_[node];
    }

    CornerRing trace(Index start, int heading, Index part) {
        CornerRing ring;
        std::int64_t row = start / cols_;
        std::int64_t col = start % cols_;
        while (!(seen_[row * cols_ + col] & (1 << heading))) {
            const std::int64_t node = row * cols_ + col;
            seen_[node] |= static_cast<std::uint8_t>(1 << heading);
            part_[node] = part;
            const auto [ahead_y, ahead_x] = ahead(heading);
            const auto [right_y, right_x] = beyond(heading);
            const auto [y, x] = end_of_side(row, col, heading);
            const bool diagonal = same(node, row + ahead_y + right_y, col + ahead_x + right_x);
            if (!same(node, row + ahead_y, col + ahead_x)) {
                ring.push_back({x, y, diagonal});
                heading = (heading + 1) % 4;
                continue;
            }
            row += ahead_y;
            col += ahead_x;
            if (diagonal) {
                ring.push_back({x, y, false});
                row += right_y;
                col += right_x;
                heading = (heading + 3) % 4;
            }
        }
        return ring;
    }

  private:
    using Step = std::array<std::int64_t, 2>;  // row, column
    static Step ahead(int heading) {
        constexpr std::array<Step, 4> steps{{{0, 1}, {-1, 0}, {0, -1}, {1, 0}}};
        return steps[heading];
    }
    static Step beyond(int heading) { return ahead((heading + 3) % 4); }

    static Step end_of_side(std::int64_t row, std::int64_t col, int heading) {
        constexpr std::array<Step, 4> ends{{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};
        return {row + ends[heading][0], col + ends[heading][1]};
    }

    bool same(std::int64_t node, std::int64_t row, std::int64_t col) const {
        return row >= 0 && row < rows_ && col >= 0 && col < cols_ && labels_[row * cols_ + col] == labels_[node];
    }

    std::int64_t rows_;
    std::int64_t cols_;
    std::span<const Index> labels_;
    std::vector<std::uint8_t> seen_;  ///< per cell one bit per side
    std::vector<Index> part_;         ///< per cell, filled row by row and along rings
};

/// Cuts a ring where it passes a corner again. Of an outer ring come an outer ring and the holes that opened to the
/// outside at a corner; of a hole come holes: the cells hang together, so no piece is a second outside.
std::vector<CornerRing> simple_pieces(const CornerRing& ring, std::int64_t cols) {
    std::unordered_map<std::int64_t, std::size_t> place;
    std::vector<CornerRing> pieces;
    CornerRing path;
    for (const Corner& corner : ring) {
        const auto key = [&](const Corner& c) { return c.y * (cols + 1) + c.x; };
        if (const auto found = place.find(key(corner)); corner.pinched && found != place.end()) {
            const std::size_t first = found->second;
            for (std::size_t i = first; i < path.size(); ++i) {
                if (path[i].pinched) place.erase(key(path[i]));
            }
            pieces.emplace_back(path.begin() + static_cast<std::ptrdiff_t>(first), path.end());
            path.resize(first);
        }
        if (corner.pinched) place[key(corner)] = path.size();
        path.push_back(corner);
    }
    pieces.push_back(std::move(path));
    return pieces;
}

/// The parts of each label, row by row. Every ring has sides to the north or south, so these are all that is looked at.
std::vector<CornerParts> trace_parts(const Grid& grid, std::span<const Index> labels, Index count) {
    constexpr int along_north_side = 2;
    constexpr int along_south_side = 0;
    Tracer tracer(grid, labels);
    std::vector<CornerParts> parts(count);
    for (Index node = 0; node < grid.size(); ++node) {
        if (labels[node] >= count) continue;
        CornerParts& own = parts[labels[node]];
        Index part = tracer.part_of(node);
        if (part == none) {
            part = static_cast<Index>(own.size());
            own.emplace_back();
        }
        for (const int heading : {along_north_side, along_south_side}) {
            if (!tracer.is_new_side(node, heading)) continue;
            for (CornerRing& piece : simple_pieces(tracer.trace(node, heading, part), grid.cols)) {
                if (doubled_area(piece) > 0) {
                    own[part].outer = std::move(piece);
                } else {
                    own[part].holes.push_back(std::move(piece));
                }
            }
        }
    }
    return parts;
}

Polygon on_map(const CornerRing& ring, const Placement& placement) {
    Polygon polygon;
    for (const Corner& corner : ring) {
        polygon.push_back({placement.west + static_cast<double>(corner.x) * placement.cell_width,
                           placement.north - static_cast<double>(corner.y) * placement.cell_height});
    }
    return polygon;
}

void check_labels(const Raster& frame, std::span<const Index> labels) {
    if (labels.size() == frame.grid.size()) return;
    throw Error(fmt::format("a grid of {} cells cannot be outlined by {} labels", frame.grid.size(), labels.size()));
}

double ring_area(const Polygon& ring) {
    double sum = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Point& a = ring[i];
        const Point& b = ring[i + 1 < ring.size() ? i + 1 : 0];
        sum += (a.x - ring[0].x) * (b.y - ring[0].y) - (b.x - ring[0].x) * (a.y - ring[0].y);
    }
    return sum / 2;
}

}  // namespace

std::vector<MultiPolygon> cell_outlines(const Raster& frame, std::span<const Index> labels, Index count) {
    check_labels(frame, labels);
    std::vector<MultiPolygon> outlines(count);
    const std::vector<CornerParts> traced = trace_parts(frame.grid, labels, count);
    for (Index label = 0; label < count; ++label) {
        for (const CornerPart& part : traced[label]) {
            PolygonPart& placed = outlines[label].emplace_back();
            placed.outer = on_map(part.outer, frame.placement);
            for (const CornerRing& hole : part.holes) placed.holes.push_back(on_map(hole, frame.placement));
        }
    }
    return outlines;
}

Polygon cell_outline(const Raster& frame, std::span<const Index> labels, Index label) {
    check_labels(frame, labels);
    std::vector<Index> chosen(labels.size(), none);
    for (std::size_t i = 0; i < labels.size(); ++i) {
        if (labels[i] == label) chosen[i] = 0;
    }
    const CornerParts parts = trace_parts(frame.grid, chosen, 1).front();
    const auto smaller = [](const CornerPart& a, const CornerPart& b) {
        return doubled_area(a.outer) < doubled_area(b.outer);
    };
    const auto largest = std::max_element(parts.begin(), parts.end(), smaller);
    return largest == parts.end() ? Polygon{} : on_map(largest->outer, frame.placement);
}

Polygon simplify(const Polygon& polygon, double tolerance) {
    const GdalGuard gdal;
    OGRPolygon shape;
    auto* ring = new OGRLinearRing;
    for (const Point& p : polygon) ring->addPoint(p.x, p.y);
    ring->closeRings();
    shape.addRingDirectly(ring);
    const std::unique_ptr<OGRGeometry> simple(shape.SimplifyPreserveTopology(tolerance));
    if (!simple || wkbFlatten(simple->getGeometryType()) != wkbPolygon || simple->IsEmpty()) {
        throw Error(fmt::format("an outline of {} vertices cannot be simplified{}", polygon.size(), because(gdal)));
    }
    const OGRLinearRing* outer = simple->toPolygon()->getExteriorRing();
    Polygon result;
    for (int i = 0; i + 1 < outer->getNumPoints(); ++i) result.push_back({outer->getX(i), outer->getY(i)});
    if (ring_area(result) < 0) std::reverse(result.begin(), result.end());
    return result;
}

}  // namespace thalweg::io
