// SPDX-License-Identifier: GPL-3.0-or-later
// How often and how much memory the parts of Bell's case ask for. Counts every call of operator new in the process
// (containers, CGAL, TBB's tasks). Prints rows for cases.py: paper_bell_2024 NODES…
#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <new>
#include <numbers>
#include <string>

#include "support/settings.hpp"
#include "thalweg/evolve/simulate.hpp"
#include "thalweg/mesh/points.hpp"
#include "thalweg/mesh/triangulate.hpp"

namespace {
std::atomic<std::uint64_t> calls{0}, bytes{0};

void* counted(std::size_t size, std::size_t alignment) {
    calls.fetch_add(1, std::memory_order_relaxed);
    bytes.fetch_add(size, std::memory_order_relaxed);
    void* memory =
        alignment ? std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment) : std::malloc(size);
    if (!memory) throw std::bad_alloc();
    return memory;
}
}  // namespace

void* operator new(std::size_t size) { return counted(size ? size : 1, 0); }
void* operator new[](std::size_t size) { return counted(size ? size : 1, 0); }
void* operator new(std::size_t size, std::align_val_t alignment) {
    return counted(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
    return counted(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace {

using namespace thalweg;

/// Prints what was asked for since the last call.
class Meter {
  public:
    void print(std::string_view part, std::size_t nodes) {
        const std::uint64_t count = calls - calls_before_, size = bytes - bytes_before_;
        fmt::print("{},{},{},{}\n", part, nodes, count, size);
        calls_before_ = calls;
        bytes_before_ = bytes;
    }

  private:
    std::uint64_t calls_before_ = calls, bytes_before_ = bytes;
};

void measure(Index nodes) {
    constexpr double side_m = 32768;
    const Polygon square{{0, 0}, {side_m, 0}, {side_m, side_m}, {0, side_m}};
    Meter meter;
    const mesh::PointSet points = mesh::poisson_disk_count(square, nodes, 1);
    meter.print("points", points.points.size());
    const Mesh mesh = mesh::triangulate(square, points);
    meter.print("mesh", mesh.size());
    const auto setting = support::island(mesh, 4e-4);
    const evolve::Model model{{.k = 5.6e-7,
                               .m = 0.5,
                               .talus_slope = std::tan(30 * std::numbers::pi / 180),
                               .receiver = terrain::Receiver::lowest}};
    auto state = evolve::initial_state(support::rough_start(setting, 0.01, 1));
    Meter stepping;
    evolve::simulate(mesh, model, setting, {.step_yr = 250000, .max_steps = 1, .convergence = 0}, state);
    stepping.print("first step", mesh.size());
    evolve::simulate(mesh, model, setting, {.step_yr = 250000, .max_steps = 101, .convergence = 0}, state);
    stepping.print("the next 100 steps", mesh.size());
}

}  // namespace

int main(int argc, char** argv) {
    fmt::print("part,nodes,calls,bytes\n");
    for (int i = 1; i < argc; ++i) measure(static_cast<Index>(std::stoul(argv[i])));
    return EXIT_SUCCESS;
}
