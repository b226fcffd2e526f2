#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Thalweg beside SAGA, GRASS and slow code of a few lines: saga_grass.py THALWEG [--dems FOLDER] [DEM ...]

Compares cell for cell
- the filled surface with SAGA's Fill Sinks XXL (Wang & Liu 2006, minimum slope 0) and with a flood by a priority queue;
- D8 directions, drainage areas and Strahler orders with SAGA's, and areas with a count level by level;
- drainage areas with GRASS's r.watershed -s.

The last two on the DEM with noise of under half its vertical step, filled with a slope by SAGA: without flats and (but for
a few, which are counted) without ties, so that there is one right answer. Programs treat the raster's edge each in their
own way, and r.watershed searches its own way through what was filled; so what lies downstream of the edge, of ties, and for
GRASS of filled cells and of other directions, is left out, and it is told how much is left.

The embedded DEM, put on a plane of 90 m cells, is always compared. Others are looked for in --dems or in the folder that
the environment variable THALWEG_DEM_DIR names. Where a program is missing its comparisons are skipped; with nothing to
compare the script ends with 77, which ctest shows as skipped.
"""
import argparse
import heapq
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from osgeo import gdal

gdal.UseExceptions()

EMBEDDED = Path(__file__).parent / "data" / "jacksboro.tif"
DEMS = ("big_tujunga_srtm_30m.tif", "spearfish_usgs_30m.tif", "raleigh_ned_30m.tif", "pozo_gully_lidar_1m.tif",
        "mandakini_srtm_89m.bil", "zion_srtm_3arcsec.tif")
SKIPPED = 77
NODATA = -99999.0
# Rows and columns to the neighbours clockwise from the north, as SAGA numbers them; ESRI's and GRASS's codes for them.
ROW, COL = (-1, -1, 0, 1, 1, 1, 0, -1), (0, 1, 1, 1, 0, -1, -1, -1)
ESRI = {64: 0, 128: 1, 1: 2, 2: 3, 4: 4, 8: 5, 16: 6, 32: 7}
GRASS = {2: 0, 1: 1, 8: 2, 7: 3, 6: 4, 5: 5, 4: 6, 3: 7}


def read(path):
    dataset = gdal.Open(str(path))
    band = dataset.GetRasterBand(1)
    cells = band.ReadAsArray().astype(np.float64)
    nodata = band.GetNoDataValue()
    if nodata is not None:
        cells[cells == nodata] = np.nan
    return cells, dataset.GetGeoTransform(), dataset.GetProjection()


def write(path, cells, transform, projection):
    rows, cols = cells.shape
    dataset = gdal.GetDriverByName("GTiff").Create(str(path), cols, rows, 1, gdal.GDT_Float64)
    dataset.SetGeoTransform(transform)
    dataset.SetProjection(projection)
    dataset.GetRasterBand(1).SetNoDataValue(NODATA)
    dataset.GetRasterBand(1).WriteArray(np.where(np.isnan(cells), NODATA, cells))


def call(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{command[0]} failed:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")


def neighbours(shape, row, col):
    for dr, dc in zip(ROW, COL):
        if 0 <= row + dr < shape[0] and 0 <= col + dc < shape[1]:
            yield row + dr, col + dc


def border(cells):
    """Cells with data on the raster's edge or beside a cell without data."""
    data = np.pad(~np.isnan(cells), 1)
    inside = data[1:-1, 1:-1].copy()
    for dr, dc in zip(ROW, COL):
        inside &= data[1 + dr:data.shape[0] - 1 + dr, 1 + dc:data.shape[1] - 1 + dc]
    return data[1:-1, 1:-1] & ~inside


def flooded(cells):
    """Barnes, Lehman & Mulla's (2014) flood from the border."""
    level, done = cells.copy(), np.isnan(cells)
    queue = [(cells[at], at) for at in map(tuple, np.argwhere(border(cells)))]
    done[border(cells)] = True
    heapq.heapify(queue)
    while queue:
        height, (row, col) = heapq.heappop(queue)
        for at in neighbours(cells.shape, row, col):
            if not done[at]:
                done[at] = True
                level[at] = max(level[at], height)
                heapq.heappush(queue, (level[at], at))
    return level


def receivers(slots):
    """Flat number of the cell each one flows to, −1 for none."""
    rows, cols = slots.shape
    numbers = np.arange(rows * cols).reshape(rows, cols)
    target = np.full((rows, cols), -1)
    for slot in range(8):
        at = np.argwhere(slots == slot)
        to = at + (ROW[slot], COL[slot])
        kept = (to >= 0).all(1) & (to < (rows, cols)).all(1)
        target[tuple(at[kept].T)] = numbers[tuple(to[kept].T)]
    return target.ravel()


