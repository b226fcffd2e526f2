// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "thalweg/core/raster.hpp"

namespace thalweg::io {

/// A picture or map of any quantity: uplift, rain, rock, heights.
struct Image {
    Index rows = 0;
    Index cols = 0;
    std::vector<double> values;  ///< row 0 in the north; NaN is no data
    bool placed = false;         ///< the file says where it lies, so that `placement` means something
    Placement placement = {};

    /// Largest value; NaN if there is no data at all.
    double largest() const;
};

/// The values of any raster that GDAL reads, and of PGM and PPM pictures in ASCII (P2 and P3), which GDAL does not. Of
/// a coloured picture (red, green and blue, or a palette) the value is the mean of the three colours; else that of the
/// first band, scale and offset applied. Nodata, masked and wholly transparent cells become NaN.
/// Throws Error, one sentence, for what is no raster, damaged, empty, rotated, or no larger than memory allows.
Image read_image(const std::filesystem::path&);

/// Bilinear between the centres of cells, as on the edge of the image beyond its outermost centres. The place is given
/// in columns and rows from the image's north-west corner. Cells without data are left out and the others' shares
/// raised; NaN where the cell that holds the place, or all four, are without, and outside the image.
double bilinear(const Image&, double column, double row);

}  // namespace thalweg::io
