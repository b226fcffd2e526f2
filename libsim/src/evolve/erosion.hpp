// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <vector>

#include "evolve/compensated_sum.hpp"
#include "evolve/drainage.hpp"
#include "evolve/edges.hpp"
#include "thalweg/core/parallel.hpp"
#include "thalweg/core/power.hpp"
#include "thalweg/evolve/river.hpp"
#include "thalweg/evolve/slope.hpp"

namespace thalweg::evolve {

/// A^m. The square root differs from A^0.5 by rounding at most.
inline double area_power(double area, double m) {
    if (m == 0.5) return std::sqrt(area);
    return m == 1 ? area : power(area, m);
}

/// What happens to one node in one step.
struct NodeStep {
    double elevation_m;
    double incision_m = 0;
    double talus_m = 0;
    int iterations = 0;
};

/// The node, uplifted to `raised`, above a receiver that has already taken its step. Works with the drop and not with
/// heights, so that a thin layer taken from a high mountain keeps all its digits.
inline NodeStep step_node(double raised, double receiver_m, double length, double c, const SlopeSolver& solve,
                          double talus_slope) {
    const double drop = raised - receiver_m;
    if (!(drop > 0)) return {raised};
    const SlopeAndIncision solution = solve(drop, length, c);
    const double slope = std::min(solution.slope, talus_slope);
    return {.elevation_m = receiver_m + length * slope,
            .incision_m = solution.incision_m,
            .talus_m = length * (solution.slope - slope),
            .iterations = solution.iterations};
}

/// Asks for what a sweep will need of a node. Inlined by force: what does nothing but ask the compiler would drop.
[[gnu::always_inline]] inline void fetch(Index node, const Drainage& drainage, const Setting& setting,
                                         std::span<const double> elevation_m) {
    __builtin_prefetch(&drainage.directions[node]);
    __builtin_prefetch(&drainage.area_m2[node]);
    __builtin_prefetch(&setting.uplift_m_per_yr[node]);
    if (!setting.relative_erodibility.empty()) __builtin_prefetch(&setting.relative_erodibility[node]);
    __builtin_prefetch(&elevation_m[node]);
}

/// Nodes that are solved together: a loop over them vectorises, and one does not wait for the other's arithmetic.
inline constexpr int most_lanes = 8;

/// What a step needs of some nodes, and what it gives.
template <int lanes>
struct NodeBatch {
    alignas(64) double before[lanes], uplift_m[lanes], receiver_m[lanes], length[lanes], c[lanes], cell_area[lanes];
    alignas(64) double after[lanes], slope[lanes], incision_m[lanes], talus_m[lanes], drop[lanes];
};

/// Writes value(0) … value(lanes − 1), four at a time: a vector that is read after four single writes would wait for
/// them.
template <int lanes, class Value>
void collect(double* to, Value value) {
    using Four = double __attribute__((vector_size(32)));
    if constexpr (lanes % 4 == 0) {
        for (int i = 0; i < lanes; i += 4) {
            const Four four{value(i), value(i + 1), value(i + 2), value(i + 3)};
            std::memcpy(to + i, &four, sizeof four);
        }
    } else {
        for (int i = 0; i < lanes; ++i) to[i] = value(i);
    }
}

/// c·A^m in place of A.
template <int lanes>
void raise_area(double* c, double m) {
    if (m == 0.5) {
        for (int i = 0; i < lanes; ++i) c[i] = std::sqrt(c[i]);
    } else if (m != 1) {
        double raised[lanes], unusual = 0;
        for (int i = 0; i < lanes; ++i) raised[i] = normal_power(c[i], m);
        for (int i = 0; i < lanes; ++i) unusual = c[i] >= 1e-300 && raised[i] < 1e300 ? unusual : 1;
        for (int i = 0; i < lanes; ++i) c[i] = unusual == 0 ? raised[i] : power(c[i], m);
    }
}

/// The nodes, uplifted, above receivers that have already taken their step. A node whose receiver ends no lower stays
/// as it was raised. Works with the drop and not with heights, so that a thin layer taken from a high mountain keeps
/// all its digits.
template <int lanes>
int step_nodes(const SlopeSolver& solve, double n, double talus_slope, NodeBatch<lanes>& b) {
    for (int i = 0; i < lanes; ++i) b.drop[i] = (b.before[i] + b.uplift_m[i]) - b.receiver_m[i];
    int iterations = 0;
    if (n == 1) {
        for (int i = 0; i < lanes; ++i) {
            const double fall = b.drop[i] > 0 ? b.drop[i] : 0;
            b.slope[i] = fall / (b.length[i] + b.c[i]);
            b.incision_m[i] = b.c[i] * b.slope[i];
        }
    } else {
        iterations = solve.template solve<lanes>(b.drop, b.length, b.c, b.slope, b.incision_m);
    }
    for (int i = 0; i < lanes; ++i) {
        const double slope = b.slope[i] < talus_slope ? b.slope[i] : talus_slope;
        const double eroded = b.receiver_m[i] + b.length[i] * slope;
        const double raised = b.before[i] + b.uplift_m[i];
        b.talus_m[i] = b.length[i] * (b.slope[i] - slope);
        b.after[i] = b.drop[i] > 0 ? eroded : raised;
    }
    return iterations;
}

/// Sums over the nodes of a step, in the order of the sweep: plain over a few hundred nodes in each lane, then carried
/// on with their rounding error.
class StepSums {
  public:
    void add(const NodeBatch<most_lanes>& b, int iterations) {
        for (int i = 0; i < most_lanes; ++i) {
            const double change = b.after[i] - b.before[i];
            const double size = std::abs(change);
            area_[i] += b.cell_area[i];
            uplifted_[i] += b.cell_area[i] * b.uplift_m[i];
            incised_[i] += b.cell_area[i] * b.incision_m[i];
            talus_[i] += b.cell_area[i] * b.talus_m[i];
            stored_[i] += b.cell_area[i] * change;
            moved_[i] += b.cell_area[i] * size;
            largest_[i] = size > largest_[i] ? size : largest_[i];
        }
        count(iterations);
    }

