# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading tiles in pieces, from a server through GDAL's /vsicurl/ or from a downloaded file, into the cache.

A piece is a block of cells of about a thousand by a thousand, cut along the file's own blocks, so that nothing is read
twice. In pieces heights are float32 (float64 where the file needs it), NaN where there is no data."""
import contextlib
import gzip
import hashlib
import os
import re
import shutil
import threading
import zipfile
from dataclasses import dataclass

import numpy as np
from osgeo import gdal

from cache import today
from problems import ServerError, UserError, public
from region import lonlat
from web import Absent, Passing, meaning_of

PIECE_CELLS = 1024
TIFF_STARTS = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
#: The largest that a tile of SRTM unpacks to: 7201 x 7201 cells of two bytes.
LARGEST_HGT_BYTES = 2 * 7201 ** 2

_open_files = threading.local()


def prepare_gdal(timeout_s):
    """How GDAL asks servers: quietly, in parts, never for neighbouring files, and without patience for silence."""
    gdal.UseExceptions()
    gdal.SetErrorHandler("CPLQuietErrorHandler")
    for option, value in {"GDAL_DISABLE_READDIR_ON_OPEN": "EMPTY_DIR", "GDAL_PAM_ENABLED": "NO", "GDAL_HTTP_NETRC": "NO",
                          "GDAL_HTTP_MAX_RETRY": "0", "GDAL_HTTP_USERAGENT": "thalweg-fetch",
                          "GDAL_HTTP_CONNECTTIMEOUT": f"{timeout_s:g}", "GDAL_HTTP_LOW_SPEED_LIMIT": "500",
                          "GDAL_HTTP_LOW_SPEED_TIME": f"{max(1, round(timeout_s))}", "GDAL_NUM_THREADS": "1"}.items():
        gdal.SetConfigOption(option, value)


@dataclass(frozen=True)
class Window:
    """Cells of a tile: columns x..x+wide, rows y..y+tall."""
    x: int
    y: int
    wide: int
    tall: int


def describe(data, name):
    """What must be known of a tile's grid, as it goes into the cache's record."""
    transform, system = data.GetGeoTransform(can_return_null=True), data.GetSpatialRef()
    if transform is None or system is None or data.RasterCount < 1:
        raise UserError(f"tile '{name}' has no place on the earth (no geotransform or no coordinate system)")
    if transform[2] != 0 or transform[4] != 0 or not transform[1] > 0 > transform[5]:
        raise UserError(f"tile '{name}' is rotated or not north-up; gdalwarp straightens it")
    band = data.GetRasterBand(1)
    blocks = [min(size, block * max(1, PIECE_CELLS // block))
              for size, block in zip((data.RasterXSize, data.RasterYSize), band.GetBlockSize())]
    return {"width": data.RasterXSize, "height": data.RasterYSize, "transform": list(transform), "wkt": system.ExportToWkt(),
            "type": gdal.GetDataTypeName(band.DataType), "unit": band.GetUnitType() or "", "piece": blocks}


def system_of(record):
    from osgeo import osr
    return lonlat(osr.SpatialReference(wkt=record["wkt"]))


def pieces_under(record, window):
    """Rows and columns of the pieces that a window touches."""
    wide, tall = record["piece"]
    return [(row, col) for row in range(window.y // tall, (window.y + window.tall - 1) // tall + 1)
            for col in range(window.x // wide, (window.x + window.wide - 1) // wide + 1)]


def piece_window(record, row, col):
    wide, tall = record["piece"]
    return Window(col * wide, row * tall, min(wide, record["width"] - col * wide), min(tall, record["height"] - row * tall))


def read_window(data, window):
    """Heights as float32 or float64, NaN where the file has none."""
    band = data.GetRasterBand(1)
    area = (window.x, window.y, window.wide, window.tall)
    values = band.ReadAsArray(*area)
    if values is None or values.shape != (window.tall, window.wide):
        raise RuntimeError("the cells cannot be read")
    wide_type = band.DataType in (gdal.GDT_Float64, gdal.GDT_Int32, gdal.GDT_UInt32)
    heights = values.astype(np.float64 if wide_type else np.float32)
    nodata = band.GetNoDataValue()
    if nodata is not None:
        heights[values == values.dtype.type(nodata)] = np.nan
    elif band.GetMaskFlags() & gdal.GMF_PER_DATASET:
        heights[band.GetMaskBand().ReadAsArray(*area) == 0] = np.nan
    heights[~np.isfinite(heights)] = np.nan
    if (band.GetScale() or 1) != 1 or (band.GetOffset() or 0) != 0:
        heights = heights * heights.dtype.type(band.GetScale() or 1) + heights.dtype.type(band.GetOffset() or 0)
    return heights


def as_geotiff(heights):
    """The bytes of a small GeoTIFF without a place: the record knows it."""
    code = gdal.GDT_Float64 if heights.dtype == np.float64 else gdal.GDT_Float32
    memory = gdal.GetDriverByName("MEM").Create("", heights.shape[1], heights.shape[0], 1, code)
    memory.GetRasterBand(1).WriteArray(heights)
    name = f"/vsimem/piece-{threading.get_ident()}.tif"
    gdal.GetDriverByName("GTiff").CreateCopy(name, memory, options=["COMPRESS=DEFLATE", "PREDICTOR=3", "ZLEVEL=6"])
    size = gdal.VSIStatL(name).size
    file = gdal.VSIFOpenL(name, "rb")
    content = bytes(gdal.VSIFReadL(1, size, file))
    gdal.VSIFCloseL(file)
    gdal.Unlink(name)
    return content


def version_of(etag, modified, size):
    """Changes whenever the file on the server does, as far as the server tells."""
    return "v" + hashlib.sha256(f"{etag} {modified} {size}".encode()).hexdigest()[:12]


def look(tile, web):
    """The record of a tile on a server, with `bytes` it holds; None where it is not there."""
    try:
        answer = web.probe(tile.address + tile.secret)
    except Absent:
        if tile.listed:
            raise ServerError(f"tile {tile.name} stands in the source's list, but the server does not have it (HTTP 404)") from None
        return None
    _refuse_page(answer.start, tile.name)
    record = {"name": tile.name, "address": public(tile.address), "etag": answer.etag, "modified": answer.modified,
              "size": answer.size, "retrieved": today(), "version": version_of(answer.etag, answer.modified, answer.size)}
    if tile.kind == "whole":
        return record
    if not answer.start.startswith(TIFF_STARTS):
        raise ServerError(f"tile {tile.name}: the server sent something else than a TIFF")
    if not answer.ranges:
        tile.kind, tile.opens_as = "whole", "tile.tif"
        return record
    tile.address = answer.url
    return record | web.again(lambda: _guarded(tile, lambda data: describe(data, tile.name)), f"tile {tile.name}")


def bytes_of(tile, record, pieces):
    """What reading these pieces asks of the server, from the sizes of the blocks that the file's own index gives."""
    def count(data):
        band, total = data.GetRasterBand(1), 0
        across, down = band.GetBlockSize()
        for row, col in pieces:
            w = piece_window(record, row, col)
            for y in range(w.y // down, (w.y + w.tall - 1) // down + 1):
                for x in range(w.x // across, (w.x + w.wide - 1) // across + 1):
                    total += int(band.GetMetadataItem(f"BLOCK_SIZE_{x}_{y}", "TIFF") or 0)
        return total
    try:
        return _guarded(tile, count)
    except (Passing, ServerError, UserError):
        return 0


def read_piece(tile, record, row, col, web):
    """The bytes of a piece as the cache keeps it, from the server."""
    window = piece_window(record, row, col)
    return web.again(lambda: as_geotiff(_guarded(tile, lambda data: read_window(data, window))), f"tile {tile.name}")


def _guarded(tile, action):
    """What action makes of the open remote file; a failure of GDAL's in plain words, its leftovers forgotten."""
    path = "/vsicurl/" + tile.address
    files = _open_files.__dict__
    try:
        if path not in files:
            files.clear()
            files[path] = gdal.Open(path)
        return action(files[path])
    except RuntimeError as problem:
        files.clear()
        gdal.VSICurlPartialClearCache(path)
        status = re.search(r"(?:HTTP|response)[^\d]{0,30}\b([345]\d\d)\b", str(problem))
        if status:
            raise meaning_of(int(status[1]), tile.address) from None
        raise Passing("it cannot be read: truncated, damaged, or the connection broke") from None


def _refuse_page(start, name):
    if start.lstrip()[:1] in (b"<", b"{"):
        raise ServerError(f"tile {name}: the server sent a web page or a message where a raster was expected")


def fetch_whole(tile, store, record, web, tick):
    """Downloads a file that cannot be read in parts; the cache then holds it as one piece. Returns the full record."""
    folder = os.path.join(store.version_folder(record), "whole.partial-" + str(os.getpid()))
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, "download")
    try:
        record["modified"], record["etag"] = web.download(tile.address + tile.secret, path, f"tile {tile.name}", tick)
        data_path = _unpacked(path, tile)
        with open(data_path, "rb") as file:
            _refuse_page(file.read(16), tile.name)
        return _keep_whole(tile, store, record, data_path)
    except Absent:
        raise ServerError(f"tile {tile.name}: the server does not have it (HTTP 404)") from None
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _keep_whole(tile, store, record, path):
    try:
        data = gdal.Open(path)
        full = record | describe(data, tile.name)
        full["piece"] = [full["width"], full["height"]]
        content = as_geotiff(read_window(data, piece_window(full, 0, 0)))
    except RuntimeError:
        raise ServerError(f"tile {tile.name}: what the server sent is no raster: truncated, or something else") from None
    store.add(full, 0, 0, content)
    store.remember(full)
    return full


def _unpacked(path, tile):
    """The raster out of a .gz or .zip, under the name that GDAL needs. Names inside an archive are never used."""
    target = os.path.join(os.path.dirname(path), tile.opens_as)
    address = tile.address.lower()
    if not address.endswith((".gz", ".zip")):
        os.rename(path, target)
        return target
    try:
        with contextlib.ExitStack() as stack:
            if address.endswith(".gz"):
                source = stack.enter_context(gzip.open(path))
            else:
                archive = stack.enter_context(zipfile.ZipFile(path))
                member = next(info for info in archive.infolist() if info.filename.lower().endswith(".hgt"))
                source = stack.enter_context(archive.open(member))
            content = source.read(LARGEST_HGT_BYTES + 1)
        if len(content) > LARGEST_HGT_BYTES:
            raise ServerError(f"tile {tile.name}: the archive holds more than an SRTM tile can")
    except (OSError, EOFError, StopIteration, zipfile.BadZipFile, gzip.zlib.error) as problem:
        if isinstance(problem, OSError) and problem.errno is not None:
            raise
        raise ServerError(f"tile {tile.name}: the archive is truncated, damaged, or holds no .hgt file") from None
    with open(target, "wb") as file:
        file.write(content)
    return target
