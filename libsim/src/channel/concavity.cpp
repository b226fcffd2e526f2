// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/concavity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "thalweg/channel/main_streams.hpp"
#include "thalweg/core/random.hpp"

namespace thalweg::channel {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double theta_step = 0.025;
constexpr int theta_count = 61;  // 0 to 1.5
constexpr double reference_area_m2 = 1e6;

/// Rows: θ. What a block (a river or a tributary) adds to the misfit, and what that is divided by at the end.
struct MisfitTable {
    std::vector<std::vector<double>> misfit, weight;

    Index blocks() const { return misfit.empty() ? 0 : static_cast<Index>(misfit.front().size()); }

    /// Those that say anything at all of θ: a river without tributaries has no disorder, whatever θ is.
    std::vector<Index> deciding() const {
        std::vector<Index> found;
        for (Index block = 0; block < blocks(); ++block) {
            if (std::ranges::any_of(misfit, [&](const auto& row) { return row[block] > 0; })) found.push_back(block);
        }
        return found;
    }
};

/// Σ times·misfit / Σ times·weight at each θ; a θ without weight is infinitely bad.
std::vector<double> mean_misfits(const MisfitTable& table, std::span<const double> times) {
    std::vector<double> means;
    for (int i = 0; i < theta_count; ++i) {
        double misfit = 0, weight = 0;
        for (std::size_t block = 0; block < times.size(); ++block) {
            misfit += times[block] * table.misfit[i][block];
            weight += times[block] * table.weight[i][block];
        }
        means.push_back(weight > 0 ? misfit / weight : std::numeric_limits<double>::infinity());
    }
    return means;
}

constexpr double last_theta = (theta_count - 1) * theta_step;

/// Where the parabola through the least value and its two neighbours has its vertex; the first or the last θ where the
/// least is there; NaN where no θ has a misfit.
double least_at(std::span<const double> misfit) {
    const auto least = std::ranges::min_element(misfit) - misfit.begin();
    if (!std::isfinite(misfit[least])) return nan;
    if (least == 0 || least + 1 == theta_count) return static_cast<double>(least) * theta_step;
    const double left = misfit[least - 1], middle = misfit[least], right = misfit[least + 1];
    const double curvature = left - 2 * middle + right;
    const double shift = curvature > 0 && std::isfinite(curvature) ? (left - right) / (2 * curvature) : 0;
    return (static_cast<double>(least) + shift) * theta_step;
}

/// NaN at the first and the last θ, beyond which the least may lie.
double inside(double theta) { return theta > 0 && theta < last_theta ? theta : nan; }

/// Half the width of the interval in units of the normal law's, so that error and interval never say two things (the
/// resamples of few tributaries have outliers); NaN where an end lies at the first or last θ and may lie beyond.
double error_of(const std::array<double, 2>& interval95) {
    constexpr double normal_half_width = 1.959964;
    return 0.5 * (inside(interval95[1]) - inside(interval95[0])) / normal_half_width;
}

/// Blocks that are drawn, of so many: those that decide.
struct Blocks {
    Index count = 0;
    std::vector<Index> drawn;
};

/// Gives the estimate its interval and error; `theta_of(times)` is the estimate when each block counts as often as it
/// was drawn. An interval with the estimate on its end, as where one block of a few decides all, is none.
template <class ThetaOf>
void add_bootstrap(Estimate& estimate, const Blocks& blocks, const ConcavityOptions& options, std::uint32_t stream,
                   ThetaOf theta_of, Index resamples) {
    const auto many = static_cast<Index>(blocks.drawn.size());
    if (std::isnan(estimate.value) || many < options.smallest_sample) return;
    Random random(options.seed, stream);
    std::vector<double> values;
    for (Index resample = 0; resample < resamples; ++resample) {
        std::vector<double> times(blocks.count, 0);
        for (Index draw = 0; draw < many; ++draw) ++times[blocks.drawn[random.below(many)]];
        const double theta = theta_of(times);
        if (!std::isnan(theta)) values.push_back(theta);
    }
    const std::array<double, 2> interval{quantile(values, 0.025), quantile(values, 0.975)};
    if (!(interval[0] < estimate.value && estimate.value < interval[1])) return;
    estimate.interval95 = interval;
    estimate.standard_error = error_of(interval);
}

/// Sums over one river from which the straightness of elevation over χ follows.
struct Sums {
    double nodes = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;

