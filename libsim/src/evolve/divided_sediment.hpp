// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "evolve/divided_erosion.hpp"
#include "evolve/sediment.hpp"

namespace thalweg::evolve {

/// Buffers of a step with sediment along divided flow, one value per node, that live as long as a simulation.
struct DividedSedimentBuffers {
    std::vector<double> before_m, water_m;
    std::vector<double> c;         // dt·k·A^m
    std::vector<double> load_m3;   // sediment from above at the heights of the last sweep up
    std::vector<double> response;  // of that sediment to the node's own height, m³/m: 0 or less
    std::vector<double> follow;    // by how much the node rises if all its receivers do by 1
    std::vector<std::uint8_t> in_lake;
    std::vector<Hold> hold;
};

/// One step of erosion and deposition along divided flow: the equations of `SedimentStep` with Σ w_r·S_r^n in the place
/// of S^n and the sediment divided as the water is. They form no tree, so the elimination that is exact there becomes
/// an approximation here: the answer of the sediment to a node's height is found as if all receivers of a node above
/// moved together. It only steers the iteration, whose fixed point solves the equations whatever it is.
template <class Edges>
class DividedSedimentStep {
  public:
    DividedSedimentStep(const Edges& edges, const Drainage& drainage, const River& river, const SlopeSolver& solve,
                        const Setting& setting, double dt_yr, std::vector<double>& elevation_m,
                        DividedSedimentBuffers& buffers)
        : edges_(edges),
          drainage_(drainage),
          river_(river),
          solve_(solve),
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
            sums.sediment_converged = change.largest_m <= tolerance * change.relief_m;
        }
        sweep_down();
        take_stock(sums);
        return sums;
    }

  private:
    static constexpr int most_iterations = 200;
    static constexpr double tolerance = 1e-12;  // of the relief

    struct Change {
        double largest_m = 0, relief_m = 0;
    };

    /// Notes the heights and which nodes lie in a lake.
    void begin() {
        const std::size_t nodes = elevation_m_.size();
        buffers_.before_m = elevation_m_;
        buffers_.water_m.assign(nodes, 0);
        buffers_.c.assign(nodes, 0);
        buffers_.load_m3.assign(nodes, 0);
        buffers_.response.assign(nodes, 0);
        buffers_.follow.assign(nodes, 0);
        buffers_.in_lake.assign(nodes, 0);
        buffers_.hold.assign(nodes, Hold::level);
        for (const Index node : drainage_.order) {
            const double own = elevation_m_[node];
            const double below = water_below(receivers_of(drainage_.flow, node), own);
            buffers_.in_lake[node] = own < below;
            buffers_.water_m[node] = std::max(own, below);
            buffers_.c[node] = dt_yr_ * erodibility(node) * area_power(drainage_.area_m2[node], river_.m);
        }
    }

    /// Lowest water level among the receivers; `own` where there are none.
    double water_below(const Receivers& receivers, double own) const {
        if (receivers.size() == 0) return own;
        double lowest = std::numeric_limits<double>::infinity();
        for (const Index receiver : receivers.node) lowest = std::min(lowest, buffers_.water_m[receiver]);
        return lowest;
    }

    double erodibility(Index node) const {
        return setting_.relative_erodibility.empty() ? river_.k : river_.k * setting_.relative_erodibility[node];
    }
    double raised(Index node) const { return buffers_.before_m[node] + dt_yr_ * setting_.uplift_m_per_yr[node]; }
    /// Height laid down per volume of sediment.
    double per_load(Index node) const { return drainage_.area_m2[node] > 0 ? river_.g / drainage_.area_m2[node] : 0; }

    /// From the outlets up: every node's height, with the sediment that the last sweep down brought it.
    Change sweep_up() {
        Change change;
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (const Index node : drainage_.order) {
            const Receivers receivers = receivers_of(drainage_.flow, node);
            double& height = elevation_m_[node];
            const double below = water_below(receivers, height);
            if (receivers.size() > 0) {
                const double now = balance(node, receivers, below);
                change.largest_m = std::max(change.largest_m, std::abs(now - height));
                height = now;
            }
            buffers_.water_m[node] = std::max(height, below);
            low = std::min(low, height);
            high = std::max(high, height);
        }
        change.relief_m = high - low;
        return change;
    }

    /// The height at which uplift, river and sediment balance. With load Q + B·(h − h_last) from above and κ = 1 +
    /// (G/A)·(a − B) it is that of a node raised to b + (G/A)·(Q + B·(b − h_last))/κ, dug with c/κ.
    double balance(Index node, const Receivers& receivers, double water_m) {
        const double per_q = per_load(node);
        const double response = buffers_.response[node];
        const double kappa = 1 + per_q * (edges_.area(node) - response);
        const double b = raised(node);
        const double load = buffers_.load_m3[node] + response * (b - elevation_m_[node]);
        const double c = buffers_.c[node] / kappa;
        const NodeStep step = step_divided(b + per_q * load / kappa, receivers, elevation_m_, c, river_, solve_);
        double height = step.elevation_m;
        buffers_.hold[node] = step.talus_m > 0 ? Hold::talus : step.incision_m > 0 ? Hold::river : Hold::level;
        if (buffers_.in_lake[node] && height > water_m && b < water_m) {
            height = water_m;
            buffers_.hold[node] = Hold::filled;
        }
        buffers_.follow[node] = follow(node, receivers, height, c);
        return height;
    }

    double follow(Index node, const Receivers& receivers, double height, double c) const {
        if (buffers_.hold[node] == Hold::level) return 0;
        if (buffers_.hold[node] != Hold::river) return 1;
        const double rise = c * dug(receivers, height).second;
        return std::isfinite(rise) ? rise / (1 + rise) : 1;
    }

    /// Σ w·S^n at a height, and its derivative.
    std::pair<double, double> dug(const Receivers& receivers, double height) const {
        double sum = 0, rise = 0;
        for (std::size_t r = 0; r < receivers.size(); ++r) {
            const double drop = height - elevation_m_[receivers.node[r]];
            if (!(drop > 0)) continue;
            const double slope = drop / receivers.length[r];
            const double part = receivers.share[r] * (river_.n == 1 ? slope : power(slope, river_.n));
            sum += part;
            rise += river_.n * part / drop;
        }
        return {sum, rise};
    }

    /// From the sources down: what every node gets from above, and how that answers to its height.
    void sweep_down() {
        std::fill(buffers_.load_m3.begin(), buffers_.load_m3.end(), 0.0);
        std::fill(buffers_.response.begin(), buffers_.response.end(), 0.0);
        for (std::size_t at = drainage_.order.size(); at-- > 0;) {
            const Index node = drainage_.order[at];
            const Receivers receivers = receivers_of(drainage_.flow, node);
            const double area = edges_.area(node);
            const double leaving = buffers_.load_m3[node] + area * (raised(node) - elevation_m_[node]);
            const double response = buffers_.follow[node] * (buffers_.response[node] - area);
            for (std::size_t r = 0; r < receivers.size(); ++r) {
                buffers_.load_m3[receivers.node[r]] += receivers.share[r] * leaving;
                buffers_.response[receivers.node[r]] += receivers.share[r] * response;
            }
        }
    }

    /// What each process did to each node, each by its own law at the heights of the end.
    void take_stock(StepSums& sums) {
        for (const Index node : drainage_.order) {
            const Receivers receivers = receivers_of(drainage_.flow, node);
            if (receivers.size() == 0) continue;
            const double area = edges_.area(node);
            const double lost_m = raised(node) - elevation_m_[node];
            NodeStep step{.elevation_m = elevation_m_[node],
                          .incision_m = buffers_.c[node] * dug(receivers, elevation_m_[node]).first};
            double deposit_m = per_load(node) * (buffers_.load_m3[node] + area * lost_m);
            if (buffers_.hold[node] == Hold::filled) deposit_m = step.incision_m - lost_m;
            if (buffers_.hold[node] == Hold::talus) step.talus_m = lost_m + deposit_m - step.incision_m;
            sums.add(area, dt_yr_ * setting_.uplift_m_per_yr[node], elevation_m_[node] - buffers_.before_m[node], step);
            sums.deposited.add(area * deposit_m);
        }
        sums.carry();
    }

    const Edges& edges_;
    const Drainage& drainage_;
    const River& river_;
    const SlopeSolver& solve_;
    const Setting& setting_;
    double dt_yr_;
    std::vector<double>& elevation_m_;
    DividedSedimentBuffers& buffers_;
};

}  // namespace thalweg::evolve
