# SPDX-License-Identifier: GPL-3.0-or-later
"""FILE.tif and FILE.tif.json: written in a hidden neighbour, put in place by two renames, the DEM last."""
import contextlib
import fcntl
import json
import os
import shutil

import numpy as np
from osgeo import gdal, gdal_array, osr

import cache
import provenance
from problems import UserError
from region import lonlat

NODATA = -9999.0


class Output:
    def __init__(self, path, force):
        if not path:
            raise UserError("no output file: give --out FILE.tif")
        self.path = os.path.abspath(path)
        self.folder, self.name = os.path.split(self.path)
        self._made, self._partial, self._held = [], None, None
        if not self.name or os.path.isdir(self.path):
            raise UserError(f"--out '{path}' is a folder; it needs to be a file such as dem.tif")
        if not self.name.lower().endswith((".tif", ".tiff")):
            raise UserError(f"--out '{path}' needs to end in .tif: a GeoTIFF is written")
        if os.path.lexists(self.path) and not force:
            raise UserError(f"'{path}' exists already; name another file or use --force to replace it")
        if os.path.lexists(self.path + ".json") and not force and not _is_ours(self.path + ".json"):
            raise UserError(f"'{path}.json' exists and is no provenance of thalweg; name another file or use --force")
        try:
            self._make_partial()
        except OSError as problem:
            self.discard()
            raise UserError(f"cannot write '{path}': {problem.strerror}") from None

    def write(self, canvas, content_of):
        """Writes both files; content_of(checksum) gives the provenance. Returns its text."""
        path = os.path.join(self._partial, self.name)
        try:
            _write_geotiff(path, canvas)
            _check_geotiff(path, canvas)
        except (RuntimeError, AttributeError):
            raise UserError(f"cannot write '{self.path}': is the disk full?") from None
        text = json.dumps(content_of(cache.sha256_of(path)), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
        cache.write_whole(path + ".json", text)
        with open(path, "rb") as file:
            os.fsync(file.fileno())
        os.replace(path + ".json", self.path + ".json")
        os.replace(path, self.path)
        self._made = []
        self.discard()
        return text

    def _make_partial(self):
        self._make_folder()
        self._sweep()
        partial = os.path.join(self.folder, f".{self.name}.partial-{os.getpid()}")
        os.mkdir(partial)
        self._partial, self._held = partial, _held(partial)

    def _make_folder(self):
        missing, folder = [], self.folder
        while not os.path.isdir(folder):
            missing.append(folder)
            folder = os.path.dirname(folder)
        self._made = missing
        os.makedirs(self.folder, exist_ok=True)

    def _sweep(self):
        """What runs that were killed left: nobody holds it any more."""
        for name in os.listdir(self.folder):
            if name.startswith(f".{self.name}.partial-"):
                path = os.path.join(self.folder, name)
                held = _held(path)
                if held is not None:
                    shutil.rmtree(path, ignore_errors=True)
                    os.close(held)

    def discard(self):
        """Leaves nothing half-written."""
        if self._partial:
            shutil.rmtree(self._partial, ignore_errors=True)
        if self._held is not None:
            os.close(self._held)
            self._held = None
        for folder in self._made:
            with contextlib.suppress(OSError):
                os.rmdir(folder)


def _held(folder):
    """An open handle that keeps others from sweeping a folder, or None if somebody has it."""
    try:
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    except OSError:
        return None
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return handle
    except OSError:
        os.close(handle)
        return None


def _is_ours(path):
    """A provenance that a run was killed over, before its DEM stood beside it."""
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file).get("program") == provenance.PROGRAM
    except (OSError, ValueError, AttributeError):
        return False


def _write_geotiff(path, canvas):
    heights = np.where(np.isnan(canvas.heights), canvas.heights.dtype.type(NODATA), canvas.heights)
    memory = gdal.GetDriverByName("MEM").Create("", heights.shape[1], heights.shape[0], 1,
                                               gdal_array.NumericTypeCodeToGDALTypeCode(heights.dtype.type))
    memory.SetGeoTransform(canvas.grid.transform())
    memory.SetSpatialRef(lonlat(osr.SpatialReference(wkt=canvas.grid.wkt)))
    band = memory.GetRasterBand(1)
    band.WriteArray(heights)
    band.SetNoDataValue(NODATA)
    band.SetDescription("elevation, m")
    options = ["COMPRESS=DEFLATE", "PREDICTOR=3", "ZLEVEL=6", "TILED=YES", "BIGTIFF=IF_SAFER"]
    gdal.GetDriverByName("GTiff").CreateCopy(path, memory, options=options)


def _check_geotiff(path, canvas):
    """Reads it back: a disk that filled up while the file was closed would not be told otherwise."""
    found = gdal.Open(path).ReadAsArray()
    expected = np.where(np.isnan(canvas.heights), canvas.heights.dtype.type(NODATA), canvas.heights)
    if not np.array_equal(found, expected):
        raise RuntimeError("not what was written")
