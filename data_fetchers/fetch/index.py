# SPDX-License-Identifier: GPL-3.0-or-later
"""The user's own tiles: a folder, a VRT, a GDAL tile index, a STAC list of items, a list of addresses, or one raster."""
import glob
import json
import os
from dataclasses import dataclass
from urllib.parse import urljoin
from xml.etree import ElementTree

from osgeo import gdal, ogr

from catalogue import host_of
from problems import ServerError, UserError
from region import Box, bounds_in, lonlat, wgs84
from web import Absent

RASTERS = (".tif", ".tiff", ".hgt", ".vrt", ".img", ".asc", ".bil", ".flt", ".dem", ".dt0", ".dt1", ".dt2")
VECTORS = (".shp", ".gpkg", ".fgb", ".sqlite")
#: Names under which STAC items keep elevations, the likelier first.
ASSETS = ("elevation", "dem", "data", "DEM", "dtm", "dsm", "image", "visual")


@dataclass
class Entry:
    address: str  #: URL or local path
    box: Box | None = None
    date: str = ""


def entries(path, web, cache, offline, refresh):
    """Every tile of an index. Addresses inside a local index are the user's own words, so their hosts are allowed; an
    index from a server may only name files of allowed hosts, and never files of this machine."""
    if path.startswith(("http://", "https://")):
        web.hosts.add(host_of(path))
        found = _from_text(_fetched(path, web, cache, offline, refresh), path, path)
        for entry in found:
            if not entry.address.startswith(("http://", "https://")):
                raise ServerError("the index names a file that is not on an http(s) server")
        return found
    if not os.path.exists(path):
        raise UserError(f"no index '{path}': a folder, a VRT, a tile index, a STAC list or a list of addresses")
    found = _local(path)
    if not found:
        raise UserError(f"the index '{path}' names no raster")
    for entry in found:
        if entry.address.startswith(("http://", "https://")):
            web.hosts.add(host_of(entry.address))
    return found


def _local(path):
    if os.path.isdir(path):
        files = sorted(glob.glob(os.path.join(glob.escape(path), "**"), recursive=True))
        return [Entry(os.path.abspath(file)) for file in files if file.lower().endswith(RASTERS)]
    if path.lower().endswith(".vrt"):
        return _from_vrt(path) or [Entry(os.path.abspath(path))]
    if path.lower().endswith(RASTERS):
        return [Entry(os.path.abspath(path))]
    if path.lower().endswith(VECTORS):
        return _from_tile_index(path)
    try:
        with open(path, encoding="utf-8") as file:
            return _from_text(file.read(), path, None)
    except (OSError, UnicodeDecodeError) as problem:
        raise UserError(f"the index '{path}' cannot be read: {getattr(problem, 'strerror', None) or 'it is no text'}") from None


def _fetched(url, web, cache, offline, refresh):
    path = cache.text("index", url.rpartition("/")[2], url)
    if os.path.exists(path) and not (refresh and not offline):
        with open(path, encoding="utf-8") as file:
            return file.read()
    if offline:
        raise UserError(f"offline, and the cache lacks the index {os.path.basename(path)}")
    try:
        text = web.text(url)
    except Absent:
        raise ServerError("the index is not on the server (HTTP 404)") from None
    cache.keep(path, text)
    return text


def _from_text(text, path, base_url):
    if text.lstrip().startswith(("{", "[")):
        return _from_stac(text, path, base_url)
    lines = [line.strip() for line in text.splitlines()]
    return [Entry(_resolve(line, path, base_url)) for line in lines if line and not line.startswith("#")]


def _from_stac(text, path, base_url):
    try:
        content = json.loads(text)
        if isinstance(content, dict):
            content = content.get("features") or [content]
        return [_from_item(item, path, base_url) for item in content]
    except (ValueError, KeyError, TypeError, AttributeError, StopIteration):
        raise UserError("the index is JSON, but no STAC item or list of items with raster assets") from None


def _from_item(item, path, base_url):
    assets = item["assets"]
    href = next((assets[name]["href"] for name in ASSETS if name in assets), None) or next(
        asset["href"] for asset in assets.values() if "tiff" in asset.get("type", "") or asset["href"].lower().endswith(RASTERS))
    bounds = item.get("bbox")
    if bounds and len(bounds) == 6:
        bounds = [bounds[i] for i in (0, 1, 3, 4)]
    date = (item.get("properties") or {}).get("datetime") or ""
    return Entry(_resolve(href, path, base_url), Box(*map(float, bounds)) if bounds else None, str(date))


def _from_vrt(path):
    """The tiles on servers that a VRT puts together; none where all it reads lies on this machine."""
    try:
        root = ElementTree.parse(path).getroot()
        data = gdal.Open(path)
        transform, system = data.GetGeoTransform(), lonlat(data.GetSpatialRef())
    except (ElementTree.ParseError, RuntimeError, AttributeError):
        raise UserError(f"the index '{path}' is no VRT with a place on the earth") from None
    found = []
    for source in root.findall("./VRTRasterBand[1]/*[SourceFilename]"):
        address = source.findtext("SourceFilename", "").removeprefix("/vsicurl/")
        place = source.find("DstRect")
        if address.startswith(("http://", "https://")) and place is not None:
            x, y, wide, tall = (float(place.get(key)) for key in ("xOff", "yOff", "xSize", "ySize"))
            west, north = transform[0] + x * transform[1], transform[3] + y * transform[5]
            bounds = (west, north + tall * transform[5], west + wide * transform[1], north)
            found.append(Entry(address, Box(*bounds_in(bounds, system, wgs84()))))
    return found


def _from_tile_index(path):
    try:
        layer = ogr.Open(path).GetLayer(0)
    except (RuntimeError, AttributeError):
        raise UserError(f"the index '{path}' is no vector file that GDAL reads") from None
    names = [field.GetName() for field in layer.schema]
    column = next((name for name in names if name.lower() in ("location", "url", "path", "filename")), None)
    if column is None:
        raise UserError(f"the tile index '{path}' has no column 'location'")
    system = layer.GetSpatialRef()
    return [Entry(_resolve(feature.GetField(column), path, None), _box_of(feature.GetGeometryRef(), system))
            for feature in layer if feature.GetField(column)]


def _box_of(geometry, system):
    if geometry is None or system is None:
        return None
    west, east, south, north = geometry.GetEnvelope()
    return Box(*bounds_in((west, south, east, north), lonlat(system.Clone()), wgs84()))


def _resolve(href, path, base_url):
    """A name in an index: an address, or a file relative to the index."""
    href = href.removeprefix("/vsicurl/")
    if base_url is not None:
        return urljoin(base_url, href)
    if href.startswith(("http://", "https://")):
        return href
    return os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(path)), href.removeprefix("file://")))
