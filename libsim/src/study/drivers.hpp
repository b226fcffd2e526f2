// SPDX-License-Identifier: GPL-3.0-or-later
// Private: what an experiment says about uplift, rain, rock and the initial surface, at the nodes of a domain.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "thalweg/evolve/tectonics.hpp"
#include "thalweg/study/domain.hpp"

namespace thalweg::study {

/// The nodes, on their plane and on the map, before anything happens to them.
struct Nodes {
    std::vector<Point> plane_m;        ///< Domain::positions_m
    std::vector<Point> map;            ///< in the domain's coordinate system
    std::vector<std::uint8_t> inside;  ///< 0 for cells of a raster beside the domain
    evolve::Box box_m;                 ///< around the domain, on the plane
    std::string crs_wkt;               ///< of the map; empty: the domain lies nowhere in particular, map is plane
    double unit_m = 1;                 ///< of the map where it is no raster's
    const Raster* raster = nullptr;    ///< whose cells the nodes are; else they are points of the plane
};

/// An image's values at the nodes, by coordinates where both have a place, else stretched over the box, north up.
/// Appends to the warnings where a placed image is stretched. Throws Error where it has no data at a node inside.
/// `key` begins every sentence.
std::vector<double> image_at(const std::string& key, const std::filesystem::path&, const Nodes&,
                             std::vector<std::string>& warnings);

/// The variation times `maximum`, at every node.
std::vector<double> varied(const std::string& table, const Variation&, double maximum, std::uint64_t seed, const Nodes&,
                           std::vector<std::string>& warnings);

/// The erodibility relative to river.k; empty where it is the same everywhere.
std::vector<double> relative_erodibility(const Experiment&, const Nodes&, std::vector<std::string>& warnings);

/// Heights at the start, from an image, or roughness on a constant above base level. NaN outside.
std::vector<double> initial_surface(const Experiment&, const Nodes&, double extent_m, double base_level_m,
                                    std::vector<std::string>& warnings);

}  // namespace thalweg::study