def counted(slots, data):
    """Cells upstream of and with each one: those with nothing left above them are added to the next below, and so on."""
    target, count = receivers(slots), data.ravel().astype(np.float64)
    waiting = np.bincount(target[target >= 0], minlength=target.size)
    ready = np.flatnonzero(waiting == 0)
    while ready.size:
        ready = ready[target[ready] >= 0]
        np.add.at(count, target[ready], count[ready])
        np.subtract.at(waiting, target[ready], 1)
        below = np.unique(target[ready])
        ready = below[waiting[below] == 0]
    return count.reshape(slots.shape)


def downstream(start, *directions):
    """Cells at or below the marked ones along any of the directions."""
    marked = start.copy()
    for slots in directions:
        target, front = receivers(slots), np.flatnonzero(marked)
        reached = marked.ravel()
        while front.size:
            front = np.unique(target[front][target[front] >= 0])  # each way down is followed for itself
            front = front[~reached[front]]
            reached[front] = True
    return marked


def translated(codes, table):
    slots = np.full(codes.shape, -1)
    for code, slot in table.items():
        slots[codes == code] = slot
    return slots


class Report:
    def __init__(self):
        self.failures = 0

    def line(self, dem, what, compared, differ, more=""):
        self.failures += differ > 0
        print(f"{dem:24} {what:44} {compared:9d} cells, {differ} differ{more}", flush=True)


class Study:
    """One DEM in a folder of its own."""

    def __init__(self, thalweg, path, folder, report):
        self.thalweg, self.folder, self.report = thalweg, folder, report
        self.name = path.stem
        self.cells, self.transform, self.projection = read(path)
        if path == EMBEDDED:
            self.transform, self.projection = (500000, 90, 0, 4000000, 0, -90), ""
        self.square = abs(self.transform[1] + self.transform[5]) < 1e-6 * self.transform[1]
        self.projected = self.transform[1] > 0.5
        self.dem = folder / "dem.tif"
        write(self.dem, self.cells, self.transform, self.projection)

    def analyze(self, dem, name, *options):
        out = self.folder / name
        call(self.thalweg, "analyze", dem, "--out", out, "--no-figures", "--quiet", *options)
        return lambda file: read(out / file)[0]

    def saga(self, library, tool, *options):
        call("saga_cmd", library, tool, *options)

    def compare_fill(self, has_saga):
        ours = self.analyze(self.dem, "plain")("filled.tif")
        data = ~np.isnan(self.cells)
        changed = f" ({np.sum(ours[data] > self.cells[data])} were filled)"
        self.report.line(self.name, "filled, by a priority queue", data.sum(),
                         np.sum(ours[data] != flooded(self.cells)[data]), changed)
        if has_saga:
            target = self.folder / "filled.sgrd"
            self.saga("ta_preprocessor", 5, "-ELEV", self.dem, "-FILLED", target, "-MINSLOPE", 0)
            self.report.line(self.name, "filled, by SAGA's Fill Sinks XXL", data.sum(),
                             np.sum(ours[data] != read(target.with_suffix(".sdat"))[0][data]))

    def prepare_unambiguous(self):
        """A surface with one way down from every cell, in single precision as SAGA keeps it."""
        steps = np.diff(np.unique(self.cells[~np.isnan(self.cells)]))
        noise = np.random.default_rng(1).uniform(0, 0.45 * np.median(steps) if steps.size < 5000 else 0.01,
                                                 self.cells.shape)
        self.rough = self.cells + noise
        write(self.folder / "rough.tif", self.rough, self.transform, self.projection)
        self.surface = self.folder / "surface.sgrd"
        self.saga("ta_preprocessor", 5, "-ELEV", self.folder / "rough.tif", "-FILLED", self.surface, "-MINSLOPE", 0.01)
        self.heights = read(self.surface.with_suffix(".sdat"))[0]
        self.data = ~np.isnan(self.heights)
        cell = abs(self.transform[1] * self.transform[5])
        ours = self.analyze(self.surface.with_suffix(".sdat"), "surface", "--keep-edge-basins", "--channel-area-m2",
                            0.5 * cell, *([] if self.projection else ["--crs", "EPSG:32616"]))
        self.slots = translated(ours("flow_direction.tif"), ESRI)
        self.area = np.nan_to_num(ours("drainage_area.tif") / cell)
        self.orders = ours("strahler.tif")

    def compare_count(self):
        differ = np.sum(np.abs(counted(self.slots, self.data) - self.area)[self.data] > 1e-6)
        self.report.line(self.name, "drainage area, by counting", self.data.sum(), differ)

    def compare_saga(self):
        at = {name: self.folder / (name + ".sgrd") for name in ("slots", "orders", "area")}
        self.saga("ta_channels", 5, "-DEM", self.surface, "-DIRECTION", at["slots"], "-ORDER", at["orders"], "-SEGMENTS",
                  self.folder / "links.shp", "-BASINS", self.folder / "basins.shp", "-THRESHOLD", 1)
        self.saga("ta_hydrology", 0, "-ELEVATION", self.surface, "-FLOW", at["area"], "-FLOW_UNIT", 0, "-METHOD", 0)
        theirs = {name: read(path.with_suffix(".sdat"))[0] for name, path in at.items()}
        inside = self.data & ~border(self.heights)
        other = inside & (theirs["slots"] != self.slots)
        ties = np.array([self.is_tie(at, theirs["slots"][at]) for at in map(tuple, np.argwhere(other))], bool)
        self.report.line(self.name, "D8 directions, by SAGA", inside.sum(), np.sum(~ties), f" ({ties.sum()} ties)")
        certain = self.data & ~downstream(border(self.heights) | other, self.slots, theirs["slots"])
        share = f", {certain.sum() / self.data.sum():.1%} of all"
        self.report.line(self.name, "D8 areas, by SAGA", certain.sum(),
                         np.sum(np.abs(theirs["area"] - self.area)[certain] > 1e-6),
                         f"{share}, up to {int(self.area[certain].max())} cells")
        self.report.line(self.name, "Strahler orders, by SAGA", certain.sum(),
                         np.sum(theirs["orders"][certain] != self.orders[certain]),
                         f"{share}, up to order {int(self.orders[certain].max())}")

    def is_tie(self, at, slot):
        """Whether two ways down are as steep, but for the rounding of single precision."""
        def slope(way):
            way = int(way)
            to = at[0] + ROW[way], at[1] + COL[way]
            length = np.hypot(ROW[way] * self.transform[5], COL[way] * self.transform[1])
            return (self.heights[at] - self.heights[to]) / length
        return 0 <= slot < 8 and abs(slope(slot) - slope(self.slots[at])) <= 1e-6 * max(1e-3, slope(slot))

    def compare_grass(self):
        script = ("r.in.gdal input={0}/surface.sdat output=h -o --quiet && g.region raster=h && "
                  "r.watershed -s elevation=h accumulation=a drainage=d --quiet && "
                  "r.out.gdal input=a output={0}/grass_area.tif type=Float64 -fc --quiet && "
                  "r.out.gdal input=d output={0}/grass_slots.tif type=Int16 -fc --quiet").format(self.folder)
        call("grass", "--tmp-location", "XY", "--exec", "bash", "-c", script)
        area = np.abs(read(self.folder / "grass_area.tif")[0])
        slots = translated(read(self.folder / "grass_slots.tif")[0], GRASS)
        filled = self.data & (self.heights > np.float32(self.rough))
        inside = self.data & ~border(self.heights) & ~filled
        other = inside & (slots != self.slots)
        certain = self.data & ~downstream(border(self.heights) | filled | other, self.slots, slots)
        self.report.line(self.name, "D8 areas, by GRASS's r.watershed -s", certain.sum(),
                         np.sum(np.abs(area - self.area)[certain] > 1e-6),
                         f", {certain.sum() / self.data.sum():.1%} of all, up to {int(self.area[certain].max())} cells; "
                         f"its search took another way in {other.sum() / inside.sum():.2%} of the unfilled cells")


