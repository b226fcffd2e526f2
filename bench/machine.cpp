// SPDX-License-Identifier: GPL-3.0-or-later
// What the machine can do now: the yardstick by which the other figures are read on noisy machines.
#include "../tools/keep_freed_memory.hpp"
#include "cases.hpp"

namespace thalweg::bench {
namespace {

// As the program does: what is timed is the work, not the system's handing out of pages.
const bool kept = (tools::keep_freed_memory(), true);

void random_gather(benchmark::State& state) {
    const Index count = 1u << 24;
    std::vector<double> values(count, 1.0);
    std::vector<Index> where(count);
    for (Index i = 0; i < count; ++i) where[i] = philox({i, 0, 0, 0}, {1, 1})[0] & (count - 1);
    for (auto _ : state) {
        double sum = 0;
        for (Index i = 0; i < count; ++i) sum += values[where[i]];
        benchmark::DoNotOptimize(sum);
    }
    per_item(state, count);
}
BENCHMARK(random_gather)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace thalweg::bench
