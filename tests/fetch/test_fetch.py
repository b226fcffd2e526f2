#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""thalweg fetch against a server on loopback: test_fetch.py THALWEG [TEST…]

The server has tiles in each source's layout and names and fails on demand. Nothing here leaves the machine."""
import contextlib
import gzip
import json
import os
import pty
import random
import resource
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
import zipfile
from pathlib import Path

import numpy as np
from osgeo import gdal, osr

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))
import tiles_made  # noqa: E402
from server import Fault, Server  # noqa: E402

THALWEG = Path(sys.argv[1]).resolve()
KEY = "secret0key0of0opentopography"
BOX = (7.6, 46.2, 8.3, 46.8)
HERE = None  #: where the server's files lie
SERVER = None


def setUpModule():
    global HERE, SERVER
    folder = tempfile.TemporaryDirectory()
    unittest.addModuleCleanup(folder.cleanup)
    HERE = Path(folder.name)
    for south, west in ((46, 7), (46, 8)):
        tiles_made.copernicus(HERE / "glo90", 3, south, west)
    tiles_made.copernicus(HERE / "glo90", 3, 49, 7)
    tiles_made.copernicus(HERE / "glo90", 3, 50, 7, cols=800)
    tiles_made.copernicus(HERE / "glo90", 3, 36, -85, change=with_jacksboro)
    tiles_made.copernicus(HERE / "glo30", 1, 46, 7)
    for west in (-85, -84):
        tiles_made.three_dep_13(HERE / "3dep13", 37, west)
    tiles_made.hgt(HERE / "hgt/N46E007.hgt", 46, 7, void=True)
    content = tiles_made.hgt(HERE / "hgt/N46E008.hgt", 46, 8)
    (HERE / "hgt/N46").mkdir()
    (HERE / "hgt/N46/N46E008.hgt.gz").write_bytes(gzip.compress(content, 1))
    with zipfile.ZipFile(HERE / "hgt/N46E008.SRTMGL1.hgt.zip", "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        archive.writestr("../../../escaped/N46E008.hgt", content)
    one_metre_tiles(HERE / "1m")
    SERVER = Server(HERE)
    unittest.addModuleCleanup(SERVER.close)


def with_jacksboro(heights):
    """Real rivers for a study: the embedded DEM, whose cells are those of this tile (-85 to -84, 36 to 37)."""
    real = gdal.Open(str(Path(__file__).resolve().parents[2] / "validation/data/jacksboro.tif")).ReadAsArray()[:, :402]
    col, row = round((-84.41375 + 85) * 1200 + 0.5), round((37 - 36.44625) * 1200 + 0.5)
    heights[row:row + real.shape[0], col:col + 402] = real[:, :1200 - col]
    return heights


def one_metre_tiles(folder):
    """Two tiles of 3DEP's lidar projects: UTM, six cells of overlap. 1 m cells over 1.2 km instead of 10 km."""
    system = osr.SpatialReference()
    system.ImportFromEPSG(26917)
    for number, (left, project) in enumerate(((234000, "TN_Old_2015"), (235200, "TN_New_2019"))):
        x = left - 6 + np.arange(1212) + 0.5
        y = 4012006 - np.arange(1212) - 0.5
        heights = (300 + (x[None, :] - 234000) / 8 + (4012006 - y[:, None]) / 16).astype(np.float32)
        name = f"USGS_1M_17_x{left // 10000}y401_{project}"
        tiles_made.write(f"{folder}/{project}/TIFF/{name}.tif", heights, (left - 6, 1, 0, 4012006, 0, -1), 26917, -999999)


def thalweg(*arguments, limit_bytes=None, timeout=120, **environment):
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit_bytes, limit_bytes))

    return subprocess.run([THALWEG, *map(str, arguments)], capture_output=True, text=True, timeout=timeout,
                          env=surroundings(**environment), preexec_fn=limit if limit_bytes else None)


def surroundings(**more):
    """The environment without the user's proxies, cache and keys, every source on our server."""
    kept = {name: value for name, value in os.environ.items() if name in ("PATH", "HOME", "LANG", "THALWEG_PYTHON")}
    folders = {"COPERNICUS_GLO30": "glo30", "COPERNICUS_GLO90": "glo90", "3DEP_13": "3dep13", "3DEP_1M": "",
               "OPENTOPOGRAPHY": "ot"}
    return kept | {f"THALWEG_URL_{name}": f"{SERVER.url}/{folder}" for name, folder in folders.items()} | more


def read(path):
    data = gdal.Open(str(path))
    heights = data.ReadAsArray().astype(float)
    heights[heights == data.GetRasterBand(1).GetNoDataValue()] = np.nan
    return heights, data.GetGeoTransform(), data.GetSpatialRef()


def expected(transform, shape):
    return tiles_made.cells(transform[0], transform[3], transform[1], -transform[5], shape[1], shape[0])


