// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/knickpoints.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "thalweg/channel/main_streams.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::channel {

namespace {

struct ChiPoint {
    double chi_m, elevation_m;
};

/// Rows of each stream from the row it joins (or its base) up to its source, as compressed rows.
struct StreamRows {
    std::vector<Index> offset, row;

    StreamRows(const Profile& profile, const MainStreams& streams) : offset(streams.parent.size() + 1, 0) {
        for (const Index stream : streams.stream) ++offset[stream + 1];
        for (std::size_t s = 0; s < streams.outside.size(); ++s) offset[s + 1] += streams.outside[s] != none;
        for (std::size_t s = 1; s < offset.size(); ++s) offset[s] += offset[s - 1];
        row.resize(offset.back());
        std::vector<Index> next(offset.begin(), offset.end() - 1);
        for (std::size_t s = 0; s < streams.outside.size(); ++s) {
            if (streams.outside[s] != none) row[next[s]++] = streams.outside[s];
        }
        for (Index i = 0; i < profile.size(); ++i) row[next[streams.stream[i]]++] = i;
    }
};

/// > 0 where `b` lies below the line from `a` to `c`.
double below_line(const ChiPoint& a, const ChiPoint& b, const ChiPoint& c) {
    return (c.elevation_m - a.elevation_m) * (b.chi_m - a.chi_m) - (b.elevation_m - a.elevation_m) * (c.chi_m - a.chi_m);
}

/// The point of a stretch that stands highest above its lower convex hull, and by how much.
struct Highest {
    std::size_t at = 0;
    double above_m = 0;
};

/// `hull`: scratch. The ends lie on the hull.
Highest highest_above_hull(std::span<const ChiPoint> points, std::vector<std::size_t>& hull) {
    hull.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
        while (hull.size() >= 2 && !(below_line(points[hull[hull.size() - 2]], points[hull.back()], points[i]) > 0)) {
            hull.pop_back();
        }
        hull.push_back(i);
    }
    Highest highest;
    for (std::size_t h = 0; h + 1 < hull.size(); ++h) {
        const ChiPoint &a = points[hull[h]], &b = points[hull[h + 1]];
        const double rise = (b.elevation_m - a.elevation_m) / (b.chi_m - a.chi_m);
        for (std::size_t i = hull[h] + 1; i < hull[h + 1]; ++i) {
            const double above = points[i].elevation_m - (a.elevation_m + rise * (points[i].chi_m - a.chi_m));
            if (above > highest.above_m) highest = {i, above};
        }
    }
    return highest;
}

struct Found {
    std::size_t at;
    double prominence_m;
};

/// Places of a stream's knickpoints, from the mouth up.
std::vector<Found> find(std::span<const ChiPoint> points, double tolerance_m, std::vector<std::size_t>& hull) {
    std::vector<Found> found;
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, points.size() - 1}};
    while (!open.empty()) {
        const auto [first, last] = open.back();
        open.pop_back();
        const Highest highest = highest_above_hull(points.subspan(first, last - first + 1), hull);
        if (!(highest.above_m >= tolerance_m)) continue;
        found.push_back({first + highest.at, highest.above_m});
        open.push_back({first, first + highest.at});
        open.push_back({first + highest.at, last});
    }
    std::ranges::sort(found, {}, &Found::at);
    return found;
}

double mean_steepness(const ChiPoint& low, const ChiPoint& high, double scale) {
    return scale * (high.elevation_m - low.elevation_m) / (high.chi_m - low.chi_m);
}

}  // namespace

std::vector<Knickpoint> knickpoints(const Profile& profile, std::span<const double> chi_m, double theta,
                                    double reference_area_m2, double tolerance_m) {
    if (!(tolerance_m > 0)) throw Error("the prominence from which a knickpoint counts must be positive");
    const StreamRows streams(profile, main_streams(profile));
    const double scale = std::pow(reference_area_m2, theta);
    std::vector<Knickpoint> result;
    std::vector<ChiPoint> points;
    std::vector<std::size_t> hull;
    for (std::size_t s = 0; s + 1 < streams.offset.size(); ++s) {
        const auto rows = std::span(streams.row).subspan(streams.offset[s], streams.offset[s + 1] - streams.offset[s]);
        if (rows.size() < 3) continue;
        points.clear();
        for (const Index row : rows) points.push_back({chi_m[row], profile.elevation_m[row]});
        const auto found = find(points, tolerance_m, hull);
        for (std::size_t k = 0; k < found.size(); ++k) {
            const ChiPoint& here = points[found[k].at];
            const ChiPoint& low = points[k == 0 ? 0 : found[k - 1].at];
            const ChiPoint& high = points[k + 1 == found.size() ? points.size() - 1 : found[k + 1].at];
            result.push_back({.row = rows[found[k].at],
                              .prominence_m = found[k].prominence_m,
                              .ksn_above = mean_steepness(here, high, scale),
                              .ksn_below = mean_steepness(low, here, scale)});
        }
    }
    std::ranges::sort(result, {}, &Knickpoint::row);
    return result;
}

}  // namespace thalweg::channel
