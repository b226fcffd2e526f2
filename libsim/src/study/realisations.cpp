// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/realisations.hpp"

#include "study/results.hpp"
#include "thalweg/study/grow.hpp"
#include "thalweg/study/simulate.hpp"

namespace thalweg::study {
namespace {

/// Only the heightfield is wanted.
void write_less(Experiment& e) {
    e.output.heightmap.reset();
    e.output.mesh_file.reset();
    e.output.heightfield_mesh_file.reset();
    e.output.solid = false;
    e.output.base_depth_m.reset();
    e.output.snapshots_every.reset();
    e.output.checkpoint_every.reset();
    e.output.frames = 0;
}

}  // namespace

NamedRaster realisation(const std::filesystem::path& model, Index number, const std::filesystem::path& scratch) {
    Experiment e = read_experiment(model / "experiment.toml", {});
    e.seed += number;
    write_less(e);
    std::filesystem::create_directory(scratch);
    if (kind_of(model) == ResultKind::grown) {
        grow(e, scratch, {});
    } else {
        simulate(e, scratch, {});
    }
    NamedRaster made = read_dem(scratch / "elevation.tif", {}, {});
    std::filesystem::remove_all(scratch);
    return made;
}

}  // namespace thalweg::study