class Fetching(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.here = Path(folder.name)
        self.cache = self.here / "cache"
        self.out = self.here / "dem.tif"
        SERVER.well()
        SERVER.dynamic.clear()

    def command(self, source, *more, box=BOX, out=None):
        place = ["--bbox", *box] if box else []
        return ["fetch", source, *place, "--out", out or self.out, "--cache", self.cache, "--retry-delay-s", "0.01", *more]

    def fetched(self, source, *more, box=BOX, out=None, **environment):
        """Provenance of a fetch that succeeds."""
        result = thalweg(*self.command(source, *more, box=box, out=out), **environment)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(Path(f"{out or self.out}.json").read_text())

    def refused(self, code, saying, source, *more, box=BOX, **options):
        """Fails with one line that says `saying`; nothing but the cache is written."""
        result = thalweg(*self.command(source, *more, box=box), **options)
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertTrue(result.stderr.startswith("thalweg: error: "), result.stderr)
        for words in (saying,) if isinstance(saying, str) else saying:
            self.assertIn(words, result.stderr)
        self.assertEqual([p.name for p in self.here.iterdir() if p.name != "cache"], [])
        return result


class Sources(Fetching):
    def test_copernicus_tiles_are_joined_cell_for_cell(self):
        said = self.fetched("copernicus-glo90")
        heights, transform, system = read(self.out)
        self.assertEqual(heights.shape, (720, 840))
        self.assertEqual(system.GetAuthorityCode(None), "4326")
        np.testing.assert_array_equal(heights, expected(transform, heights.shape))
        self.assertAlmostEqual(transform[0] + transform[1] / 2, 7.6)
        self.assertEqual([tile["name"][-18:] for tile in said["tiles"]], ["N46_00_E007_00_DEM", "N46_00_E008_00_DEM"])
        self.assertIn("Copernicus WorldDEM-90", said["citation"])
        self.assertEqual(said["vertical"], "metres above the EGM2008 geoid")
        self.assertEqual(said["resampling"], "none")

    def test_the_box_of_one_tile_gives_that_tile(self):
        said = self.fetched("copernicus-glo90", box=(8, 46, 9, 47))
        heights, transform, _ = read(self.out)
        tile, placed, _ = read(next(HERE.glob("glo90/*E008*/*.tif")))
        np.testing.assert_array_equal(heights, tile)
        np.testing.assert_allclose(transform, placed, atol=1e-12)
        self.assertEqual(len(said["tiles"]), 1)

    def test_only_the_window_is_read(self):
        self.fetched("copernicus-glo30", box=(7.1, 46.5, 7.2, 46.6))
        heights, transform, _ = read(self.out)
        self.assertEqual(heights.shape, (360, 360))
        np.testing.assert_array_equal(heights, expected(transform, heights.shape))
        whole = next(HERE.glob("glo30/*/*.tif")).stat().st_size
        self.assertLess(SERVER.bytes_sent("_DEM.tif"), 0.35 * whole)

    def test_where_copernicus_cells_widen_the_finer_ones_are_kept(self):
        said = self.fetched("copernicus-glo90", box=(7.4, 49.9, 7.6, 50.1))
        heights, transform, _ = read(self.out)
        self.assertEqual(heights.shape, (240, 240))
        truth = expected(transform, heights.shape)
        south = slice(125, 240)
        np.testing.assert_array_equal(heights[south], truth[south])
        self.assertTrue(np.isfinite(heights).all())
        self.assertLess(np.abs(heights - truth).max(), 1.5)
        self.assertIn("bilinear", said["resampling"])

    def test_3dep_tiles_overlap_and_have_voids(self):
        said = self.fetched("3dep-13", box=(-84.2, 36.4, -83.8, 36.8))
        heights, transform, system = read(self.out)
        self.assertEqual(system.GetAuthorityCode(None), "4269")
        truth = expected(transform, heights.shape)
        np.testing.assert_array_equal(heights[np.isfinite(heights)], truth[np.isfinite(heights)].astype(np.float32))
        self.assertEqual(said["void_cells"], int(np.isnan(heights).sum()))
        self.assertEqual(said["cells_without_tile"], 0)

    def test_voids_are_counted_and_filled_on_demand(self):
        box = (-84.75, 36.7, -84.6, 36.8)
        said = self.fetched("3dep-13", box=box)
        self.assertEqual(said["void_cells"], 50)
        self.assertIn("--fill-voids", said["notes"][0])
        said = self.fetched("3dep-13", "--fill-voids", "--force", box=box)
        heights, transform, _ = read(self.out)
        self.assertEqual((said["void_cells"], said["filled_cells"]), (0, 50))
        self.assertLess(np.abs(heights - expected(transform, heights.shape)).max(), 60)

    def national_map(self, **changes):
        """The API's answer, two tiles on two pages."""
        corners = {"minX": -83.98, "minY": 36.17, "maxX": -83.93, "maxY": 36.23}
        items = [{"title": path.stem, "publicationDate": path.stem[-4:] + "-01-01", "boundingBox": corners,
                  "downloadURL": f"{SERVER.url}/1m/{path.relative_to(HERE / '1m')}", **changes}
                 for path in sorted(HERE.glob("1m/*/TIFF/*.tif"))]

        def answer(query):
            start = int(query["offset"][0])
            page = {"total": len(items), "items": items[start:start + 1]}
            return 200, "application/json", json.dumps(page).encode()
        SERVER.dynamic["/api/v1/products"] = answer

    def test_3dep_1m_tiles_come_from_the_national_map(self):
        self.national_map()
        said = self.fetched("3dep-1m", box=(-83.95, 36.206, -83.942, 36.21))
        heights, transform, system = read(self.out)
        self.assertEqual(system.GetAuthorityCode(None), "26917")
        x = transform[0] + np.arange(heights.shape[1]) + 0.5
        y = transform[3] - np.arange(heights.shape[0]) - 0.5
        truth = 300 + (x[None, :] - 234000) / 8 + (4012006 - y[:, None]) / 16
        np.testing.assert_array_equal(heights[np.isfinite(heights)], truth[np.isfinite(heights)])
        self.assertGreater(np.isfinite(heights).mean(), 0.5)
        self.assertEqual([tile["published"] for tile in said["tiles"]], ["2019-01-01", "2015-01-01"])

    def test_a_host_that_a_server_names_must_be_known(self):
        self.national_map(downloadURL="http://files.example.org/tile.tif")
        self.refused(2, "--allow-host files.example.org", "3dep-1m", box=(-83.95, 36.206, -83.942, 36.21))
        self.national_map(downloadURL="file:///etc/passwd")
        self.refused(2, "no http", "3dep-1m", "--refresh", box=(-83.95, 36.206, -83.942, 36.21))

    def test_srtm_tiles_come_from_any_mirror(self):
        said = self.fetched(f"hgt:{SERVER.url}/hgt")
        heights, transform, _ = read(self.out)
        known = np.isfinite(heights)
        np.testing.assert_array_equal(heights[known], np.round(expected(transform, heights.shape))[known])
        self.assertEqual(said["void_cells"], int((~known).sum()))
        for template in ("hgt/{ns}/{tile}.hgt.gz", "hgt/{tile}.SRTMGL1.hgt.zip"):
            self.fetched(f"hgt:{SERVER.url}/{template}", "--force", box=(8.1, 46.2, 8.3, 46.8))
            heights, transform, _ = read(self.out)
            np.testing.assert_array_equal(heights, np.round(expected(transform, heights.shape)))
        self.assertEqual([p for p in self.here.rglob("*escaped*")], [])

    def open_topography(self, status=200, content=None):
        seen = []

        def answer(query):
            seen.append(query)
            west, south, east, north = (float(query[side][0]) for side in ("west", "south", "east", "north"))
            cell = 1 / 1200
            cols, rows = round((east - west) / cell), round((north - south) / cell)
            heights = tiles_made.cells(west, north, cell, cell, cols, rows).astype(np.int16)
            path = str(self.here / "cache" / "made.tif")
            tiles_made.write(path, heights, (west, cell, 0, north, 0, -cell), 4326, -32768, "GTiff")
            made = Path(path).read_bytes()
            os.unlink(path)
            return status, "application/octet-stream", made if content is None else content
        SERVER.dynamic["/ot/API/globaldem"] = answer
        return seen

    def test_opentopography_gets_the_key_and_nobody_else_does(self):
        seen = self.open_topography()
        said = self.fetched("opentopography:SRTMGL3", OPENTOPOGRAPHY_API_KEY=KEY)
        self.assertEqual(seen[0]["API_Key"], [KEY])
        self.assertEqual(seen[0]["demtype"], ["SRTMGL3"])
        self.assertEqual(read(self.out)[0].shape, (720, 840))
        self.assertIn("doi:10.5069/G9445JDF", said["citation"])
        for path in (p for p in self.here.rglob("*") if p.is_file()):
            self.assertNotIn(KEY.encode(), path.read_bytes(), path)
            self.assertNotIn(KEY, str(path))
        self.fetched("opentopography:SRTMGL3", "--offline", "--force")  # from the cache no key is needed

    def test_a_key_that_is_missing_or_refused_is_the_users_matter(self):
        self.refused(2, "OPENTOPOGRAPHY_API_KEY", "opentopography:SRTMGL3")
        for status in (401, 403):
            self.open_topography(status, b"API key " + KEY.encode() + b" unknown")
            result = self.refused(2, "does not accept the key", "opentopography:SRTMGL3", OPENTOPOGRAPHY_API_KEY=KEY)
            self.assertNotIn(KEY, result.stderr)
        self.open_topography(204, b"")
        self.refused(2, "no data there", "opentopography:SRTMGL3", OPENTOPOGRAPHY_API_KEY=KEY)
        for status in (429, 500):
            self.open_topography(status)
            result = self.refused(3, f"HTTP {status}", "opentopography:SRTMGL3", OPENTOPOGRAPHY_API_KEY=KEY)
            self.assertNotIn(KEY, result.stderr)
        self.open_topography(200, b"<html>sign in</html>")
        self.refused(3, "web page", "opentopography:SRTMGL3", OPENTOPOGRAPHY_API_KEY=KEY)
        SERVER.dynamic.clear()
        SERVER.faults["globaldem"] = Fault("redirect", to="http://elsewhere.example.org/")
        result = self.refused(2, "elsewhere.example.org", "opentopography:SRTMGL3", OPENTOPOGRAPHY_API_KEY=KEY)
        self.assertNotIn(KEY, result.stderr)

    def test_an_index_may_be_a_folder_a_vrt_a_stac_list_or_addresses(self):
        paths = sorted(HERE.glob("glo90/*N46*/*.tif"))
        urls = [f"{SERVER.url}/{path.relative_to(HERE)}" for path in paths]
        index = self.here / "cache" / "index"
        index.mkdir(parents=True)
        (index / "list.txt").write_text("# tiles\n" + "\n".join(urls) + "\n")
        items = [{"type": "Feature", "bbox": [7 + i, 46, 8 + i, 47], "assets": {"elevation": {"href": url}},
                  "properties": {"datetime": "2021-04-22T00:00:00Z"}} for i, url in enumerate(urls)]
        (index / "items.json").write_text(json.dumps({"type": "FeatureCollection", "features": items}))
        gdal.BuildVRT(str(index / "local.vrt"), [str(path) for path in paths]).FlushCache()
        text = (index / "local.vrt").read_text()
        for path, url in zip(paths, urls):
            text = text.replace(f'relativeToVRT="0">{path}', f'relativeToVRT="0">/vsicurl/{url}')
        (index / "remote.vrt").write_text(text)
        sums = set()
        for name in (HERE / "glo90", index / "list.txt", index / "items.json", index / "local.vrt", index / "remote.vrt"):
            sums.add(self.fetched(f"index:{name}", "--force")["sha256"])
        self.assertEqual(len(sums), 1)
        sums.add(self.fetched("copernicus-glo90", "--force")["sha256"])
        self.assertEqual(len(sums), 1)

    def test_an_index_without_a_tile_there_is_refused(self):
        self.refused(2, "nothing there", f"index:{HERE / 'glo90'}", box=(20, 20, 20.5, 20.5))

    def test_an_index_from_a_server_cannot_name_files_of_this_machine(self):
        for href in ("file:///etc/hostname", "/vsizip//etc/x.zip"):
            (HERE / "stac.json").write_text(json.dumps([{"assets": {"dem": {"href": href}}}]))
            result = thalweg(*self.command(f"index:{SERVER.url}/stac.json", "--refresh"))
            self.assertIn(result.returncode, (2, 3), result.stderr)
            self.assertEqual(len(result.stderr.splitlines()), 1)
        (HERE / "stac.json").write_text(json.dumps([{"assets": {"dem": {"href": "http://other.example.org/x.tif"}}}]))
        self.refused(2, "--allow-host other.example.org", f"index:{SERVER.url}/stac.json", "--refresh")
        (HERE / "stac.json").unlink()


class Regions(Fetching):
    def test_boxes_that_cannot_be_are_refused_with_the_reason(self):
        for box, words in (((10, 50, 5, 40), "south 50"), ((8.3, 46.2, 7.6, 46.8), "west 8.3"),
                           ((179, 46, -179, 47), "antimeridian"), ((7, -91, 8, 47), "-91"), ((46, 100, 47, 101), "swapped"),
                           ((-190, 46, 8, 47), "-190"), ((7, 46, 8, "nan"), "finite"), ((7, 46, 8, "much"), "4 numbers"),
                           ((7, 89, 8, 90), "pole"), ((7, 46, 7.0001, 46.0001), "2 x 2")):
            self.refused(2, words, "copernicus-glo90", box=box)
        self.refused(2, "where?", "copernicus-glo90", box=None)
        self.refused(2, "latitudes", "3dep-13", box=(7, 75, 8, 76))
        self.assertEqual(SERVER.bytes_sent("DEM.tif"), sum(sent for path, _, _, sent in SERVER.asked if "N46_00_E007" in path))

    def test_words_that_name_no_source_are_refused(self):
        for source, words in (("atlantis", "copernicus-glo30"), ("copernicus-glo31", "did you mean"),
                              ("opentopography", "SRTMGL1"), ("opentopography:NASADEN", "NASADEM"), ("hgt", "hgt:URL"),
                              ("hgt:ftp://x.org/a", "http"), ("hgt:http://user:pass@x.org/a", "password"),
                              ("copernicus-glo90:x", "colon"), ("index:/nowhere", "/nowhere")):
            result = self.refused(2, words, source)
            self.assertNotIn("user:pass", result.stderr)

    def test_a_box_in_the_sea_is_told_from_a_tile_that_is_missing(self):
        self.refused(2, "sea", "copernicus-glo90", box=(-30.5, 40.2, -30.1, 40.8))
        with open(HERE / "glo90/tileList.txt", "a", encoding="utf-8") as file:
            file.write("Copernicus_DSM_COG_30_N47_00_E007_00_DEM\n")
        self.refused(3, ("N47_00_E007", "404"), "copernicus-glo90", "--refresh", box=(7.2, 47.2, 7.4, 47.4))

    def test_cells_without_a_tile_are_no_data_and_said_so(self):
        said = self.fetched("copernicus-glo90", box=(8.9, 46.4, 9.1, 46.6))
        heights, _, _ = read(self.out)
        self.assertTrue(np.isnan(heights[:, 121:]).all())
        self.assertEqual(said["cells_without_tile"], int(np.isnan(heights).sum()))
        self.fetched("copernicus-glo90", "--fill-voids", "--force", box=(8.9, 46.4, 9.1, 46.6))
        self.assertTrue(np.isnan(read(self.out)[0][:, 121:]).all())

    def test_too_much_is_refused_with_its_size_before_any_server_is_asked(self):
        self.refused(2, ("cells", "GB", "--yes"), "copernicus-glo30", box=(0, 40, 10, 47))
        self.refused(2, "number", "copernicus-glo30", "--yes", box=(-179, -80, 179, 80))
        self.assertEqual(SERVER.asked, [])

    def test_a_point_with_a_radius_is_the_box_that_holds_its_circle(self):
        said = self.fetched("copernicus-glo90", "--point", 7.5, 46.5, "--radius-m", 10000, box=None)
        box = said["bbox_deg"]
        tall, wide = box["north"] - box["south"], box["east"] - box["west"]
        self.assertAlmostEqual(tall, 2 * 10000 / 111165, delta=0.002)
        self.assertAlmostEqual(wide, 2 * 10000 / (111412 * np.cos(np.radians(46.5))), delta=0.003)
        self.refused_pair()

    def refused_pair(self):
        for path in self.here.glob("dem.tif*"):
            path.unlink()
        self.refused(2, "--radius-m", "copernicus-glo90", "--point", 7.5, 46.5, box=None)
        self.refused(2, "antimeridian", "copernicus-glo90", "--point", 179.99, 46, "--radius-m", 9000, box=None)
        self.refused(2, "pole", "copernicus-glo90", "--point", 7, 89.8, "--radius-m", 90000, box=None)

    def test_outside_an_outline_there_is_no_data(self):
        outline = self.here / "cache" / "basin.geojson"
        outline.parent.mkdir()
        ring = [[7.7, 46.3], [8.2, 46.3], [7.7, 46.7], [7.7, 46.3]]
        outline.write_text(json.dumps({"type": "FeatureCollection", "features": [
            {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [ring]}}]}))
        self.fetched("copernicus-glo90", "--outline", outline, box=None)
        heights, transform, _ = read(self.out)
        self.assertEqual(heights.shape, (480, 600))
        self.assertAlmostEqual(float(np.isfinite(heights).mean()), 0.5, delta=0.01)
        self.assertTrue(np.isfinite(heights[-5, 5]) and np.isnan(heights[5, -5]))

    def test_a_projection_is_filled_to_its_corners(self):
        for crs, code in (("utm", "32632"), ("equal-area", None), ("EPSG:3035", "3035")):
            said = self.fetched("copernicus-glo90", "--crs", crs, "--force", box=(7.4, 46.3, 7.6, 46.5))
            heights, transform, system = read(self.out)
            self.assertTrue(np.isfinite(heights).all())
            self.assertEqual((transform[1], transform[5]), (90, -90))
            self.assertEqual(system.GetAuthorityCode(None), code)
            self.assertEqual(said["resampling"], "bilinear")
            middle = heights.shape[0] // 2, heights.shape[1] // 2
            x, y = transform[0] + (middle[1] + 0.5) * 90, transform[3] - (middle[0] + 0.5) * 90
            there = osr.SpatialReference()
            there.ImportFromEPSG(4326)
            for each in (there, system):
                each.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
            longitude, latitude, _ = osr.CoordinateTransformation(system, there).TransformPoint(x, y)
            self.assertAlmostEqual(heights[middle], float(tiles_made.height_at(longitude, latitude)), delta=1.5)
        for path in self.here.glob("dem.tif*"):
            path.unlink()
        self.refused(2, "EPSG:0", "copernicus-glo90", "--crs", "EPSG:0")
        self.refused(2, "--crs", "copernicus-glo90", "--cell-m", 50)


