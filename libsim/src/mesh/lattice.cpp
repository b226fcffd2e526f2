// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "mesh/constrained.hpp"
#include "mesh/disk_grid.hpp"
#include "mesh/fill.hpp"

namespace thalweg::mesh {
namespace {

struct Gap {
    double length;  ///< of a side
    double pieces;
};

/// One more piece for the side with the longest pieces, the first of equals.
void split_widest(std::vector<std::vector<Gap>>& gaps) {
    Gap* widest = &gaps[0][0];
    for (std::vector<Gap>& ring : gaps) {
        for (Gap& gap : ring) {
            if (gap.length / gap.pieces > widest->length / widest->pieces) widest = &gap;
        }
    }
    ++widest->pieces;
}

Polygon divide_ring(const Polygon& ring, const std::vector<Gap>& gaps) {
    Polygon divided;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Point& a = ring[i];
        const Point& b = ring[(i + 1) % ring.size()];
        for (double k = 0; k < gaps[i].pieces; ++k) {
            const double at = k / gaps[i].pieces;
            divided.push_back({a.x + (b.x - a.x) * at, a.y + (b.y - a.y) * at});
        }
    }
    return divided;
}

/// Rows and columns of a lattice over a bounding box.
struct Lattice {
    Point low;
    double columns, rows;
    Point step;
    bool hexagonal;

    Point at(double row, double column) const {
        const bool shifted = hexagonal && std::fmod(row, 2) == 1;
        return {low.x + (column + (shifted ? 0.5 : 0)) * step.x, low.y + row * step.y};
    }
};

Lattice lattice_over(const Polygon& outline, PointPattern pattern, double spacing, double stretch) {
    Point low = outline.front();
    Point high = low;
    for (const Point& p : outline) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    const bool hexagonal = pattern == PointPattern::hexagonal;
    const double row_height = spacing / stretch * (hexagonal ? std::sqrt(0.75) : 1);
    const double columns = std::max(1.0, std::round((high.x - low.x) / (spacing * stretch)));
    const double rows = std::max(1.0, std::round((high.y - low.y) / row_height));
    return {low, columns, rows, {(high.x - low.x) / columns, (high.y - low.y) / rows}, hexagonal};
}

}  // namespace

double pieces_of_side(const Point& a, const Point& b, const Point& step) {
    return std::max(1.0, std::ceil(std::hypot((b.x - a.x) / step.x, (b.y - a.y) / step.y) - 1e-9));
}

std::vector<Polygon> divide_rings(const Rings& rings, const Point& step, int extra) {
    std::vector<std::vector<Gap>> gaps;
    for (const Polygon& ring : rings) {
        std::vector<Gap>& sides = gaps.emplace_back();
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const Point& a = ring[i];
            const Point& b = ring[(i + 1) % ring.size()];
            sides.push_back({std::hypot(b.x - a.x, b.y - a.y), pieces_of_side(a, b, step)});
        }
    }
    for (; extra > 0; --extra) split_widest(gaps);
    std::vector<Polygon> divided;
    for (std::size_t ring = 0; ring < rings.size(); ++ring) divided.push_back(divide_ring(rings[ring], gaps[ring]));
    return conforming_rings(divided);
}

PointSet points_on_rings(const std::vector<Polygon>& rings) {
    PointSet set{.points = {}, .outline_count = 0, .hole_start = {}};
    for (std::size_t ring = 0; ring < rings.size(); ++ring) {
        if (ring > 0) set.hole_start.push_back(static_cast<Index>(set.points.size()));
        set.points.insert(set.points.end(), rings[ring].begin(), rings[ring].end());
    }
    set.outline_count = static_cast<Index>(set.points.size());
    return set;
}

PointSet fill_lattice(const Rings& rings, PointPattern pattern, double spacing, double stretch, int extra) {
    const Lattice lattice = lattice_over(rings.front(), pattern, spacing, stretch);
    const Point on_rings = lattice.hexagonal ? Point{lattice.step.x, lattice.step.x} : lattice.step;
    PointSet set = points_on_rings(divide_rings(rings, on_rings, extra));
    DiskGrid grid(rings, 0.7072 * std::max(on_rings.x, on_rings.y));
    grid.add_outline(set.points);
    for (double row = 0; row <= lattice.rows; ++row) {
        for (double column = 0; column <= lattice.columns; ++column) {
            const Point place = lattice.at(row, column);
            if (grid.has_room(place)) grid.add(place);
        }
    }
    set.points = grid.points();
    return set;
}

}  // namespace thalweg::mesh
