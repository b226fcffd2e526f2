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
};
using CornerRing = std::vector<Corner>;

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
/// then north, west, south. Cells that touch at a corner only are kept apart.
class Tracer {
  public:
    Tracer(const Grid& grid, std::span<const Index> labels)
        : rows_(grid.rows), cols_(grid.cols), labels_(labels), seen_(labels.size(), 0) {}

    /// A side lies on an outline if the cell beyond it has another label, and is new if no ring has passed it.
    bool is_new_side(std::int64_t row, std::int64_t col, int heading) const {
        const auto [dy, dx] = beyond(heading);
        const std::int64_t node = row * cols_ + col;
        return !(seen_[node] & (1 << heading)) && !same(node, row + dy, col + dx);
    }

    CornerRing trace(std::int64_t row, std::int64_t col, int heading) {
        CornerRing ring;
        while (!(seen_[row * cols_ + col] & (1 << heading))) {
            const std::int64_t node = row * cols_ + col;
            seen_[node] |= static_cast<std::uint8_t>(1 << heading);
            const auto [ahead_y, ahead_x] = ahead(heading);
            const auto [right_y, right_x] = beyond(heading);
            const Corner corner = end_of_side(row, col, heading);
            if (!same(node, row + ahead_y, col + ahead_x)) {
                ring.push_back(corner);
                heading = (heading + 1) % 4;
            } else if (same(node, row + ahead_y + right_y, col + ahead_x + right_x)) {
                ring.push_back(corner);
                row += ahead_y + right_y;
                col += ahead_x + right_x;
                heading = (heading + 3) % 4;
            } else {
                row += ahead_y;
                col += ahead_x;
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

    static Corner end_of_side(std::int64_t row, std::int64_t col, int heading) {
        constexpr std::array<Step, 4> ends{{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};
        return {col + ends[heading][1], row + ends[heading][0]};
    }

    bool same(std::int64_t node, std::int64_t row, std::int64_t col) const {
        return row >= 0 && row < rows_ && col >= 0 && col < cols_ && labels_[row * cols_ + col] == labels_[node];
    }

    std::int64_t rows_;
    std::int64_t cols_;
    std::span<const Index> labels_;
    std::vector<std::uint8_t> seen_;  ///< per cell one bit per side
};

/// The largest piece of a ring that may pass a corner twice, cut where it does: a simple polygon.
CornerRing largest_simple_piece(const CornerRing& ring, std::int64_t cols) {
    std::unordered_map<std::int64_t, std::size_t> place;
    CornerRing path, best;
    const auto keep = [&](CornerRing piece) {
        if (best.empty() || doubled_area(piece) > doubled_area(best)) best = std::move(piece);
    };
    for (const Corner& corner : ring) {
        const std::int64_t key = corner.y * (cols + 1) + corner.x;
        if (const auto found = place.find(key); found != place.end()) {
            const std::size_t first = found->second;
            keep({path.begin() + static_cast<std::ptrdiff_t>(first), path.end()});
            for (std::size_t i = first; i < path.size(); ++i) place.erase(path[i].y * (cols + 1) + path[i].x);
            path.resize(first);
        }
        place[key] = path.size();
        path.push_back(corner);
    }
    keep(path);
    return best;
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

std::vector<Polygon> cell_outlines(const Raster& frame, std::span<const Index> labels, Index count) {
    check_labels(frame, labels);
    const Grid& grid = frame.grid;
    Tracer tracer(grid, labels);
    std::vector<CornerRing> best(count);
    std::vector<std::int64_t> largest(count, 0);
    for (Index node = 0; node < grid.size(); ++node) {
        const Index label = labels[node];
        if (label >= count) continue;
        // The first side met of an outer ring is a north side of its northernmost row: heading west.
        if (!tracer.is_new_side(grid.row(node), grid.col(node), 2)) continue;
        CornerRing ring = tracer.trace(grid.row(node), grid.col(node), 2);
        if (doubled_area(ring) <= 0) continue;
        ring = largest_simple_piece(ring, grid.cols);
        if (const std::int64_t area = doubled_area(ring); area > largest[label]) {
            largest[label] = area;
            best[label] = std::move(ring);
        }
    }
    std::vector<Polygon> outlines(count);
    for (Index label = 0; label < count; ++label) outlines[label] = on_map(best[label], frame.placement);
    return outlines;
}

Polygon cell_outline(const Raster& frame, std::span<const Index> labels, Index label) {
    check_labels(frame, labels);
    std::vector<Index> chosen(labels.size(), none);
    for (std::size_t i = 0; i < labels.size(); ++i) {
        if (labels[i] == label) chosen[i] = 0;
    }
    return cell_outlines(frame, chosen, 1).front();
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
