// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "io/gdal_guard.hpp"
#include "thalweg/io/raster_file.hpp"

namespace thalweg::io {

/// A view of the band and the window that the options ask for, through GDAL's virtual format; null where they ask for
/// the first band and all of it. Cells are kept whole: those whose middle lies in the window. The dataset must live as
/// long as the view. Throws Error for a band that is not there and a window beside the raster.
DatasetPtr window_of(GDALDataset&, const std::string& name, const ReadOptions&);

/// A copy of the raster in GDAL's memory, NaN being no data.
DatasetPtr dataset_over(const Raster&);

/// The raster on the cells that the options ask for, in memory: in another coordinate system, or with cells of another
/// size, by GDAL's warper. Heights are bilinear between cells or, where the new cells are twice as wide or more, means over them; voids
/// take part in neither. Throws Error for a system that GDAL does not know.
DatasetPtr warped(const Raster&, const std::string& name, const ReadOptions&);

/// The raster on so many cells over the same ground, in memory, interpolated in the same ways.
DatasetPtr on_cells(const Raster&, Index rows, Index cols);

}  // namespace thalweg::io
