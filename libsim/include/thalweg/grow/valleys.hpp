// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "thalweg/channel/divides.hpp"
#include "thalweg/channel/growth_measures.hpp"
#include "thalweg/channel/links.hpp"
#include "thalweg/channel/valleys.hpp"
#include "thalweg/grow/links.hpp"

namespace thalweg::grow {

/// Displacements between the vertices of a grown network, which must outlive the function.
channel::OffsetOf offsets(const Network&);

/// From each link's source straight on to the divide (m); 0 for interior links. As channel::beyond_sources on a raster.
std::vector<double> beyond_sources(const Network&);

/// Ridges of the valley sides, as channel::ridge_pieces has them on a raster: the sides of the drainage polygons but
/// for channels and for the line that goes on beyond a source, straight between their ends in height too, compared with
/// the nearest point of the link. Each is cut into eight pieces. `elevation_m` per vertex.
std::vector<channel::RidgePiece> ridge_pieces(const Network&, std::span<const double> elevation_m);

/// The three divides of every junction by their first piece, which is as it was drawn. As channel::junction_divides on
/// a raster. Where tributaries' lines happen to end in a junction, what lies between the same two links is left out.
std::vector<channel::JunctionDivide> junction_divides(const Network&);

/// What a DEM's rivers and valleys would be measured by, on the grown tree itself.
channel::GrowthMeasures growth_measures(const Network&, std::span<const double> elevation_m);

}  // namespace thalweg::grow