    void add(const NodeBatch<1>& b, int iterations) {
        add(b.cell_area[0], b.uplift_m[0], b.after[0] - b.before[0],
            {.elevation_m = b.after[0],
             .incision_m = b.incision_m[0],
             .talus_m = b.talus_m[0],
             .iterations = iterations});
    }

    void add(double cell_area, double uplift_m, double change_m, const NodeStep& node) {
        area_[0] += cell_area;
        uplifted_[0] += cell_area * uplift_m;
        incised_[0] += cell_area * node.incision_m;
        talus_[0] += cell_area * node.talus_m;
        stored_[0] += cell_area * change_m;
        moved_[0] += cell_area * std::abs(change_m);
        largest_[0] = std::max(largest_[0], std::abs(change_m));
        count(node.iterations);
    }

    /// Adds what another sweep has summed.
    void add(const StepSums& other) {
        carry();
        uplifted.add(other.uplifted.value());
        incised.add(other.incised.value());
        talus.add(other.talus.value());
        stored.add(other.stored.value());
        area += other.area;
        moved += other.moved;
        largest_[0] = std::max(largest_[0], other.largest_[0]);
        iterations_ = std::max(iterations_, other.iterations_);
    }

    /// Brings the totals up to date.
    void carry() {
        const auto take = [](double* lane) {
            double sum = 0;
            for (int i = 0; i < most_lanes; ++i) sum += lane[i];
            std::fill_n(lane, most_lanes, 0.0);
            return sum;
        };
        uplifted.add(take(uplifted_));
        incised.add(take(incised_));
        talus.add(take(talus_));
        stored.add(take(stored_));
        area += take(area_);
        moved += take(moved_);
        largest_[0] = *std::max_element(largest_, largest_ + most_lanes);
        batches_ = 0;
    }

    StepReport report(double dt_yr) const {
        return {.max_rate_m_per_yr = largest_[0] / dt_yr,
                .mean_rate_m_per_yr = area > 0 ? moved / area / dt_yr : 0,
                .largest_newton_iterations = iterations_,
                .mass = {.uplifted_m3 = uplifted.value(),
                         .eroded_m3 = incised.value(),
                         .talus_m3 = talus.value(),
                         .deposited_m3 = deposited.value(),
                         .exported_m3 = incised.value() + talus.value() - deposited.value(),
                         .stored_m3 = stored.value()},
                .sediment_iterations = sediment_iterations,
                .sediment_converged = sediment_converged};
    }

    CompensatedSum uplifted, incised, talus, stored;  ///< after `carry`
    CompensatedSum deposited;                         ///< not by `add`: only rivers with sediment have it
    double area = 0;
    double moved = 0;
    int sediment_iterations = 0;
    bool sediment_converged = true;

  private:
    void count(int iterations) {
        iterations_ = std::max(iterations_, iterations);
        if (++batches_ == 64) carry();
    }

    alignas(64) double uplifted_[most_lanes]{}, incised_[most_lanes]{}, talus_[most_lanes]{}, stored_[most_lanes]{};
    alignas(64) double area_[most_lanes]{}, moved_[most_lanes]{}, largest_[most_lanes]{};
    int iterations_ = 0;
    int batches_ = 0;
};

/// A sweep from the outlets up. A node without receiver is left where it is and is in no sum.
template <class Edges>
class ErosionSweep {
  public:
    ErosionSweep(const Edges& edges, const Drainage& drainage, const River& river, const SlopeSolver& solve,
                 const Setting& setting, double dt_yr, std::span<double> elevation_m)
        : edges_(edges),
          order_(drainage.order.data()),
          directions_(drainage.directions.data()),
          area_m2_(drainage.area_m2.data()),
          uplift_(setting.uplift_m_per_yr.data()),
          relative_k_(setting.relative_erodibility.empty() ? nullptr : setting.relative_erodibility.data()),
          elevation_(elevation_m.data()),
          solve_(solve),
          n_(river.n),
          m_(river.m),
          talus_slope_(river.talus_slope),
          dt_yr_(dt_yr),
          dt_k_(dt_yr * river.k) {}