    /// nodes·(1 − R²); 0 where nothing can be told
    double misfit() const {
        const double sxx = xx - x * x / nodes, sxy = xy - x * y / nodes, syy = yy - y * y / nodes;
        return sxx > 0 && syy > 0 ? nodes * std::max(0.0, 1 - sxy * sxy / (sxx * syy)) : 0;
    }
};

/// What the three rules need of the rivers that count, the same for every θ.
struct Rivers {
    std::vector<Index> row;        ///< rows of the profile that count
    std::vector<double> height_m;  ///< by row, above the river's base, so that sums keep their digits
    std::vector<Index> river;      ///< by row: number of its river among those that count, `none` for the others
    Index count = 0;
    MainStreams streams;
    std::vector<Index> tributary;  ///< by row: number of the tributary of a trunk it belongs to, `none` on the trunk
    Index tributaries = 0;
    bool many = false;             ///< enough rivers with tributaries to resample them; else their tributaries are
    std::vector<Index> by_height;  ///< rows that count, river by river, upwards
    std::vector<Index> begin;      ///< count + 1: where each river begins in it
};

std::vector<Index> river_sizes(const Profile& profile) {
    std::vector<Index> sizes;
    for (const Index river : profile.river) {
        if (river >= sizes.size()) sizes.resize(river + 1, 0);
        ++sizes[river];
    }
    return sizes;
}

/// Returns how many rivers have any.
Index number_tributaries(const Profile& profile, Rivers& r) {
    r.tributary.assign(profile.size(), none);
    std::vector<std::uint8_t> joined(r.count, 0);
    for (const Index i : r.row) {
        const Index stream = r.streams.stream[i];
        if (r.streams.parent[stream] == none) continue;
        const Index below = r.tributary[profile.below[i]];
        r.tributary[i] = below == none ? r.tributaries++ : below;
        joined[r.river[i]] = 1;
    }
    return static_cast<Index>(std::ranges::count(joined, 1));
}

void sort_by_height(const Profile& profile, Rivers& r) {
    r.begin.assign(r.count + 1, 0);
    for (const Index i : r.row) ++r.begin[r.river[i] + 1];
    std::partial_sum(r.begin.begin(), r.begin.end(), r.begin.begin());
    std::vector<Index> next(r.begin.begin(), r.begin.end() - 1);
    r.by_height.resize(r.row.size());
    for (const Index i : r.row) r.by_height[next[r.river[i]]++] = i;
    const auto lower = [&](Index a, Index b) {
        return profile.elevation_m[a] != profile.elevation_m[b] ? profile.elevation_m[a] < profile.elevation_m[b]
                                                                : a < b;
    };
    for (Index river = 0; river < r.count; ++river) {
        std::sort(r.by_height.begin() + r.begin[river], r.by_height.begin() + r.begin[river + 1], lower);
    }
}

Rivers rivers_of(const Profile& profile, const ConcavityOptions& options) {
    Rivers r;
    const auto sizes = river_sizes(profile);
    std::vector<Index> number(sizes.size(), none);
    for (std::size_t river = 0; river < sizes.size(); ++river) {
        if (sizes[river] >= options.smallest_river) number[river] = r.count++;
    }
    r.height_m.assign(profile.size(), 0);
    r.river.assign(profile.size(), none);
    for (Index i = 0; i < profile.size(); ++i) {
        const Index below = profile.below[i];
        if (below != none) r.height_m[i] = r.height_m[below] + (profile.elevation_m[i] - profile.elevation_m[below]);
        r.river[i] = number[profile.river[i]];
        if (r.river[i] != none) r.row.push_back(i);
    }
    r.streams = main_streams(profile);
    r.many = number_tributaries(profile, r) >= options.smallest_sample;
    sort_by_height(profile, r);
    return r;
}

void add_linearity(const Rivers& r, std::span<const double> chi_m, MisfitTable& table) {
    std::vector<Sums> sums(r.count);
    for (const Index i : r.row) {
        Sums& sum = sums[r.river[i]];
        const double x = chi_m[i], y = r.height_m[i];
        ++sum.nodes;
        sum.x += x;
        sum.y += y;
        sum.xx += x * x;
        sum.xy += x * y;
        sum.yy += y * y;
    }
    auto& misfit = table.misfit.emplace_back();
    for (const Sums& sum : sums) misfit.push_back(sum.misfit());
    table.weight.emplace_back(r.count, 1.0);
}

/// χ and height of each river's trunk, from its base up.
struct Trunks {
    std::vector<std::vector<Index>> row;  ///< by river
};

Trunks trunks_of(const Rivers& r) {
    Trunks trunks{.row = std::vector<std::vector<Index>>(r.count)};
    for (const Index i : r.row) {
        if (r.tributary[i] == none) trunks.row[r.river[i]].push_back(i);
    }
    return trunks;
}

/// Height of the trunk at χ, linear between its nodes; NaN beyond its head.
double trunk_height(const std::vector<Index>& trunk, const Rivers& r, std::span<const double> chi_m, double at) {
    const auto above =
        std::upper_bound(trunk.begin(), trunk.end(), at, [&](double x, Index row) { return x < chi_m[row]; });
    if (above == trunk.end()) return chi_m[trunk.back()] == at ? r.height_m[trunk.back()] : nan;
    if (above == trunk.begin()) return nan;
    const Index low = *(above - 1), high = *above;
    const double share = (at - chi_m[low]) / (chi_m[high] - chi_m[low]);
    return r.height_m[low] + share * (r.height_m[high] - r.height_m[low]);
}

void add_collinearity(const Rivers& r, const Trunks& trunks, std::span<const double> chi_m, MisfitTable& table) {
    const Index blocks = r.many ? r.count : r.tributaries;
    auto& misfit = table.misfit.emplace_back(blocks, 0.0);
    auto& weight = table.weight.emplace_back(blocks, 0.0);
    for (const Index i : r.row) {
        if (r.tributary[i] == none) continue;
        const Index block = r.many ? r.river[i] : r.tributary[i];
        const double difference = r.height_m[i] - trunk_height(trunks.row[r.river[i]], r, chi_m, chi_m[i]);
        if (std::isnan(difference)) continue;
        misfit[block] += difference * difference;
        ++weight[block];
    }
}

/// The disorder of each river by θ, and χ of the nodes on which that of few rivers is resampled.
struct Disorder {
    MisfitTable by_river;       ///< nodes·disorder, and nodes
    std::vector<Index> sample;  ///< rows that count, in the order of `by_height`
    std::vector<std::vector<double>> chi_m;
};

/// (Σ|χ_(i+1) − χ_i| − range)/range of `count` nodes, upwards; 0 where there is no range.
template <class ChiOf>
double disorder_of(std::size_t count, ChiOf chi_of) {
    if (count < 2) return 0;
    double path = 0, before = chi_of(0), lowest = before, highest = before;
    for (std::size_t i = 1; i < count; ++i) {
        const double x = chi_of(i);
        path += std::abs(x - before);
        before = x;
        lowest = std::min(lowest, x);
        highest = std::max(highest, x);
    }
    const double range = highest - lowest;
    return range > 0 ? (path - range) / range : 0;
}

void add_disorder(const Rivers& r, std::span<const double> chi_m, Disorder& d) {
    auto& misfit = d.by_river.misfit.emplace_back();
    auto& weight = d.by_river.weight.emplace_back();
    for (Index river = 0; river < r.count; ++river) {
        const Index begin = r.begin[river], nodes = r.begin[river + 1] - begin;
        misfit.push_back(nodes * disorder_of(nodes, [&](std::size_t i) { return chi_m[r.by_height[begin + i]]; }));
        weight.push_back(nodes);
    }
    auto& sampled = d.chi_m.emplace_back();
    for (const Index row : d.sample) sampled.push_back(chi_m[row]);
}

Disorder disorder_sample(const Rivers& r, Index most) {
    Disorder d;
    if (r.many) return d;
    const std::size_t stride = std::max<std::size_t>(1, (r.by_height.size() + most - 1) / most);
    for (std::size_t i = 0; i < r.by_height.size(); i += stride) d.sample.push_back(r.by_height[i]);
    return d;
}

/// The least disorder of the sample when only the drawn tributaries (and the trunks) are there.
double disorder_theta(const Rivers& r, const Disorder& d, std::span<const double> times) {
    std::vector<Index> kept, end;  // places in the sample, and where each river ends among them
    for (std::size_t i = 0; i < d.sample.size(); ++i) {
        const Index tributary = r.tributary[d.sample[i]];
        if (tributary == none || times[tributary] > 0) kept.push_back(static_cast<Index>(i));
        const bool last = i + 1 == d.sample.size() || r.river[d.sample[i + 1]] != r.river[d.sample[i]];
        if (last) end.push_back(static_cast<Index>(kept.size()));
    }
    std::vector<double> misfit;
    for (const auto& chi_m : d.chi_m) {
        double sum = 0;
        Index begin = 0;
        for (const Index until : end) {
            const Index nodes = until - begin;
            sum += nodes * disorder_of(nodes, [&](std::size_t i) { return chi_m[kept[begin + i]]; });
            begin = until;
        }
        misfit.push_back(sum);
    }
    return least_at(misfit);
}

/// χ for θ = 0, step, 2·step, …: each next step to the receiver is the last one times (A0/A)^step.
class ChiLadder {
  public:
    explicit ChiLadder(const Profile& profile) : profile_(profile), step_(profile.length_m), chi_m_(profile.size(), 0) {
        for (const double area : profile.area_m2) ratio_.push_back(std::pow(reference_area_m2 / area, theta_step));
        integrate();
    }
    void climb() {
        for (std::size_t i = 0; i < step_.size(); ++i) step_[i] *= ratio_[i];
        integrate();
    }
    std::span<const double> chi_m() const { return chi_m_; }

