# SPDX-License-Identifier: GPL-3.0-or-later
"""From tiles to one grid: which grid, tiles laid onto it cell for cell where they fit and bilinearly where they do not,
voids, reprojection, outline."""
import math
from dataclasses import dataclass

import numpy as np
from osgeo import gdal, gdal_array, ogr, osr

import reader
from problems import UserError
from region import Box, bounds_in, lonlat, wgs84

#: Of a cell: what transformations and rounding of geotransforms may shift without meaning it.
TOLERANCE = 1e-3
ALIGNED = 0.02
#: Cells that filling looks across.
FILL_REACH = 100


@dataclass(frozen=True)
class Grid:
    """North-up cells; west and north are outer edges."""
    west: float
    north: float
    dx: float
    dy: float  #: above 0
    cols: int
    rows: int
    wkt: str

    def transform(self):
        return [self.west, self.dx, 0.0, self.north, 0.0, -self.dy]

    def system(self):
        return lonlat(osr.SpatialReference(wkt=self.wkt))

    def bounds(self):
        return self.west, self.north - self.rows * self.dy, self.west + self.cols * self.dx, self.north


def cells_inside(bounds, transform, wkt):
    """The grid of those cells of a lattice whose centres lie in the bounds, the northern and western sides belonging to
    it, so that boxes side by side share no cell and the box of a one-degree tile gives that tile."""
    west, south, east, north = bounds
    dx, dy = transform[1], -transform[5]
    x, y = transform[0] + dx / 2, transform[3] - dy / 2
    first_col, last_col = (math.ceil((side - x) / dx - TOLERANCE) for side in (west, east))
    first_row, last_row = (math.ceil((y - side) / dy - TOLERANCE) for side in (north, south))
    cols, rows = last_col - first_col, last_row - first_row
    if cols < 2 or rows < 2:
        raise UserError(f"the box holds {max(cols, 0)} x {max(rows, 0)} cells of this source; it needs at least 2 x 2")
    return Grid(transform[0] + first_col * dx, transform[3] - first_row * dy, dx, dy, cols, rows, wkt)


def native_grid(box, records):
    """The grid of the finest of those tiles whose coordinate system has the most of the box; None where no tile has any."""
    parts = [(record, _share(record, box)) for record in records]
    there = [(record, share) for record, share in parts if share > 0]
    if not there:
        return None
    shares = {}
    for record, share in there:
        shares[record["wkt"]] = shares.get(record["wkt"], 0) + share
    wkt = max(sorted(shares), key=shares.get)
    finest = min((record for record, _ in there if record["wkt"] == wkt),
                 key=lambda r: (-r["transform"][1] * r["transform"][5], r["name"]))
    return cells_inside(bounds_in((box.west, box.south, box.east, box.north), wgs84(), reader.system_of(finest)),
                        finest["transform"], wkt)


def extent(record):
    west, dx, _, north, _, dy = record["transform"]
    return west, north + record["height"] * dy, west + record["width"] * dx, north


def _share(record, box):
    """Square degrees of the box under a tile and the cell around it: lattices may begin half a cell beside a degree."""
    west, south, east, north = extent(record)
    dx, dy = record["transform"][1], -record["transform"][5]
    around = (west - dx, south - dy, east + dx, north + dy)
    west, south, east, north = bounds_in(around, reader.system_of(record), wgs84())
    return max(0, min(east, box.east) - max(west, box.west)) * max(0, min(north, box.north) - max(south, box.south))


def projected_grid(box, crs, cell_m):
    """The grid of --crs: `utm`, `equal-area` or what PROJ knows, its edges on multiples of the cell."""
    system = _system(box, crs)
    size = cell_m
    if system.IsGeographic():
        size = cell_m / 111319.49
    elif system.GetLinearUnits() != 1:
        size = cell_m / system.GetLinearUnits()
    west, south, east, north = bounds_in((box.west, box.south, box.east, box.north), wgs84(), system)
    left, bottom = math.floor(west / size + TOLERANCE), math.floor(south / size + TOLERANCE)
    right, top = math.ceil(east / size - TOLERANCE), math.ceil(north / size - TOLERANCE)
    if right - left < 2 or top - bottom < 2:
        raise UserError("the region holds fewer than 2 x 2 cells of this source")
    return Grid(left * size, top * size, size, size, right - left, top - bottom, system.ExportToWkt())


