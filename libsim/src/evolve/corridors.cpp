// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "thalweg/core/error.hpp"
#include "thalweg/core/index.hpp"
#include "thalweg/evolve/tectonics.hpp"

namespace thalweg::evolve {
namespace {

/// The positions sorted into square bins, to find those near a place.
class Bins {
  public:
    explicit Bins(std::span<const Point> positions) : box_(bounding_box(positions)) {
        const double width = box_.high.x - box_.low.x, height = box_.high.y - box_.low.y;
        side_ = std::max({std::sqrt(width * height / static_cast<double>(positions.size())) * 2,
                          std::max(width, height) / 4096, std::numeric_limits<double>::min()});
        cols_ = static_cast<Index>(width / side_) + 1;
        rows_ = static_cast<Index>(height / side_) + 1;
        start_.assign(std::size_t{rows_} * cols_ + 1, 0);
        std::vector<Index> bin_of(positions.size());
        for (std::size_t i = 0; i < positions.size(); ++i) {
            bin_of[i] = row_of(positions[i].y) * cols_ + col_of(positions[i].x);
            ++start_[bin_of[i] + 1];
        }
        std::partial_sum(start_.begin(), start_.end(), start_.begin());
        std::vector<Index> next(start_.begin(), start_.end() - 1);
        member_.resize(positions.size());
        for (std::size_t i = 0; i < positions.size(); ++i) member_[next[bin_of[i]]++] = static_cast<Index>(i);
    }

    /// Calls visit(i) for every position in the bins that a box touches, and so for all those inside it.
    template <class Visit>
    void near(const Box& place, Visit visit) const {
        if (place.high.x < box_.low.x || place.high.y < box_.low.y) return;
        if (place.low.x > box_.high.x || place.low.y > box_.high.y) return;
        for (Index row = row_of(place.low.y); row <= row_of(place.high.y); ++row) {
            const Index first = start_[row * cols_ + col_of(place.low.x)];
            const Index last = start_[row * cols_ + col_of(place.high.x) + 1];
            for (Index at = first; at < last; ++at) visit(member_[at]);
        }
    }

  private:
    Index col_of(double x) const { return clamped((x - box_.low.x) / side_, cols_); }
    Index row_of(double y) const { return clamped((y - box_.low.y) / side_, rows_); }
    static Index clamped(double bin, Index count) {
        return static_cast<Index>(std::clamp(bin, 0.0, static_cast<double>(count - 1)));
    }

    Box box_;
    double side_;
    Index cols_, rows_;
    std::vector<Index> start_, member_;
};

double square_distance(const Point& a, const Point& b, const Point& p) {
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double square = dx * dx + dy * dy;
    const double at = square > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / square, 0.0, 1.0) : 0.0;
    const double ex = p.x - a.x - at * dx, ey = p.y - a.y - at * dy;
    return ex * ex + ey * ey;
}

/// Lowers the squared distance of every position within `reach` of the segment a–b. Long segments are taken in pieces,
/// whose boxes are little larger than the corridor.
void measure_segment(const Bins& bins, std::span<const Point> positions, const Point& a, const Point& b, double reach,
                     std::vector<double>& square) {
    const double pieces = std::max(1.0, std::ceil(std::hypot(b.x - a.x, b.y - a.y) / (4 * reach)));
    for (double k = 0; k < pieces; ++k) {
        const Point from{a.x + (b.x - a.x) * (k / pieces), a.y + (b.y - a.y) * (k / pieces)};
        const Point to{a.x + (b.x - a.x) * ((k + 1) / pieces), a.y + (b.y - a.y) * ((k + 1) / pieces)};
        const Box box{{std::min(from.x, to.x) - reach, std::min(from.y, to.y) - reach},
                      {std::max(from.x, to.x) + reach, std::max(from.y, to.y) + reach}};
        bins.near(box, [&](Index i) { square[i] = std::min(square[i], square_distance(a, b, positions[i])); });
    }
}

void check(const Corridor& corridor) {
    if (!(corridor.width_m > 0) || !std::isfinite(corridor.width_m)) {
        throw Error(fmt::format("painted lines need a positive width, not {} m", corridor.width_m));
    }
    if (!(corridor.value >= 0) || !std::isfinite(corridor.value)) {
        throw Error(fmt::format("painted lines need a value of zero or more, not {}", corridor.value));
    }
}

/// The corridor alone.
std::vector<double> painted(const Corridor& corridor, const Bins& bins, std::span<const Point> positions) {
    const double reach = corridor.width_m / 2;
    std::vector<double> values(positions.size(), std::numeric_limits<double>::infinity());
    for (const std::vector<Point>& line : corridor.lines) {
        for (std::size_t i = 0; i + 1 < line.size(); ++i) {
            measure_segment(bins, positions, line[i], line[i + 1], reach, values);
        }
    }
    for (double& value : values) {
        const double inside = std::max(0.0, 1 - value / (reach * reach));
        value = 1 + (corridor.value - 1) * inside * inside;
    }
    return values;
}

}  // namespace

std::vector<double> corridor_values(std::span<const Corridor> corridors, std::span<const Point> positions) {
    for (const Corridor& corridor : corridors) check(corridor);
    if (positions.empty()) return {};
    const Bins bins(positions);
    std::vector<double> lowest(positions.size(), 1.0), highest(positions.size(), 1.0);
    double largest = 1;
    for (const Corridor& corridor : corridors) {
        const std::vector<double> own = painted(corridor, bins, positions);
        largest = std::max(largest, corridor.value);
        for (std::size_t i = 0; i < own.size(); ++i) {
            lowest[i] = std::min(lowest[i], own[i]);
            highest[i] = std::max(highest[i], own[i]);
        }
    }
    for (std::size_t i = 0; i < lowest.size(); ++i) lowest[i] *= highest[i] / largest;
    return lowest;
}

}  // namespace thalweg::evolve