  private:
    void integrate() {
        for (Index i = 0; i < profile_.size(); ++i) {
            const Index below = profile_.below[i];
            if (below != none) chi_m_[i] = chi_m_[below] + step_[i];
        }
    }
    const Profile& profile_;
    std::vector<double> step_, ratio_, chi_m_;
};

/// The θ of least mean misfit of a table, all blocks once.
double least_of(const MisfitTable& table) {
    return least_at(mean_misfits(table, std::vector<double>(table.blocks(), 1)));
}

Estimate value_alone(double theta) { return {inside(theta), nan, {nan, nan}}; }

/// By a table whose blocks are resampled.
Estimate estimate_of(const MisfitTable& table, const ConcavityOptions& options, std::uint32_t stream) {
    if (table.blocks() == 0) return value_alone(nan);
    Estimate e = value_alone(least_of(table));
    const auto theta_of = [&](const std::vector<double>& times) { return least_at(mean_misfits(table, times)); };
    add_bootstrap(e, {table.blocks(), table.deciding()}, options, stream, theta_of, options.resamples);
    return e;
}

Estimate disorder_estimate(const Rivers& r, const Disorder& d, const ConcavityOptions& options) {
    if (r.many || r.tributaries == 0) return estimate_of(d.by_river, options, 2);
    constexpr Index fewer = 5;  // each resample costs 61 passes over the sample
    Estimate e = value_alone(least_of(d.by_river));
    std::vector<Index> all(r.tributaries);
    std::iota(all.begin(), all.end(), 0);
    const auto theta_of = [&](const std::vector<double>& times) { return disorder_theta(r, d, times); };
    add_bootstrap(e, {r.tributaries, all}, options, 2, theta_of, std::max<Index>(1, options.resamples / fewer));
    return e;
}

}  // namespace

Concavity concavity(const Profile& profile, const ConcavityOptions& options) {
    const Rivers rivers = rivers_of(profile, options);
    const Trunks trunks = trunks_of(rivers);
    MisfitTable linear, collinear;
    Disorder disorder = disorder_sample(rivers, options.most_sorted);
    ChiLadder ladder(profile);
    for (int i = 0; i < theta_count; ++i) {
        if (i > 0) ladder.climb();
        add_linearity(rivers, ladder.chi_m(), linear);
        add_collinearity(rivers, trunks, ladder.chi_m(), collinear);
        add_disorder(rivers, ladder.chi_m(), disorder);
    }
    return {.linearity = estimate_of(linear, options, 0),
            .collinearity = estimate_of(collinear, options, 1),
            .disorder = disorder_estimate(rivers, disorder, options)};
}

}  // namespace thalweg::channel