class Faults(Fetching):
    def test_a_server_that_fails_is_no_fault_of_the_user(self):
        tile = "N46_00_E007_00_DEM.tif"
        for status, words in ((500, "HTTP 500"), (502, "HTTP 502"), (503, "3 attempts"), (429, "too many"), (403, "refused"),
                              (404, "does not have it")):
            SERVER.faults = {tile: Fault("status", status=status)}
            self.refused(3, words, "copernicus-glo90", "--retries", 2)
        SERVER.faults = {tile: Fault("html")}
        self.refused(3, "web page", "copernicus-glo90", "--retries", 1)
        SERVER.faults = {tile: Fault("silent", seconds=1.5)}
        self.refused(3, "no answer in time", "copernicus-glo90", "--retries", 1, "--timeout-s", 0.5)
        SERVER.faults = {tile: Fault("broken", after=5000)}
        self.refused(3, tile[:-8], "copernicus-glo90", "--retries", 1)
        SERVER.faults = {"tileList": Fault("status", status=500)}
        self.cache = self.here / "cache" / "other"
        self.refused(3, "HTTP 500", "copernicus-glo90", "--retries", 1)
        with socket.socket() as closed:
            closed.bind(("127.0.0.1", 0))
            port = closed.getsockname()[1]
        self.refused(3, "no connection", "copernicus-glo90", "--retries", 1, "--base-url", f"http://127.0.0.1:{port}")

    def test_failures_in_the_middle_of_a_tile_end_the_run_or_pass(self):
        """After the first looks the server fails; GDAL is asking then."""
        tile = "N46_00_E007_00_DEM.tif"
        reference = self.fetched("copernicus-glo90", out=self.here / "cache" / "reference.tif")["sha256"]
        for kind, values in (("status", {"status": 503}), ("broken", {"after": 1000}), ("html", {})):
            for path in self.cache.rglob("p*.tif"):
                path.unlink()
            SERVER.faults = {tile: Fault(kind, skip=2, **values)}
            self.refused(3, "", "copernicus-glo90", "--retries", 1)
            SERVER.faults = {tile: Fault(kind, skip=2, times=2, **values)}
            self.assertEqual(self.fetched("copernicus-glo90", "--retries", 4)["sha256"], reference, kind)
            for path in self.here.glob("dem.tif*"):
                path.unlink()

    def test_what_passes_is_tried_again(self):
        SERVER.faults = {"N46_00_E007_00_DEM.tif": Fault("status", times=3, status=503, headers={"Retry-After": "0"}),
                         "tileList.txt": Fault("broken", times=2, after=10), "E008": Fault("silent", times=1, seconds=2.5)}
        self.fetched("copernicus-glo90", "--timeout-s", 2)
        heights, transform, _ = read(self.out)
        np.testing.assert_array_equal(heights, expected(transform, heights.shape))

    def test_a_tile_cut_short_on_the_server_is_told(self):
        path = next(HERE.glob("glo90/*E008*/*.tif"))
        whole = path.read_bytes()
        self.addCleanup(path.write_bytes, whole)
        path.write_bytes(whole[:len(whole) // 2])
        self.refused(3, ("E008", "truncated"), "copernicus-glo90", "--retries", 1, box=(8.1, 46.1, 8.3, 46.8))
        path.write_bytes(b"II*\0")
        self.refused(3, "E008", "copernicus-glo90", "--retries", 1, box=(8.1, 46.1, 8.3, 46.8))
        path = HERE / "hgt/N46/N46E008.hgt.gz"
        packed = path.read_bytes()
        self.addCleanup(path.write_bytes, packed)
        path.write_bytes(packed[:100000])
        self.refused(3, "truncated", f"hgt:{SERVER.url}/hgt/{{ns}}/{{tile}}.hgt.gz", box=(8.1, 46.1, 8.3, 46.8))
        (HERE / "hgt/N10E010.hgt").write_bytes(bytes(1000))
        self.refused(3, "truncated", f"hgt:{SERVER.url}/hgt", box=(10.1, 10.1, 10.3, 10.3))

    def test_redirects_lead_to_known_hosts_only(self):
        tile = "N46_00_E007_00_DEM.tif"
        SERVER.faults = {tile: Fault("redirect", to="http://elsewhere.example.org/x.tif")}
        self.refused(2, "--allow-host elsewhere.example.org", "copernicus-glo90")
        SERVER.faults = {tile: Fault("redirect", to="file:///etc/passwd")}
        self.refused(3, "HTTP 302", "copernicus-glo90")
        SERVER.faults = {tile: Fault("redirect", to=f"{SERVER.url}/loop/{tile}")}
        self.refused(3, "", "copernicus-glo90", "--retries", 0)

    def test_a_server_without_ranges_is_read_whole(self):
        SERVER.ranges = False
        self.fetched("copernicus-glo90", box=(8.1, 46.2, 8.3, 46.8))
        heights, transform, _ = read(self.out)
        np.testing.assert_array_equal(heights, expected(transform, heights.shape))

    def test_a_full_disk_is_told_and_leaves_no_debris(self):
        for limit in (300, 20000, 200000):
            self.refused(2, "", "copernicus-glo90", limit_bytes=limit)

    def test_a_small_file_system_that_fills_up_leaves_no_debris(self):
        mount = self.here / "cache" / "small"
        mount.mkdir(parents=True)
        if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=400k", "tmpfs", mount],
                                               capture_output=True).returncode != 0:
            self.skipTest("only root can mount a small file system")
        self.addCleanup(subprocess.run, ["umount", mount], check=True)
        result = thalweg(*self.command("copernicus-glo90", out=mount / "dem.tif"))
        self.assertEqual((result.returncode, len(result.stderr.splitlines())), (2, 1), result.stderr)
        self.assertEqual(list(mount.iterdir()), [])
        result = thalweg(*self.command("copernicus-glo90"), "--cache", mount / "cache")
        self.assertEqual(result.returncode, 2, result.stderr)

    def test_places_that_cannot_be_written_are_refused_before_any_server_is_asked(self):
        (self.here / "cache").mkdir()
        taken = self.here / "cache" / "taken.tif"
        taken.write_text("mine")
        for out, words in ((taken, "--force"), (self.here, "folder"), ("/proc/x/dem.tif", "cannot write"),
                           (taken / "dem.tif", "cannot write"), (self.here / "dem.png", ".tif"), ("", "--out")):
            result = thalweg("fetch", "copernicus-glo90", "--bbox", *BOX, "--out", out, "--cache", self.cache)
            self.assertEqual((result.returncode, len(result.stderr.splitlines())), (2, 1), result.stderr)
            self.assertIn(words, result.stderr)
        self.assertEqual(taken.read_text(), "mine")
        self.assertEqual(SERVER.asked, [])


class Cache(Fetching):
    def test_the_second_time_no_server_is_asked(self):
        first = self.fetched("copernicus-glo90")
        SERVER.well()
        second = self.fetched("copernicus-glo90", "--force")
        self.assertEqual(SERVER.asked, [])
        self.assertEqual(first, second)

    def test_offline_names_what_is_missing(self):
        self.refused(2, ("offline", "N46_00_E007_00_DEM", "N46_00_E008_00_DEM"), "copernicus-glo90", "--offline")
        self.fetched("copernicus-glo90", box=(7.2, 46.2, 7.4, 46.4))
        self.out.unlink()
        Path(f"{self.out}.json").unlink()
        result = self.refused(2, ("offline", "E008"), "copernicus-glo90", "--offline")
        self.assertEqual(len([p for p, _, _, _ in SERVER.asked if "E008" in p]), 0, result.stderr)
        self.fetched("copernicus-glo90", "--offline", box=(7.2, 46.2, 7.4, 46.4))

    def test_a_damaged_piece_is_read_again(self):
        reference = self.fetched("copernicus-glo90")["sha256"]
        piece = min(self.cache.rglob("p*.tif"))
        content = bytearray(piece.read_bytes())
        content[len(content) // 2] ^= 1
        piece.write_bytes(content)
        self.assertEqual(self.fetched("copernicus-glo90", "--force")["sha256"], reference)

    def test_a_tile_that_changed_on_the_server_replaces_the_cached_one(self):
        folder = HERE / "changing"
        tiles_made.copernicus(folder, 3, 46, 7)
        mirror = ("--base-url", f"{SERVER.url}/changing")
        before = self.fetched("copernicus-glo90", *mirror, box=(7.2, 46.2, 7.4, 46.4))
        name = tiles_made.copernicus(folder, 3, 46, 7, change=lambda heights: heights + 8)
        os.utime(folder / name / f"{name}.tif", (1, 10 ** 9))
        self.assertEqual(self.fetched("copernicus-glo90", *mirror, "--force", box=(7.2, 46.2, 7.4, 46.4))["sha256"],
                         before["sha256"])
        after = self.fetched("copernicus-glo90", *mirror, "--force", "--refresh", box=(7.2, 46.2, 7.4, 46.4))
        self.assertAlmostEqual(after["elevation_min_m"], before["elevation_min_m"] + 8)

    def test_two_fetches_into_one_cache_are_safe(self):
        SERVER.faults = {"DEM.tif": Fault("slow", seconds=0.02)}
        outs = [self.here / f"dem{i}.tif" for i in range(4)]
        processes = [subprocess.Popen([THALWEG, *map(str, self.command("copernicus-glo90", out=out))], env=surroundings(),
                                      stderr=subprocess.PIPE, text=True) for out in outs]
        for process in processes:
            _, said = process.communicate(timeout=120)
            self.assertEqual(process.returncode, 0, said)
        self.assertEqual(len({out.read_bytes() for out in outs}), 1)
        self.assertEqual(list(self.cache.rglob("*.partial*")), [])

    def test_killed_at_any_moment_the_next_run_completes_with_the_same_bytes(self):
        reference = self.here / "cache" / "reference.tif"
        self.cache = self.here / "cache" / "apart"
        self.fetched("copernicus-glo90", out=reference)
        self.cache = self.here / "cache" / "shared"
        chance = random.Random(6)
        for attempt in range(6):
            SERVER.faults = {"DEM.tif": Fault("slow", seconds=0.03)}
            process = subprocess.Popen([THALWEG, *map(str, self.command("copernicus-glo90", "--threads", 1))],
                                       env=surroundings(), stderr=subprocess.DEVNULL, start_new_session=True)
            time.sleep(chance.uniform(0.15, 1.3))
            process.kill()
            process.wait()
            if self.out.exists():
                self.assertEqual(self.out.read_bytes(), reference.read_bytes())
            SERVER.well()
            more = ["--force"] if self.out.exists() else []
            self.fetched("copernicus-glo90", *more)
            self.assertEqual(self.out.read_bytes(), reference.read_bytes(), attempt)
            self.assertEqual(sorted(p.name for p in self.here.iterdir()), ["cache", "dem.tif", "dem.tif.json"])
            for path in [*self.here.glob("dem.tif*"), *sorted(self.cache.rglob("p*.tif"))[attempt % 2:]]:
                path.unlink()

    def test_a_signal_stops_it_in_one_line_without_debris(self):
        for sign in (signal.SIGINT, signal.SIGTERM):
            SERVER.faults = {"DEM.tif": Fault("slow", seconds=5)}
            process = subprocess.Popen([THALWEG, *map(str, self.command("copernicus-glo90"))], env=surroundings(),
                                       stderr=subprocess.PIPE, text=True)
            while SERVER.faults["DEM.tif"].times == 10 ** 9 and process.poll() is None:
                time.sleep(0.02)
            process.send_signal(sign)
            _, said = process.communicate(timeout=30)
            self.assertEqual(process.returncode, 128 + sign, said)
            self.assertEqual(len(said.splitlines()), 1, said)
            self.assertEqual([p.name for p in self.here.iterdir() if p.name != "cache"], [])

    def test_on_a_terminal_the_size_is_told_first_and_a_bar_follows(self):
        try:
            master, slave = pty.openpty()
        except OSError:
            self.skipTest("no terminals here (a chroot without /dev/pts)")
        process = subprocess.Popen([THALWEG, *map(str, self.command("copernicus-glo90"))], env=surroundings(), stderr=slave)
        os.close(slave)
        said = b""
        with open(master, "rb", buffering=0) as terminal, contextlib.suppress(OSError):  # EIO when the other end closes
            while block := terminal.read(4096):
                said += block
        self.assertEqual(process.wait(60), 0)
        text = said.decode()
        self.assertLess(text.index("MB to read in"), text.index("fetching ["))
        self.assertIn("100%", text)

    def test_a_dry_run_tells_the_size_and_reads_no_heights(self):
        result = thalweg(*self.command("copernicus-glo90", "--dry-run"))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"2 tiles of copernicus-glo90, 840 x 720 cells: \d\.\d MB to read in \d pieces")
        self.assertFalse(self.out.exists())
        self.assertLess(SERVER.bytes_sent("DEM.tif"), 200000)


class Whole(Fetching):
    def test_fetch_then_analyze_cites_the_source(self):
        self.fetched("copernicus-glo90", box=(7.4, 46.3, 7.6, 46.5))
        result = thalweg("analyze", self.out, "--out", self.here / "measured", "--no-figures")
        self.assertEqual(result.returncode, 0, result.stderr)
        summary = json.loads((self.here / "measured/summary.json").read_text())
        self.assertIn("Copernicus WorldDEM-90", summary["input"]["provenance"]["citation"])
        self.assertEqual(summary["input"]["rows"], 240)
        said = Path(f"{self.out}.json")
        said.write_text(said.read_text().replace('"sha256": "', '"sha256": "0', 1))
        result = thalweg("analyze", self.out, "--out", self.here / "measured", "--no-figures", "--force")
        self.assertIn("another checksum", result.stderr)
        self.assertNotIn("provenance", json.loads((self.here / "measured/summary.json").read_text())["input"])

    def test_a_study_may_name_a_source_and_a_box(self):
        study = self.here / "study.toml"
        study.write_text('[study]\nsource = "copernicus-glo90"\nbbox = [-84.41, 36.17, -84.08, 36.44]\nuplift_m_per_yr = 3e-5\n'
                         "[time]\nsolver = \"steady\"\n[river]\nn = 1.0\n")
        words = ("run", study, "--out", self.here / "study", "--no-figures")
        result = thalweg(*words, XDG_CACHE_HOME=str(self.cache))
        self.assertEqual(result.returncode, 0, result.stderr)
        manifest = json.loads((self.here / "study/manifest.json").read_text())
        self.assertEqual(manifest["steps"][0], "fetch")
        self.assertIn("Copernicus", manifest["input"]["provenance"]["citation"])
        self.assertIn("fetch/copernicus-glo90.tif", [output["file"] for output in manifest["outputs"]])
        said = json.loads((self.here / "study/fetch/copernicus-glo90.tif.json").read_text())
        self.assertEqual(said["command"], "thalweg fetch copernicus-glo90 --bbox=-84.41,36.17,-84.08,36.44 --out copernicus-glo90.tif")
        text = (self.here / "study/simulate/experiment.toml").read_text()
        self.assertIn('dem = "../fetch/copernicus-glo90.tif"', text.replace("'", '"'))
        again = thalweg("simulate", self.here / "study/simulate/experiment.toml", "--out", self.here / "again", "--no-figures")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual((self.here / "again/elevation.tif").read_bytes(),
                         (self.here / "study/simulate/elevation.tif").read_bytes())

    def test_a_study_that_is_killed_takes_its_fetcher_along(self):
        study = self.here / "study.toml"
        study.write_text('[study]\nsource = "copernicus-glo90"\nbbox = [7.4, 46.3, 7.6, 46.5]\nuplift_m_per_yr = 1e-3\n')
        SERVER.faults = {"DEM.tif": Fault("slow", seconds=20)}
        process = subprocess.Popen([THALWEG, "run", study, "--out", self.here / "study"], stderr=subprocess.DEVNULL,
                                   env=surroundings(XDG_CACHE_HOME=str(self.cache)))
        while SERVER.faults["DEM.tif"].times == 10 ** 9 and process.poll() is None:
            time.sleep(0.02)
        children = [int(word) for path in Path(f"/proc/{process.pid}/task").glob("*/children")
                    for word in path.read_text().split()]
        self.assertEqual(len(children), 1)
        process.kill()
        process.wait()
        until = time.monotonic() + 10
        while Path(f"/proc/{children[0]}/cmdline").exists() and Path(f"/proc/{children[0]}/cmdline").read_bytes():
            self.assertLess(time.monotonic(), until, "the fetcher goes on alone")
            time.sleep(0.05)

    def test_a_study_passes_on_what_fetching_says(self):
        study = self.here / "study.toml"
        study.write_text('[study]\nsource = "copernicus-glo90"\nbbox = [7.4, 46.3, 7.6, 46.5]\nuplift_m_per_yr = 1e-3\n')
        SERVER.faults = {"DEM.tif": Fault("status", status=403)}
        for change, code, words in (("seed=1", 3, "HTTP 403"), ("study.source=atlantis", 2, "unknown source"),
                                    ("study.bbox=[8, 46, 7, 47]", 2, "west 8"), ("study.dem=x.tif", 2, "exclude"),
                                    ("study.bbox=[8, 46]", 2, "four numbers")):
            result = thalweg("run", study, "--set", change, "--out", self.here / "study", XDG_CACHE_HOME=str(self.cache))
            self.assertEqual(result.returncode, code, result.stderr)
            self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
            self.assertIn(words, result.stderr)
            self.assertFalse((self.here / "study").exists())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
