// SPDX-License-Identifier: GPL-3.0-or-later
// The experiment of papers/braun_willett_2013: an island on a raster of 100 m cells, u = 1e-3 m/yr, m = 0.5, n = 1, all
// four sides at base level. Prints rows that cases.py reads:
//   paper_braun_willett_2013 cost STEPS SIDE…           seconds of each step, by nodes
//   paper_braun_willett_2013 transient SIDE             a steady island whose uplift doubles, by the time step
//   paper_braun_willett_2013 seeds SIDE COUNT STEP_YR…  islands from noise until they stand still
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "support/settings.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/evolve/simulate.hpp"

namespace {

using namespace thalweg;

constexpr double cell_m = 100, uplift_m_per_yr = 1e-3;
constexpr evolve::Model usual{{.k = 2e-5, .m = 0.5}};
constexpr evolve::Model slow{{.k = 2e-6, .m = 0.5}};  // responds within several million years

Grid island_of(Index side) { return plane_grid(side, side, cell_m, cell_m); }

struct Size {
    double mean_m, relief_m;
};

Size size_of(const Grid& grid, const std::vector<double>& elevation_m) {
    double sum = 0;
    for (const double z : elevation_m) sum += z;
    return {sum / grid.size(), *std::max_element(elevation_m.begin(), elevation_m.end())};
}

void cost(Index steps, const std::vector<Index>& sides) {
    fmt::print("nodes,step,lakes,seconds\n");
    for (const Index side : sides) {
        const Grid grid = island_of(side);
        const auto setting = support::island(grid, uplift_m_per_yr);
        auto landscape = support::rough_start(setting, 1, 1);
        evolve::simulate(grid, usual, setting, {.step_yr = 2e4, .max_steps = steps, .convergence = 0}, landscape,
                         [&](const evolve::StepRecord& r, const evolve::SimulationState&) {
                             fmt::print("{},{},{},{:.6g}\n", grid.size(), r.step, r.lakes, r.seconds);
                         });
    }
}

/// Root mean square of the difference over the root mean square of the reference.
double relative_difference(const std::vector<double>& a, const std::vector<double>& reference) {
    double difference = 0, square = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        difference += (a[i] - reference[i]) * (a[i] - reference[i]);
        square += reference[i] * reference[i];
    }
    return std::sqrt(difference / square);
}

evolve::Landscape after(const Grid& grid, const evolve::Setting& setting, evolve::Landscape start, double step_yr,
                        double time_yr) {
    const auto steps = static_cast<Index>(std::lround(time_yr / step_yr));
    evolve::simulate(grid, slow, setting, {.step_yr = step_yr, .max_steps = steps, .convergence = 0}, start);
    return start;
}

void transient(Index side) {
    constexpr double shortest_yr = 1e3, halfway_yr = 2e6, end_yr = 4e7;
    const Grid grid = island_of(side);
    const auto before = support::island(grid, uplift_m_per_yr), doubled = support::island(grid, 2 * uplift_m_per_yr);
    auto start = support::rough_start(before, 1, 1);
    if (!evolve::solve_steady(grid, slow.river, before, 10000, start).converged) throw Error("no steady start");
    const auto reference = after(grid, doubled, start, shortest_yr, halfway_yr);
    fmt::print("step_yr,mean_start_m,mean_halfway_m,difference_halfway,mean_end_m\n");
    for (const double step_yr : {1e3, 1e4, 2e4, 5e4, 1e5, 2e5, 5e5, 1e6}) {
        const auto half = after(grid, doubled, start, step_yr, halfway_yr);
        const auto end = after(grid, doubled, half, step_yr, end_yr - halfway_yr);
        fmt::print("{},{:.9g},{:.9g},{:.6g},{:.9g}\n", step_yr, size_of(grid, start.elevation_m).mean_m,
                   size_of(grid, half.elevation_m).mean_m, relative_difference(half.elevation_m, reference.elevation_m),
                   size_of(grid, end.elevation_m).mean_m);
    }
}

Index standing(const evolve::Landscape& landscape, const evolve::Setting& setting) {
    Index count = 0;
    for (Index node = 0; node < landscape.elevation_m.size(); ++node) {
        const bool inside = setting.boundary[node] == Boundary::interior;
        count += inside && landscape.elevation_m[node] > 0.999 * uplift_m_per_yr * landscape.time_yr;
    }
    return count;
}

/// From noise for 4 Myr, and on until mean height and relief change by less than 0.1 % in a million years.
void run_seed(const Grid& grid, std::uint64_t seed, double step_yr) {
    constexpr double first_look_yr = 4e6, longest_yr = 2e8, still = 1e-3;
    const auto setting = support::island(grid, uplift_m_per_yr);
    auto state = evolve::initial_state(support::rough_start(setting, 1, seed));
    const auto go_on = [&](double years) {
        const Index steps = state.steps + static_cast<Index>(std::lround(years / step_yr));
        evolve::simulate(grid, usual, setting, {.step_yr = step_yr, .max_steps = steps, .convergence = 0}, state);
        return size_of(grid, state.landscape.elevation_m);
    };
    Size last = go_on(first_look_yr);
    const Index left = standing(state.landscape, setting);
    for (;;) {
        const Size now = go_on(1e6);
        const bool rests =
            std::abs(now.mean_m / last.mean_m - 1) < still && std::abs(now.relief_m / last.relief_m - 1) < still;
        last = now;
        if (rests || state.landscape.time_yr > longest_yr) break;
    }
    fmt::print("{},{},{},{:.9g},{:.9g},{}\n", step_yr, seed, state.landscape.time_yr, last.mean_m, last.relief_m, left);
}

void seeds(Index side, std::uint64_t count, const std::vector<double>& steps_yr) {
    fmt::print("step_yr,seed,time_yr,mean_m,relief_m,standing_at_4_myr\n");
    const Grid grid = island_of(side);
    for (const double step_yr : steps_yr) {
        for (std::uint64_t seed = 1; seed <= count; ++seed) run_seed(grid, seed, step_yr);
    }
}

template <class T>
std::vector<T> numbers(int argc, char** argv, int from) {
    std::vector<T> values;
    for (int i = from; i < argc; ++i) values.push_back(static_cast<T>(std::stod(argv[i])));
    return values;
}

}  // namespace

int main(int argc, char** argv) {
    const std::string_view what = argc > 1 ? argv[1] : "";
    if (what == "cost" && argc > 3) {
        cost(static_cast<Index>(std::stoul(argv[2])), numbers<Index>(argc, argv, 3));
    } else if (what == "transient" && argc == 3) {
        transient(static_cast<Index>(std::stoul(argv[2])));
    } else if (what == "seeds" && argc > 4) {
        seeds(static_cast<Index>(std::stoul(argv[2])), std::stoul(argv[3]), numbers<double>(argc, argv, 4));
    } else {
        fmt::print(stderr, "usage: cost STEPS SIDE… | transient SIDE | seeds SIDE COUNT STEP_YR…\n");
        return 2;
    }
    return EXIT_SUCCESS;
}
