// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/evolve/simulate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "evolve/check_setting.hpp"
#include "evolve/drainage.hpp"
#include "evolve/erosion.hpp"
#include "evolve/exchange_watch.hpp"

namespace thalweg::evolve {
namespace {

/// Steps for which only the same nodes may exchange receivers before they are frozen.
constexpr Index patience = 50;

/// Receivers are frozen only when the landscape has nearly come to rest (mean rate under this share of the mean uplift)
/// and gets no calmer: before that a node that swings to and fro is part of the growth.
constexpr double freezing_share = 0.1;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Whether the volume moved per step still falls: under half its lowest value so far at least once in `patience` steps.
class Slackening {
  public:
    void observe(double moved_m3) {
        ++steps_;
        if (moved_m3 >= 0.5 * lowest_) return;
        lowest_ = moved_m3;
        steps_ = 0;
    }
    bool over() const { return steps_ >= patience; }
    void restart() { steps_ = 0; }

  private:
    double lowest_ = std::numeric_limits<double>::infinity();
    Index steps_ = 0;
};

void add(MassBalance& total, const MassBalance& step) {
    total.uplifted_m3 += step.uplifted_m3;
    total.eroded_m3 += step.eroded_m3;
    total.talus_m3 += step.talus_m3;
    total.exported_m3 += step.exported_m3;
    total.stored_m3 += step.stored_m3;
}

template <Topology T>
class Simulation {
  public:
    Simulation(const T& topology, const River& river, const Setting& setting, const TimeOptions& options,
               Landscape& landscape)
        : topology_(topology),
          river_(river),
          setting_(setting),
          options_(options),
          landscape_(landscape),
          solve_(river.n),
          exchange_(topology.size(), patience) {}

    SimulationResult run(const Observer& observer) {
        while (result_.steps < options_.max_steps && result_.stop_reason != StopReason::converged) {
            const auto start = Clock::now();
            const StepReport report = step();
            if (observer) observer(record(report, seconds_since(start)), landscape_);
        }
        return finish();
    }

  private:
    StepReport step() {
        drain_into(topology_, landscape_, setting_, river_.receiver, exchange_.frozen(), drainage_);
        const StepSums sums = with_edges(topology_, [&](const auto& edges) {
            return erode_along(edges, drainage_, river_, solve_, setting_, options_.step_yr, landscape_);
        });
        const StepReport report = sums.report(options_.step_yr);
        ++result_.steps;
        result_.max_rate_m_per_yr = report.max_rate_m_per_yr;
        result_.mean_rate_m_per_yr = report.mean_rate_m_per_yr;
        result_.largest_newton_iterations =
            std::max(result_.largest_newton_iterations, report.largest_newton_iterations);
        add(result_.mass, report.mass);
        if (options_.convergence > 0) judge(sums.moved, sums.uplifted.value());
        return report;
    }

    /// Compares the volume that moved in a step with the volume uplifted in it. A receiver that changes at the very end
    /// would set the landscape going again: at rest is what drains as it did, or stays calm for one step more.
    void judge(double moved_m3, double uplifted_m3) {
        const bool calm_before = calm_;
        calm_ = moved_m3 <= options_.convergence * uplifted_m3;
        if (calm_ && (calm_before || drains_as_before())) {
            result_.stop_reason = StopReason::converged;
            return;
        }
        exchange_.observe(drainage_.directions);
        slackening_.observe(moved_m3);
        if (moved_m3 < freezing_share * uplifted_m3 && slackening_.over() && exchange_.only_the_same()) {
            exchange_.freeze();
            slackening_.restart();
        }
    }

    bool drains_as_before() const {
        Drainage now;
        drain_into(topology_, landscape_, setting_, river_.receiver, exchange_.frozen(), now);
        return now.directions == drainage_.directions;
    }

    StepRecord record(const StepReport& report, double seconds) const {
        double highest = -std::numeric_limits<double>::infinity();
        CompensatedSum volume, area;
        for (Index node = 0; node < topology_.size(); ++node) {
            const double height = landscape_.elevation_m[node];
            if (std::isnan(height)) continue;
            highest = std::max(highest, height);
            volume.add(topology_.area(node) * height);
            area.add(topology_.area(node));
        }
        return {.step = result_.steps,
                .time_yr = landscape_.time_yr,
                .lakes = drainage_.lakes,
                .elevation_max_m = highest,
                .elevation_mean_m = volume.value() / area.value(),
                .max_rate_m_per_yr = report.max_rate_m_per_yr,
                .mean_rate_m_per_yr = report.mean_rate_m_per_yr,
                .seconds = seconds};
    }

    SimulationResult finish() {
        FlowDirections directions =
            terrain::route(topology_, landscape_.elevation_m, setting_.boundary, river_.receiver);
        result_.lakes_final = terrain::drain_lakes(topology_, landscape_.elevation_m, setting_.boundary, directions);
        result_.frozen_receivers = exchange_.frozen_count();
        result_.frozen = exchange_.frozen_mask();
        return result_;
    }

    const T& topology_;
    const River& river_;
    const Setting& setting_;
    const TimeOptions& options_;
    Landscape& landscape_;
    SlopeSolver solve_;
    Drainage drainage_;
    ExchangeWatch exchange_;
    Slackening slackening_;
    bool calm_ = false;
    SimulationResult result_;
};

template <Topology T>
SimulationResult simulated(const T& topology, const River& river, const Setting& setting, const TimeOptions& options,
                           Landscape& landscape, const Observer& observer) {
    check_setting(topology.size(), landscape, setting);
    check_river(river);
    check_step(options.step_yr);
    return Simulation<T>(topology, river, setting, options, landscape).run(observer);
}

template <class Edges>
std::vector<std::uint8_t> talus_mask(const Edges& edges, const Drainage& drainage, const River& river,
                                     const std::vector<double>& elevation_m) {
    std::vector<std::uint8_t> mask(elevation_m.size(), 0);
    for (const Index node : drainage.order) {
        const Slot slot = drainage.directions[node];
        if (slot == no_flow) continue;
        const double drop = elevation_m[node] - elevation_m[edges.neighbor(node, slot)];
        mask[node] = drop >= river.talus_slope * edges.length(node, slot) * (1 - 1e-9);
    }
    return mask;
}

}  // namespace

std::string to_string(StopReason reason) { return reason == StopReason::converged ? "converged" : "max_steps"; }

SimulationResult simulate(const Grid& grid, const River& river, const Setting& setting, const TimeOptions& options,
                          Landscape& landscape, const Observer& observer) {
    return simulated(grid, river, setting, options, landscape, observer);
}

SimulationResult simulate(const Mesh& mesh, const River& river, const Setting& setting, const TimeOptions& options,
                          Landscape& landscape, const Observer& observer) {
    return simulated(mesh, river, setting, options, landscape, observer);
}

std::vector<std::uint8_t> at_talus_limit(const Grid& grid, const Drainage& drainage, const River& river,
                                         const Landscape& landscape) {
    return with_edges(grid,
                      [&](const auto& edges) { return talus_mask(edges, drainage, river, landscape.elevation_m); });
}

std::vector<std::uint8_t> at_talus_limit(const Mesh& mesh, const Drainage& drainage, const River& river,
                                         const Landscape& landscape) {
    return talus_mask(mesh, drainage, river, landscape.elevation_m);
}

}  // namespace thalweg::evolve