def dems_of(arguments):
    if arguments.dem:
        return arguments.dem
    found = [EMBEDDED]
    folder = arguments.dems or os.environ.get("THALWEG_DEM_DIR")
    if folder:
        found += [Path(folder) / name for name in DEMS if (Path(folder) / name).is_file()]
    if len(found) == 1:
        print("saga_grass: no other DEMs; name their folder by --dems or THALWEG_DEM_DIR", flush=True)
    return found


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("thalweg", type=Path)
    parser.add_argument("dem", type=Path, nargs="*")
    parser.add_argument("--dems", type=Path)
    arguments = parser.parse_args()
    has_saga, has_grass = shutil.which("saga_cmd") is not None, shutil.which("grass") is not None
    for name, package, there in (("SAGA", "saga", has_saga), ("GRASS", "grass-core", has_grass)):
        if not there:
            print(f"saga_grass: {name} is missing, so it is not compared with; apt-get install {package}")
    if not has_saga:
        return SKIPPED
    report = Report()
    for path in dems_of(arguments):
        with tempfile.TemporaryDirectory() as folder:
            study = Study(arguments.thalweg, path, Path(folder), report)
            study.compare_fill(has_saga)
            if not (study.square and study.projected):
                continue  # the others measure degrees, and oblong cells, in cells
            study.prepare_unambiguous()
            study.compare_count()
            study.compare_saga()
            if has_grass:
                study.compare_grass()
    print(f"{report.failures} comparisons failed")
    return 1 if report.failures else 0


if __name__ == "__main__":
    sys.exit(main())
