// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "evolve/divided_sediment.hpp"
#include "evolve/sediment.hpp"

namespace thalweg::evolve {

/// Buffers of a step with sediment, one value per node, that live as long as a simulation.
struct SedimentBuffers {
    std::vector<double> before_m, water_m;
    std::vector<double> c;  // dt·k·A^m
    std::vector<std::uint8_t> in_lake;
    std::vector<SedimentState> state;
    std::vector<Answer> above;  // of all donors together
    DividedSedimentBuffers divided;
};

/// One step of erosion and deposition, as the header says.
template <class Edges>
class SedimentStep {
  public:
    SedimentStep(const Edges& edges, const Drainage& drainage, const River& river, const SlopeSolver& solve,
                 const Setting& setting, double dt_yr, std::vector<double>& elevation_m, SedimentBuffers& buffers)
        : edges_(edges),
          drainage_(drainage),
          river_(river),
          solve_(solve, river.talus_slope),
          setting_(setting),
          dt_yr_(dt_yr),
          elevation_m_(elevation_m),
          buffers_(buffers) {}

    StepSums run() {
        begin();
        StepSums sums;
        sweep_up();
        sums.sediment_converged = false;
        while (!sums.sediment_converged && sums.sediment_iterations < most_iterations) {
            ++sums.sediment_iterations;
            sweep_down();
            const Change change = sweep_up();
            const bool exact = river_.n == 1 && !change.held_otherwise;
            sums.sediment_converged = exact || change.largest_m <= tolerance * change.relief_m;
        }
        take_stock(sums);
        return sums;
    }

  private:
    static constexpr int most_iterations = 100;
    static constexpr double tolerance = 1e-12;  // of the relief; the error after such a change is of its square

    struct Change {
        double largest_m = 0, relief_m = 0;
        bool held_otherwise = false;
    };

    /// Notes the heights and which nodes lie in a lake.
    void begin() {
        const std::size_t nodes = elevation_m_.size();
        buffers_.before_m = elevation_m_;
        buffers_.water_m.resize(nodes);
        buffers_.c.resize(nodes);
        buffers_.in_lake.assign(nodes, 0);
        buffers_.state.assign(nodes, {});
        buffers_.above.assign(nodes, {});
        for (const Index node : drainage_.order) {
            const Slot slot = drainage_.directions[node];
            const double own = elevation_m_[node];
            const double below = slot == no_flow ? own : buffers_.water_m[edges_.neighbor(node, slot)];
            buffers_.in_lake[node] = own < below;
            buffers_.water_m[node] = std::max(own, below);
            buffers_.c[node] = dt_yr_ * erodibility(node) * area_power(drainage_.area_m2[node], river_.m);
        }
    }

    double erodibility(Index node) const {
        return setting_.relative_erodibility.empty() ? river_.k : river_.k * setting_.relative_erodibility[node];
    }

    SedimentNode node_at(Index node, Slot slot) const {
        const double area = drainage_.area_m2[node];
        return {.raised_m = buffers_.before_m[node] + dt_yr_ * setting_.uplift_m_per_yr[node],
                .length_m = edges_.length(node, slot),
                .area_m2 = edges_.area(node),
                .c = buffers_.c[node],
                .per_q = area > 0 ? river_.g / area : 0,
                .in_lake = buffers_.in_lake[node] != 0};
    }

    /// From the outlets up: every node's height, the sediment from above answering as the last sweep down found.
    Change sweep_up() {
        Change change;
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (const Index node : drainage_.order) {
            const Slot slot = drainage_.directions[node];
            double& height = elevation_m_[node];
            if (slot != no_flow) {
                const Index receiver = edges_.neighbor(node, slot);
                const Foot foot{elevation_m_[receiver], buffers_.water_m[receiver]};
                SedimentState& state = buffers_.state[node];
                const SedimentState old = state;
                const double now = solve_(node_at(node, slot), foot, buffers_.above[node], state);
                change.largest_m = std::max(change.largest_m, std::abs(now - height));
                change.held_otherwise |= state.hold != old.hold || state.under_water != old.under_water;
                height = now;
                buffers_.water_m[node] = std::max(now, foot.water_m);
            } else {
                buffers_.water_m[node] = height;
            }
            low = std::min(low, height);
            high = std::max(high, height);
        }
        change.relief_m = high - low;
        return change;
    }

