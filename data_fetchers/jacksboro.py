#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert matplotlib's sample elevation model of the Jacksboro fault into validation/data/jacksboro.tif.

Needs Debian's python-matplotlib-data (the source), python3-numpy and python3-gdal. The result is committed; run this
only to see where it comes from, or to check that it still does:

    /usr/bin/python3 data_fetchers/jacksboro.py [--source FILE.npz] [--out FILE.tif]

The source holds heights without a coordinate system and says: ymin = 36.7329 and ymax = 36.44625 degrees. Those two are
not merely swapped. `ymax` is the northern edge, and `ymin` is ymax + rows * dy where ymax - rows * dy was meant. Read
that way every landmark lies where maps have it (see LANDMARKS); read as a swap, 32 km further north, none does.
"""
import argparse
import hashlib
import json
import os
import sys

import numpy as np
from osgeo import gdal, osr

gdal.UseExceptions()

SOURCE = "/usr/share/matplotlib/mpl-data/sample_data/jacksboro_fault_dem.npz"
TARGET = os.path.join(os.path.dirname(__file__), "..", "validation", "data", "jacksboro.tif")

# Name, latitude, longitude (degrees), published height (m), cells to search around it, what to look for there. Places
# and heights as the US Geographic Names Information System and Wikipedia give them; the lake's is its summer level, and
# the shuttle flew in winter, when it is kept about 6 m lower.
LANDMARKS = [
    ("Cross Mountain, summit", 36.19833, -84.23056, 1077, 1, np.max),
    ("Jacksboro", 36.33151, -84.18879, 335, 3, np.median),
    ("Rocky Top", 36.22417, -84.15583, 265, 3, np.median),
    ("Norris Lake, near its dam", 36.22900, -84.08500, 311, 1, np.min),
]
HEIGHT_TOLERANCE_M = 12


def read_source(path):
    """Heights (row 0 in the north), western and northern edge and cell size in degrees."""
    data = np.load(path)
    heights = data["elevation"]
    west, north, cell = float(data["xmin"]), float(data["ymax"]), float(data["dx"])
    if abs(west + heights.shape[1] * cell - float(data["xmax"])) > 1e-9:
        sys.exit("xmin and xmax are not the edges of the outer cells: the source has changed")
    return heights, west, north, cell


def check_landmarks(heights, west, north, cell):
    """What the grid shows at each landmark; exits when the grid does not lie where it should."""
    rows = []
    for name, lat, lon, published, reach, pick in LANDMARKS:
        row, col = int((north - lat) / cell), int((lon - west) / cell)
        around = heights[max(row - reach, 0):row + reach + 1, max(col - reach, 0):col + reach + 1]
        found = int(pick(around))
        if abs(found - published) > HEIGHT_TOLERANCE_M:
            sys.exit(f"{name}: {found} m in the grid, {published} m published: wrongly placed")
        rows.append({"name": name, "latitude_deg": lat, "longitude_deg": lon,
                     "published_m": published, "grid_m": found})
    return rows


def write_geotiff(path, heights, west, north, cell):
    options = ["COMPRESS=DEFLATE", "PREDICTOR=2", "ZLEVEL=9"]
    rows, cols = heights.shape
    file = gdal.GetDriverByName("GTiff").Create(path, cols, rows, 1, gdal.GDT_Int16, options)
    file.SetGeoTransform([west, cell, 0, north, 0, -cell])
    system = osr.SpatialReference()
    system.ImportFromEPSG(4326)
    file.SetProjection(system.ExportToWkt())
    file.GetRasterBand(1).SetDescription("elevation, m")
    file.GetRasterBand(1).WriteArray(heights)
    file.FlushCache()


def sha256(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def provenance(source, target, heights, west, north, cell, landmarks):
    rows, cols = heights.shape
    return {
        "file": os.path.basename(target),
        "sha256": sha256(target),
        "title": "Jacksboro fault, Pine Mountain and Norris Lake, Cumberland Mountains, Tennessee",
        "data": "Shuttle Radar Topography Mission (SRTM), 3 arc-seconds, NASA and USGS, flown in February 2000",
        "licence": "public domain (SRTM)",
        "citation": "NASA Shuttle Radar Topography Mission (SRTM), 3 arc-seconds, flown in February 2000",
        "obtained_from": "Debian package python-matplotlib-data, file " + SOURCE,
        "added_there_by": "https://github.com/matplotlib/matplotlib/pull/3291 (SRTM elevation data, public domain)",
        "source_sha256": sha256(source),
        "converted_by": "data_fetchers/jacksboro.py: heights unchanged, coordinates added",
        "crs": "EPSG:4326",
        "vertical": "metres above the EGM96 geoid",
        "rows": rows,
        "cols": cols,
        "cell_deg": cell,
        "bbox_deg": {"west": west, "south": north - rows * cell, "east": west + cols * cell, "north": north},
        "elevation_min_m": int(heights.min()),
        "elevation_max_m": int(heights.max()),
        "georeferencing": "The source's ymax is the northern edge; its ymin is ymax + rows*dy, a sign error for "
                          "ymax - rows*dy. Row 0 is the northern row. Checked at the landmarks below.",
        "landmarks": landmarks,
    }


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--source", default=SOURCE)
    arguments.add_argument("--out", default=os.path.normpath(TARGET))
    options = arguments.parse_args()
    heights, west, north, cell = read_source(options.source)
    landmarks = check_landmarks(heights, west, north, cell)
    write_geotiff(options.out, heights, west, north, cell)
    with open(options.out + ".json", "w", encoding="utf-8") as file:
        json.dump(provenance(options.source, options.out, heights, west, north, cell, landmarks), file, indent=2)
        file.write("\n")


if __name__ == "__main__":
    main()
