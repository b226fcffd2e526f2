# SPDX-License-Identifier: GPL-3.0-or-later
"""Which tiles of a source a box needs, by the source's own naming or its own list."""
import json
import math
import os
from dataclasses import dataclass

import index
from cache import safe
from catalogue import host_of
from problems import ServerError, UserError, public
from region import Box
from web import Absent, quote


@dataclass
class Tile:
    """One file of a source."""
    name: str
    address: str  #: URL or local path, without secrets
    kind: str  #: cog: read in parts through /vsicurl/; whole: downloaded; local: read where it lies
    listed: bool = False  #: the source's own list has it: its absence is a fault
    date: str = ""  #: of publication, where the list tells it
    secret: str = ""  #: appended to the address when asking
    opens_as: str = ""  #: file name that GDAL's driver insists on
    box: Box | None = None  #: where the list tells it


def of(source, box, web, cache, offline, refresh=False):
    """Tiles in the order in which they are laid down: later ones lie on top."""
    south, north = source["latitudes"]
    if box.north <= south or box.south >= north:
        raise UserError(f"{source.name} covers {source['coverage']} (latitudes {south} to {north}), not the box {box}")
    lister = {"degree": _degree, "tnm": _national_map, "api": _api, "hgt": _hgt, "index": _index}[source.kind]
    return lister(source, box, web, cache, offline, refresh)


def corner_names(south, west):
    """The ways in which sources write the whole degrees of a tile."""
    north = south + 1
    return {"south": south, "west": west, "ns": f"{'S' if south < 0 else 'N'}{abs(south):02d}",
            "ew": f"{'W' if west < 0 else 'E'}{abs(west):03d}",
            "north_ns": f"{'s' if north < 0 else 'n'}{abs(north):02d}", "west_ew": f"{'w' if west < 0 else 'e'}{abs(west):03d}"}


def degree_corners(box):
    """South-western corners of the one-degree tiles under a box, from the north-west."""
    for south in range(math.ceil(box.north) - 1, math.floor(box.south) - 1, -1):
        for west in range(math.floor(box.west), math.ceil(box.east)):
            yield south, west


def _degree(source, box, web, cache, offline, refresh):
    tiles = []
    for south, west in degree_corners(box):
        words = corner_names(south, west)
        name = source["tile"].format(**words)
        tiles.append(Tile(name, f"{source.base}/{source['path'].format(tile=name, **words)}", "cog"))
    known = _tile_list(source, web, cache, offline, refresh)
    if known is None:
        return tiles
    for tile in tiles:
        tile.listed = tile.name in known
    return [tile for tile in tiles if tile.listed]


def _tile_list(source, web, cache, offline, refresh):
    """The text that names every tile, from the cache where it is; None where the server has no list."""
    address = f"{source.base}/{source['tile_list']}"
    path = cache.text(source.key, source["tile_list"], address)
    if os.path.exists(path) and not (refresh and not offline):
        with open(path, encoding="utf-8") as file:
            return file.read()
    if offline:
        return None
    try:
        text = web.text(address)
    except Absent:
        return None
    except ServerError as problem:
        if getattr(problem, "status", None) == 403:  # buckets answer so where a list is missing
            return None
        raise
    if "<html" in text[:1000].lower() or not text.strip():
        raise ServerError(f"{public(address)}: a web page where a list of tiles was expected")
    cache.keep(path, text)
    return text


def _national_map(source, box, web, cache, offline, refresh):
    """Newest projects on top. A page of the answer holds at most `most` tiles."""
    grown, most, found = box.grown(0.05), 100, {}
    query = {"datasets": source["dataset"], "bbox": ",".join(f"{v:.6f}" for v in (grown.west, grown.south, grown.east,
             grown.north)), "prodFormats": "GeoTIFF", "outputFormat": "JSON", "max": most}
    address = f"{source.base}/{source['path']}?{quote(query)}"
    path = cache.text(source.key, "products", address)
    if offline or (os.path.exists(path) and not refresh):
        items = _read_json(path)
    else:
        items = _all_pages(address, web)
        cache.keep(path, json.dumps(items))
    for item in items or []:
        url = item.get("downloadURL") or ""
        host_of(url)
        corners = item.get("boundingBox") or {}
        where = Box(*(float(corners[key]) for key in ("minX", "minY", "maxX", "maxY"))) if corners else None
        found[url] = Tile(url.rpartition("/")[2].removesuffix(".tif"), url, "cog", True, str(item.get("publicationDate", "")),
                          box=where)
    return sorted(found.values(), key=lambda tile: (tile.date, tile.address))


def _read_json(path):
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except OSError:
        return None


def _all_pages(address, web):
    items, total = [], 1
    while len(items) < total:
        try:
            page = json.loads(web.text(f"{address}&offset={len(items)}"))
            new, total = page["items"], int(page["total"])
        except Absent:
            raise ServerError(f"{public(address)}: not found") from None
        except (ValueError, KeyError, TypeError):
            raise ServerError(f"{public(address)}: its answer is no list of products") from None
        if not isinstance(new, list) or not all(isinstance(item, dict) for item in new) or total > 100000:
            raise ServerError(f"{public(address)}: its answer is no list of products")
        if not new:
            break
        items += new
    return items


def _api(source, box, web, cache, offline, refresh):
    if box.area_km2() > source["most_km2"]:
        raise UserError(f"{source.name} gives at most {source['most_km2']:,.0f} km² at once; the box has {box.area_km2():,.0f}")
    cell = source["cell_deg"]
    edge = {"south": max(-90, box.south - 2 * cell), "north": min(90, box.north + 2 * cell),
            "west": max(-180, box.west - 2 * cell), "east": min(180, box.east + 2 * cell)}
    edge = {side: f"{value:.6f}" for side, value in edge.items()}
    address = f"{source.base}/{source['path']}?{quote({'demtype': source.argument, **edge, 'outputFormat': 'GTiff'})}"
    name = "_".join([source.argument, edge["west"], edge["south"], edge["east"], edge["north"]])
    secret = ""
    if not offline:
        key = os.environ.get(source["key"], "").strip()
        secret = f"&{quote({'API_Key': key})}" if key else ""
    return [Tile(name, address, "whole", True, secret=secret, opens_as="answer.tif")]


def _hgt(source, box, web, cache, offline, refresh):
    host_of(source.argument)
    template = source.argument
    if "{tile}" not in template:
        template = template.rstrip("/") + "/{tile}.hgt"
    tiles = []
    for south, west in degree_corners(box):
        words = corner_names(south, west)
        name = words["ns"] + words["ew"]
        address = template.replace("{tile}", name).replace("{ns}", words["ns"]).replace("{ew}", words["ew"])
        tiles.append(Tile(name, address, "whole", opens_as=f"{name}.hgt"))
    return tiles


def _index(source, box, web, cache, offline, refresh):
    tiles = []
    for entry in index.entries(source.argument, web, cache, offline, refresh):
        if entry.box is not None and not _meet(entry.box, box):
            continue
        remote = entry.address.startswith(("http://", "https://"))
        name = safe(entry.address.split("?")[0])
        tiles.append(Tile(name, entry.address, "cog" if remote else "local", True, entry.date, box=entry.box))
    return tiles


def _meet(a, b):
    return a.west < b.east and b.west < a.east and a.south < b.north and b.south < a.north
