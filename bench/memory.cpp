// SPDX-License-Identifier: GPL-3.0-or-later
// What a simulation holds beyond its mesh: surface, setting and all that the steps need, bytes per node at the highest.
#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "cases.hpp"
#include "thalweg/evolve/simulate.hpp"
#include "thalweg/mesh/triangulate.hpp"

namespace {
std::atomic<std::int64_t> held{0}, most_held{0};

void* counted(void* memory) {
    if (memory == nullptr) throw std::bad_alloc();
    const std::int64_t now = held += static_cast<std::int64_t>(malloc_usable_size(memory));
    std::int64_t most = most_held;
    while (now > most && !most_held.compare_exchange_weak(most, now)) continue;
    return memory;
}

void release(void* memory) {
    held -= static_cast<std::int64_t>(malloc_usable_size(memory));
    std::free(memory);
}
}  // namespace

void* operator new(std::size_t size) { return counted(std::malloc(size ? size : 1)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
    const auto unit = static_cast<std::size_t>(alignment);
    return counted(std::aligned_alloc(unit, (size + unit - 1) / unit * unit));
}
void operator delete(void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }

namespace thalweg::bench {
namespace {

/// The first steps have the most lakes, and so need the most.
void tin_memory(benchmark::State& state) {
    const double side = 100 * std::sqrt(static_cast<double>(state.range(0)));
    const Polygon square{{0, 0}, {side, 0}, {side, side}, {0, side}};
    const Mesh mesh =
        mesh::triangulate(square, mesh::poisson_disk_count(square, static_cast<Index>(state.range(0)), 1));
    const std::int64_t with_mesh = held;
    for (auto _ : state) {
        most_held = held.load();
        evolve::Setting setting{std::vector<double>(mesh.size(), 1e-3), std::vector<double>(mesh.size(), 1.0),
                                std::vector<Boundary>(mesh.size(), Boundary::interior)};
        evolve::Landscape landscape{0, evolve::uniform_surface(mesh.size(), 1.0, 1)};
        for (Index node = 0; node < mesh.size(); ++node) {
            if (mesh.on_outline[node]) setting.boundary[node] = Boundary::base_level;
            if (mesh.on_outline[node]) landscape.elevation_m[node] = 0;
        }
        evolve::simulate(mesh, {.river = {.k = 2e-5}}, setting, {.step_yr = 2e4, .max_steps = 5, .convergence = 0},
                         landscape);
    }
    state.counters["bytes_per_node"] = static_cast<double>(most_held - with_mesh) / mesh.size();
}
BENCHMARK(tin_memory)->ArgName("nodes")->Arg(1000000)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace thalweg::bench
