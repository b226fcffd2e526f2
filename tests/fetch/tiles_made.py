# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles in the layouts and under the names of the real sources, of a made-up terrain: height_at says what any cell holds."""
import os

import numpy as np
from osgeo import gdal, osr

gdal.UseExceptions()
gdal.SetConfigOption("GDAL_PAM_ENABLED", "NO")


def height_at(longitude, latitude):
    """Metres, in steps of 1/8 so that float32 and compression hold them well; hills and one plane."""
    hills = 300 * np.sin(longitude * 37.0) * np.cos(latitude * 41.0) + 40 * np.sin(longitude * 311.0 + latitude * 201.0)
    return np.round((1500 + 200 * (latitude - np.floor(latitude / 10) * 10) + hills) * 8) / 8


def cells(west, north, dx, dy, cols, rows):
    longitude = west + (np.arange(cols) + 0.5) * dx
    latitude = north - (np.arange(rows) + 0.5) * dy
    return height_at(longitude[None, :], latitude[:, None])


def write(path, heights, transform, epsg, nodata=None, driver="COG", options=()):
    """A COG with the usual inner blocks; the folder is made."""
    os.makedirs(os.path.dirname(path), exist_ok=True)
    code = {"float32": gdal.GDT_Float32, "int16": gdal.GDT_Int16}[heights.dtype.name]
    memory = gdal.GetDriverByName("MEM").Create("", heights.shape[1], heights.shape[0], 1, code)
    memory.SetGeoTransform(transform)
    system = osr.SpatialReference()
    system.ImportFromEPSG(epsg)
    memory.SetSpatialRef(system)
    memory.GetRasterBand(1).WriteArray(heights)
    if nodata is not None:
        memory.GetRasterBand(1).SetNoDataValue(nodata)
    if driver == "COG":
        options = ["COMPRESS=DEFLATE", "LEVEL=1", "BLOCKSIZE=512", "OVERVIEWS=NONE", *options]
    gdal.GetDriverByName(driver).CreateCopy(path, memory, options=list(options))


def corner(south, west):
    return f"{'S' if south < 0 else 'N'}{abs(south):02d}", f"{'W' if west < 0 else 'E'}{abs(west):03d}"


def copernicus(folder, arc_seconds, south, west, cols=None, change=lambda heights: heights):
    """One tile as the open-data buckets keep it: cell centres on whole degrees in the north and west, so that the edges
    lie half a cell outside; above 50 degrees wider cells."""
    count = 3600 // arc_seconds
    cols = cols or count
    dx, dy = 1 / cols, 1 / count
    left, top = west - dx / 2, south + 1 + dy / 2
    ns, ew = corner(south, west)
    name = f"Copernicus_DSM_COG_{arc_seconds * 10}_{ns}_00_{ew}_00_DEM"
    heights = change(cells(left, top, dx, dy, cols, count).astype(np.float32))
    write(f"{folder}/{name}/{name}.tif", heights, (left, dx, 0, top, 0, -dy), 4326)
    with open(f"{folder}/tileList.txt", "a", encoding="utf-8") as file:
        file.write(name + "\n")
    return name


def three_dep_13(folder, north, west, cell=1 / 1200, listed=True):
    """One tile as USGS stages it: NAD83, named by its north-western corner, six cells of overlap on every side. The cells
    are coarser than 1/3 arc-second, to be quick."""
    name = f"n{north:02d}w{-west:03d}"
    count = round(1 / cell) + 12
    left, top = west - 6 * cell, north + 6 * cell
    heights = cells(left, top, cell, cell, count, count).astype(np.float32)
    heights[300:310, 400:405] = -999999
    write(f"{folder}/current/{name}/USGS_13_{name}.tif", heights, (left, cell, 0, top, 0, -cell), 4269, -999999)
    if listed:
        with open(f"{folder}/USGS_Seamless_DEM_13.vrt", "a", encoding="utf-8") as file:
            file.write(f"<SourceFilename>/vsicurl/x/{name}/USGS_13_{name}.tif</SourceFilename>\n")
    return name


def hgt(path, south, west, void=False):
    """An SRTM tile of 3 arc-seconds: big-endian whole metres, rows and columns on the degrees shared with neighbours."""
    os.makedirs(os.path.dirname(path), exist_ok=True)
    cell = 1 / 1200
    heights = np.round(cells(west - cell / 2, south + 1 + cell / 2, cell, cell, 1201, 1201)).astype(">i2")
    if void:
        heights[100:110, 200:220] = -32768
    content = heights.tobytes()
    with open(path, "wb") as file:
        file.write(content)
    return content
