// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "thalweg/grow/surface_mesh.hpp"
#include "thalweg/study/growth_site.hpp"
#include "thalweg/surface/minimum_norm_network.hpp"

namespace thalweg::study {

/// The surface under tension over a grown network. Its patches are not kept: made where they are needed they take a
/// moment, and kept half of the memory (`surface::tension_patches` of `tension_mesh()` and `network`).
struct GrownSurface {
    grow::SurfaceMesh mesh;
    std::vector<double> tension;  ///< per vertex
    std::vector<surface::ExtraTension> extra_tension;
    surface::MinimumNormNetwork network;
    Index limited_gradients = 0;  ///< vertices whose gradient was cut to that of the steepest valley side

    grow::Thalweg thalweg = grow::Thalweg::along_channel;

    surface::TensionMesh tension_mesh() const {
        surface::TensionMesh m{mesh.x, mesh.y, mesh.height, tension, mesh.triangles, extra_tension};
        if (thalweg == grow::Thalweg::along_channel) {
            m.given_slope_x = mesh.channel_slope_x;
            m.given_slope_y = mesh.channel_slope_y;
        }
        return m;
    }
};

/// A network and its terrain.
struct GrownTerrain {
    GrowthSite site;
    grow::Dials dials;
    grow::Growth growth;
    std::vector<grow::Network>
        stages;  ///< of the growth, the last one whole; none unless `output.frames` asks for them
    channel::StreamNetwork tree;
    GrownSurface surface;
    Raster elevation;  ///< on the map; NaN outside the basin
    struct {
        double grow, triangulate, gradients, evaluate;
    } seconds;
};

/// The longest piece into which lines are cut for the surface: half the constant of channel maintenance, which is about
/// the width of a valley side.
double surface_spacing_m(const grow::Dials&);

/// Grows the network that an experiment describes on a site, and the surface over it on `output.resolution` cells along
/// the longer side (default 512). Deterministic: same experiment, same bytes, for any number of threads.
GrownTerrain grown_terrain(const Experiment&, GrowthSite, const Messages&);

/// How a grown terrain is measured like a DEM: water leaves by the cell at the trunk's outlet alone, and channels begin
/// at the drainage area that gives them the length of the tree.
MeasureOptions measure_options(const GrownTerrain&);

/// Cells of a grown terrain's raster in which its links begin.
ChannelHeads grown_heads(const GrownTerrain&);

/// Grows and writes summary.json, frames/ with `output.frames`, network.gpkg, elevation.tif, mesh.obj, the CSVs of the
/// measured terrain and the resolved experiment.toml into an existing folder. Returns the text of summary.json. Throws
/// Error as `growth_site`, `dials_of` and `grow::grow`.
std::string grow(const Experiment&, const std::filesystem::path& folder, const Messages&);

/// The same in the basin of a catchment that has been cut out already.
std::string grow(const Experiment&, const Catchment&, const std::filesystem::path& folder, const Messages&);

}  // namespace thalweg::study