def _system(box, crs):
    longitude, latitude = box.centre()
    if crs == "utm":
        if not -80 <= latitude <= 84:
            raise UserError("UTM ends at 80 S and 84 N; use --crs equal-area")
        zone = min(60, int((longitude + 180) // 6) + 1)
        return lonlat(osr.SpatialReference(), f"EPSG:{(32600 if latitude >= 0 else 32700) + zone}")
    if crs == "equal-area":
        return lonlat(osr.SpatialReference(), f"+proj=laea +lat_0={latitude:.1f} +lon_0={longitude:.1f} +datum=WGS84 +units=m")
    try:
        system = lonlat(osr.SpatialReference(), crs)
    except RuntimeError:
        raise UserError(f"--crs is utm, equal-area or a code like EPSG:32617, not '{crs}'") from None
    if not (system.IsProjected() or system.IsGeographic()):
        raise UserError(f"--crs '{crs}' is neither projected nor geographic")
    return system


def box_under(grid, margin_cells):
    """The box in degrees that a grid needs, with a margin for interpolation."""
    west, south, east, north = grid.bounds()
    x, y = margin_cells * grid.dx, margin_cells * grid.dy
    found = bounds_in((west - x, south - y, east + x, north + y), grid.system(), wgs84())
    if found[0] >= found[2]:
        raise UserError("the region crosses the antimeridian in that projection; choose another --crs or a smaller box")
    return Box(max(found[0], -180), max(found[1], -90), min(found[2], 180), min(found[3], 90))


def window_of(record, bounds_deg, margin=2):
    """The cells of a tile that bounds in degrees touch, or None."""
    west, south, east, north = bounds_in(bounds_deg, wgs84(), reader.system_of(record))
    left, dx, _, top, _, dy = record["transform"]
    x0, x1 = math.floor((west - left) / dx) - margin, math.ceil((east - left) / dx) + margin
    y0, y1 = math.floor((north - top) / dy) - margin, math.ceil((south - top) / dy) + margin
    if x1 - margin <= 0 or y1 - margin <= 0 or x0 + margin >= record["width"] or y0 + margin >= record["height"]:
        return None
    x0, y0, x1, y1 = max(x0, 0), max(y0, 0), min(x1, record["width"]), min(y1, record["height"])
    return reader.Window(x0, y0, x1 - x0, y1 - y0)


class Canvas:
    """Heights on a grid, NaN where nothing was laid; and where any tile reached."""

    def __init__(self, grid, dtype):
        self.grid = grid
        self.heights = np.full((grid.rows, grid.cols), np.nan, dtype)
        self.covered = np.zeros((grid.rows, grid.cols), np.uint8)

    def lay(self, record, window, heights):
        """Puts a window of a tile down; what has no data leaves what lies below."""
        left, dx, _, top, _, dy = record["transform"]
        west, north = left + window.x * dx, top + window.y * dy
        col, row = (west - self.grid.west) / self.grid.dx, (self.grid.north - north) / self.grid.dy
        same = record["wkt"] == self.grid.wkt
        drift = max(abs(dx / self.grid.dx - 1) * window.wide, abs(-dy / self.grid.dy - 1) * window.tall)
        if same and drift < ALIGNED and max(abs(col - round(col)), abs(row - round(row))) < ALIGNED:
            self._paste(round(col), round(row), heights, None)
        else:
            self._warp(record, (west, dx, 0, north, 0, dy), heights)

    def _paste(self, col, row, heights, reached):
        c0, r0 = max(col, 0), max(row, 0)
        c1, r1 = min(col + heights.shape[1], self.grid.cols), min(row + heights.shape[0], self.grid.rows)
        if c0 >= c1 or r0 >= r1:
            return
        part = heights[r0 - row:r1 - row, c0 - col:c1 - col]
        below = self.heights[r0:r1, c0:c1]
        np.copyto(below, part, where=np.isfinite(part), casting="same_kind")
        covered = self.covered[r0:r1, c0:c1]
        covered |= 1 if reached is None else reached[r0 - row:r1 - row, c0 - col:c1 - col]

    def _warp(self, record, transform, heights):
        """Bilinear, onto the part of the grid under the tile."""
        source = _raster(heights, transform, record["wkt"])
        bounds = (transform[0], transform[3] + heights.shape[0] * transform[5],
                  transform[0] + heights.shape[1] * transform[1], transform[3])
        west, south, east, north = bounds_in(bounds, reader.system_of(record), self.grid.system())
        g = self.grid
        c0, c1 = max(0, math.floor((west - g.west) / g.dx)), min(g.cols, math.ceil((east - g.west) / g.dx))
        r0, r1 = max(0, math.floor((g.north - north) / g.dy)), min(g.rows, math.ceil((g.north - south) / g.dy))
        if c0 >= c1 or r0 >= r1:
            return
        place = [g.west + c0 * g.dx, g.dx, 0, g.north - r0 * g.dy, 0, -g.dy]
        found = resampled(source, place, (r1 - r0, c1 - c0), g.wkt, "bilinear", heights.dtype)
        self._paste(c0, r0, found, np.isfinite(found).astype(np.uint8))

    def fill_voids(self):
        """Interpolates over voids inside tiles from their rims (GDAL's inverse distances); the number of cells filled.
        Where no tile is, nothing is filled: that is sea, or beyond the coverage."""
        voids = np.isnan(self.heights) & (self.covered == 1)
        if not voids.any() or voids.all():
            return 0
        mask = np.isfinite(self.heights).astype(np.uint8)
        self.heights[mask == 0] = -9999
        target = gdal_array.OpenArray(self.heights)
        known = gdal_array.OpenArray(mask)
        gdal.FillNodata(target.GetRasterBand(1), known.GetRasterBand(1), FILL_REACH, 0)
        target.FlushCache()
        self.heights = np.where(mask == 1, self.heights, target.ReadAsArray())
        self.heights[(self.covered == 0) | (self.heights == -9999)] = np.nan
        return int((voids & np.isfinite(self.heights)).sum())

    def moved_to(self, grid):
        """The same on another grid, heights bilinearly."""
        result = Canvas(grid, self.heights.dtype)
        shape = (grid.rows, grid.cols)
        result.heights = resampled(_raster(self.heights, self.grid.transform(), self.grid.wkt), grid.transform(), shape,
                                   grid.wkt, "bilinear", self.heights.dtype)
        result.covered = resampled(_raster(self.covered, self.grid.transform(), self.grid.wkt), grid.transform(), shape,
                                   grid.wkt, "near", np.uint8)
        return result

    def keep_inside(self, polygons):
        """Removes what lies outside an outline given in degrees; where the outline is, as booleans."""
        outline = polygons.Clone()
        system = self.grid.system()
        if not system.IsSame(wgs84()):
            outline.Transform(osr.CoordinateTransformation(wgs84(), system))
        layer_source = ogr.GetDriverByName("Memory").CreateDataSource("outline")
        layer = layer_source.CreateLayer("outline", system, ogr.wkbMultiPolygon)
        feature = ogr.Feature(layer.GetLayerDefn())
        feature.SetGeometry(outline)
        layer.CreateFeature(feature)
        inside = _raster(np.zeros(self.heights.shape, np.uint8), self.grid.transform(), self.grid.wkt)
        gdal.RasterizeLayer(inside, [1], layer, burn_values=[1])
        where = inside.ReadAsArray() == 1
        self.heights[~where] = np.nan
        return where


def _raster(values, transform, wkt):
    """A copy in memory as GDAL sees it."""
    code = gdal_array.NumericTypeCodeToGDALTypeCode(values.dtype.type)
    data = gdal.GetDriverByName("MEM").Create("", values.shape[1], values.shape[0], 1, code)
    data.SetGeoTransform(list(transform))
    data.SetSpatialRef(lonlat(osr.SpatialReference(wkt=wkt)))
    data.GetRasterBand(1).WriteArray(values)
    if values.dtype.kind == "f":
        data.GetRasterBand(1).SetNoDataValue(math.nan)
    return data


def resampled(source, transform, shape, wkt, method, dtype):
    empty = np.full(shape, np.nan, dtype) if np.dtype(dtype).kind == "f" else np.zeros(shape, dtype)
    target = _raster(empty, transform, wkt)
    gdal.Warp(target, source, resampleAlg=method, errorThreshold=0, multithread=False)
    return target.ReadAsArray()
