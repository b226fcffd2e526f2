// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/sides.hpp"

#include <algorithm>
#include <numeric>

#include "thalweg/core/error.hpp"

namespace thalweg::surface {
namespace {

struct Side {
    Index high;  ///< the end with the higher number
    Index triangle;
    std::uint8_t side;
    bool upward;  ///< it runs from the lower number to the higher

    friend bool operator<(const Side& a, const Side& b) {
        return a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
    }
};

/// Calls visit(low, Side) for every side of every triangle.
template <class Visit>
void visit_sides(std::span<const std::array<Index, 3>> triangles, Visit visit) {
    for (Index t = 0; t < triangles.size(); ++t) {
        for (std::uint8_t k = 0; k < 3; ++k) {
            const Index from = triangles[t][(k + 1) % 3], to = triangles[t][(k + 2) % 3];
            visit(std::min(from, to), Side{std::max(from, to), t, k, from < to});
        }
    }
}

}  // namespace

TriangleSides::TriangleSides(Index vertices, std::span<const std::array<Index, 3>> triangles)
    : across_(triangles.size(), {none, none, none}) {
    std::vector<Index> start(std::size_t{vertices} + 1, 0);
    visit_sides(triangles, [&](Index low, const Side&) { ++start[low + 1]; });
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<Side> sides(start.back());
    std::vector<Index> next(start.begin(), start.end() - 1);
    visit_sides(triangles, [&](Index low, const Side& side) { sides[next[low]++] = side; });
    for (Index low = 0; low < vertices; ++low) {
        std::sort(sides.begin() + start[low], sides.begin() + start[low + 1]);
        for (Index i = start[low]; i + 1 < start[low + 1]; ++i) {
            const Side &a = sides[i], &b = sides[i + 1];
            if (a.high != b.high) continue;
            const bool third = i + 2 < start[low + 1] && sides[i + 2].high == a.high;
            if (third || a.upward == b.upward) throw Error("triangles overlap: they do not lie side by side");
            across_[a.triangle][a.side] = b.triangle;
            across_[b.triangle][b.side] = a.triangle;
        }
    }
}

}  // namespace thalweg::surface