    /// From the sources down: how the sediment of every subtree answers to what lies at its foot.
    void sweep_down() {
        std::fill(buffers_.above.begin(), buffers_.above.end(), Answer{});
        for (std::size_t at = drainage_.order.size(); at-- > 0;) {
            const Index node = drainage_.order[at];
            const Slot slot = drainage_.directions[node];
            if (slot == no_flow) continue;
            const SedimentNode fixed = node_at(node, slot);
            const Answer& above = buffers_.above[node];
            const SedimentState& state = buffers_.state[node];
            const Answer height = height_answer(fixed, above, state, river_);
            buffers_.above[edges_.neighbor(node, slot)].add(sediment_answer(fixed, above, state, height));
        }
    }

    /// From the sources down once more, with the sediment itself: what each process did to each node.
    void take_stock(StepSums& sums) {
        std::vector<Answer>& load = buffers_.above;
        std::fill(load.begin(), load.end(), Answer{});
        for (std::size_t at = drainage_.order.size(); at-- > 0;) {
            const Index node = drainage_.order[at];
            const Slot slot = drainage_.directions[node];
            if (slot == no_flow) continue;
            const Index receiver = edges_.neighbor(node, slot);
            const SedimentNode fixed = node_at(node, slot);
            const double lost = fixed.raised_m - elevation_m_[node];
            const double leaving = load[node].constant + fixed.area_m2 * lost;
            load[receiver].constant += leaving;
            book(node, fixed, lost, leaving, elevation_m_[receiver], sums);
        }
        sums.carry();
    }

    void book(Index node, const SedimentNode& fixed, double lost_m, double leaving_m3, double receiver_m,
              StepSums& sums) const {
        const SedimentState& state = buffers_.state[node];
        NodeStep step{.elevation_m = elevation_m_[node], .incision_m = state.incision_m};
        double deposit_m = fixed.per_q * leaving_m3;
        if (state.hold == Hold::filled) {
            const double slope = (step.elevation_m - receiver_m) / fixed.length_m;
            step.incision_m = slope > 0 ? fixed.c * power(slope, river_.n) : 0;
            deposit_m = step.incision_m - lost_m;
        }
        if (state.hold == Hold::talus) step.talus_m = lost_m + deposit_m - step.incision_m;
        const double uplift_m = dt_yr_ * setting_.uplift_m_per_yr[node];
        sums.add(fixed.area_m2, uplift_m, step.elevation_m - buffers_.before_m[node], step);
        sums.deposited.add(fixed.area_m2 * deposit_m);
    }

    const Edges& edges_;
    const Drainage& drainage_;
    const River& river_;
    SedimentSolver solve_;
    const Setting& setting_;
    double dt_yr_;
    std::vector<double>& elevation_m_;
    SedimentBuffers& buffers_;
};

template <class Edges>
StepSums erode_with_sediment(const Edges& edges, const Drainage& drainage, const River& river, const SlopeSolver& solve,
                             const Setting& setting, double dt_yr, Landscape& landscape, SedimentBuffers& buffers) {
    std::vector<double>& elevation_m = landscape.elevation_m;
    landscape.time_yr += dt_yr;
    if (drainage.flow.size() > 0) {
        return DividedSedimentStep<Edges>(edges, drainage, river, solve, setting, dt_yr, elevation_m, buffers.divided)
            .run();
    }
    return SedimentStep<Edges>(edges, drainage, river, solve, setting, dt_yr, elevation_m, buffers).run();
}

}  // namespace thalweg::evolve