    /// Nodes order[begin, end), none of which flows to another of them.
    void layer(Index begin, Index end, StepSums& sums) const {
        Index at = begin;
        for (; at + most_lanes <= end; at += most_lanes) {
            if (at + 4 * most_lanes <= end) fetch_batch(order_ + at + 3 * most_lanes);
            if (all_flow(order_ + at)) {
                step<most_lanes>(order_ + at, sums);
            } else {
                one_by_one(at, at + most_lanes, sums);
            }
        }
        one_by_one(at, end, sums);
    }

    /// Any nodes, receivers first.
    void one_by_one(Index begin, Index end, StepSums& sums) const {
        for (Index at = begin; at < end; ++at) {
            if (directions_[order_[at]] != no_flow) step<1>(order_ + at, sums);
        }
    }

  private:
    /// Asks for what the nodes will need.
    [[gnu::always_inline]] void fetch_batch(const Index* nodes) const {
        for (int i = 0; i < most_lanes; ++i) {
            __builtin_prefetch(elevation_ + nodes[i], 1);
            __builtin_prefetch(area_m2_ + nodes[i]);
            __builtin_prefetch(uplift_ + nodes[i]);
            if constexpr (requires { edges_.fetch(nodes[i]); }) edges_.fetch(nodes[i]);
        }
    }

    bool all_flow(const Index* nodes) const {
        bool flow = true;
        for (int i = 0; i < most_lanes; ++i) flow &= directions_[nodes[i]] != no_flow;
        return flow;
    }

    template <int lanes>
    void step(const Index* nodes, StepSums& sums) const {
        NodeBatch<lanes> b;
        Slot slot[lanes];
        for (int i = 0; i < lanes; ++i) slot[i] = directions_[nodes[i]];
        collect<lanes>(b.before, [&](int i) { return elevation_[nodes[i]]; });
        collect<lanes>(b.receiver_m, [&](int i) { return elevation_[edges_.neighbor(nodes[i], slot[i])]; });
        collect<lanes>(b.length, [&](int i) { return edges_.length(nodes[i], slot[i]); });
        collect<lanes>(b.uplift_m, [&](int i) { return uplift_[nodes[i]]; });
        collect<lanes>(b.c, [&](int i) { return area_m2_[nodes[i]]; });
        collect<lanes>(b.cell_area, [&](int i) { return edges_.area(nodes[i]); });
        raise_area<lanes>(b.c, m_);
        for (int i = 0; i < lanes; ++i) b.uplift_m[i] *= dt_yr_;
        if (relative_k_ == nullptr) {
            for (int i = 0; i < lanes; ++i) b.c[i] *= dt_k_;
        } else {
            for (int i = 0; i < lanes; ++i) b.c[i] *= dt_k_ * relative_k_[nodes[i]];
        }
        const int iterations = step_nodes(solve_, n_, talus_slope_, b);
        for (int i = 0; i < lanes; ++i) elevation_[nodes[i]] = b.after[i];
        sums.add(b, iterations);
    }

    const Edges& edges_;
    const Index* order_;
    const Slot* directions_;
    const double* area_m2_;
    const double* uplift_;
    const double* relative_k_;
    double* elevation_;
    const SlopeSolver& solve_;
    double n_, m_, talus_slope_, dt_yr_, dt_k_;
};

/// Layers of one part of the order, or where there are none known all nodes one by one.
template <class Edges>
StepSums erode_part(const ErosionSweep<Edges>& sweep, const terrain::FlowLayers& layers, Index part) {
    StepSums sums;
    for (Index layer = layers.part[part]; layer < layers.part[part + 1]; ++layer) {
        sweep.layer(layers.begin[layer], layers.begin[layer + 1], sums);
    }
    sums.carry();
    return sums;
}

/// First the trunk, then the parts above it, each on its thread; their sums are added in the order of the parts.
template <class Edges>
StepSums erode_along(const Edges& edges, const Drainage& drainage, const River& river, const SlopeSolver& solve,
                     const Setting& setting, double dt_yr, Landscape& landscape) {
    const ErosionSweep<Edges> sweep(edges, drainage, river, solve, setting, dt_yr, landscape.elevation_m);
    landscape.time_yr += dt_yr;
    const terrain::FlowLayers& layers = drainage.layers;
    StepSums sums;
    if (layers.part.empty()) {
        sweep.one_by_one(0, static_cast<Index>(drainage.order.size()), sums);
        sums.carry();
        return sums;
    }
    const auto parts = static_cast<Index>(layers.part.size() - 1);
    std::vector<StepSums> of_part(parts);
    of_part[0] = erode_part(sweep, layers, 0);
    const auto some = [&](Index first, Index last) {
        for (Index part = first; part < last; ++part) of_part[part] = erode_part(sweep, layers, part);
    };
    parallel_for(1, parts, some, 1);
    for (const StepSums& part : of_part) sums.add(part);
    return sums;
}

}  // namespace thalweg::evolve
