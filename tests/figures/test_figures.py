# SPDX-License-Identifier: GPL-3.0-or-later
"""The figures and the report on a small made-up study. Run: /usr/bin/python3 -m unittest discover tests/figures"""
import contextlib
import io
import json
import os
import struct
import subprocess
import sys
import tempfile
import types
import unittest
from html.parser import HTMLParser

from osgeo import osr

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, HERE)
import mock_study  # noqa: E402

PROGRAM = os.environ.get("THALWEG_FIGURES", os.path.join(HERE, "..", "..", "tools", "figures", "thalweg_figures.py"))
sys.path.insert(0, os.path.dirname(os.path.realpath(PROGRAM)))
import maps  # noqa: E402
import style  # noqa: E402
import thalweg_figures  # noqa: E402

EXPECTED = {"analyze": ("measure", ("map", "hypsometry", "slope_area", "horton")),
            "simulate": ("simulate", ("map", "hypsometry", "slope_area", "history")),
            "fit": ("fit", ("slope_area",)), "compare": ("compare", ("slope_area", "hypsometry", "horton"))}


def run_here(*arguments):
    """In this process: what it loads is loaded once for all tests."""
    errors = io.StringIO()
    with contextlib.redirect_stderr(errors):
        code = thalweg_figures.main(list(arguments))
    return types.SimpleNamespace(returncode=code, stderr=errors.getvalue(), stdout="")


def run_apart(*arguments):
    """As the thalweg program calls it."""
    return subprocess.run([sys.executable, "-I", PROGRAM, *arguments], capture_output=True, text=True, check=False)


def contents(path):
    with open(path, "rb") as stream:
        return stream.read()


def replace_numbers(value):
    """The same structure with every number null and every list empty."""
    if isinstance(value, dict):
        return {key: replace_numbers(each) for key, each in value.items()}
    if isinstance(value, list):
        return []
    return value if isinstance(value, str) else None


class Links(HTMLParser):
    """Collects everything that a browser would load or run."""

    def __init__(self):
        super().__init__()
        self.loaded, self.alternatives, self.tags = [], [], []

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        found = dict(attributes)
        self.loaded += [found[key] for key in ("src", "href", "srcset", "data") if found.get(key)]
        if tag == "img":
            self.alternatives.append(found.get("alt"))


class Figures(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.study = self.temporary.name
        mock_study.write_study(self.study)

    def tearDown(self):
        self.temporary.cleanup()

    def path(self, *parts):
        return os.path.join(self.study, *parts)

    def succeed(self, *arguments, run=run_here):
        result = run(*arguments)
        self.assertEqual((result.returncode, result.stderr, result.stdout), (0, "", ""), arguments)

    def test_a_study_drawn_at_once_in_another_process_has_the_bytes_of_its_parts_drawn_here(self):
        self.succeed("study", self.study, run=run_apart)
        for folder, names in EXPECTED.values():
            self.assertEqual(sorted(os.listdir(self.path(folder, "figures"))), sorted(f"{n}.png" for n in names))
            for image in (contents(self.path(folder, "figures", name + ".png")) for name in names):
                self.assert_is_small_picture(image)
        files = [self.path("report.html"), *(self.path("measure", "figures", n + ".png") for n in EXPECTED["analyze"][1])]
        first = [contents(file) for file in files]
        self.succeed("analyze", self.path("measure"))
        self.succeed("report", self.study)
        self.assertEqual(first, [contents(file) for file in files])

    def assert_is_small_picture(self, image):
        width, height = struct.unpack(">II", image[16:24])
        self.assertGreater(min(width, height), 300)
        self.assertGreater(len(image), 5000)
        self.assertLess(len(image), 400_000)
        self.assertNotIn(b"tIME", image)

    def assert_loads_nothing(self, page):
        links = Links()
        links.feed(page)
        self.assertEqual([link[:40] for link in links.loaded if not link.startswith(("data:image/", "#"))], [])
        self.assertNotIn("script", links.tags)
        self.assertNotRegex(page.split("</style>")[0], r"@import|url\(")
        self.assertEqual(len(links.alternatives), 6)
        self.assertTrue(all(links.alternatives))
        self.assertNotIn(self.study, page)

    def test_the_report_loads_nothing_shows_both_terrains_and_says_why_a_number_is_missing(self):
        for step, theta in (("basin", 0.4321), ("synthetic", 0.5678)):
            self.edit((step, "summary.json"), lambda content, value=theta: content["slope_area"].update(theta=value))
        self.succeed("report", self.study)
        page = contents(self.path("report.html")).decode()
        self.assertRegex(page, r"Concavity θ</th><td>0\.4321</td><td>0\.5678</td>")
        self.assertIn("1.10 × 10<sup>−6</sup>", page)
        self.assertIn("one DEM cannot tell whether uplift and incision balance", page)
        self.assertIn("0" * 64, page)
        self.assert_loads_nothing(page)
        self.assertRegex(page, r"Slope ratio <i>R</i><sub>S</sub></th><td>–<sup>a</sup></td>")
        self.assertIn("<sup>a</sup> slopes of the highest order are not known", page)

    def test_summaries_without_any_number_survive(self):
        for parts in (("measure", "summary.json"), ("basin", "summary.json"), ("synthetic", "summary.json"),
                      ("simulate", "summary.json"), ("fit", "fit.json"), ("compare", "comparison.json")):
            content = replace_numbers(json.loads(contents(self.path(*parts))))
            mock_study.write_json(self.path(*parts), content)
        for name in ("hypsometry.csv", "slope_area.csv", "slope_area_points.csv"):
            os.remove(self.path("measure", name))
        os.remove(self.path("simulate", "history.csv"))
        for command in ("fit", "compare"):
            self.succeed(command, self.path(command))
        self.succeed("report", self.study)
        self.assertNotRegex(contents(self.path("report.html")).decode().split("<figure")[0], r"\bnan\b|None")

    def test_a_missing_raster_is_one_line_and_exit_code_1(self):
        os.remove(self.path("measure", "filled.tif"))
        for arguments in (("analyze", self.path("measure")), ("report", self.study), ("draw", self.study), ("fit",)):
            result = run_here(*arguments)
            self.assertEqual(result.returncode, 1, arguments)
            self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)

    def test_projected_and_unreferenced_terrains_are_drawn_in_kilometres(self):
        utm = osr.SpatialReference()
        utm.ImportFromEPSG(32616)
        for name, crs in (("utm", utm), ("plain", None)):
            folder = self.path(name)
            summary = mock_study.write_terrain(folder, "filled.tif", mock_study.hills(50, 70), (700e3, 4050e3), 30.0, crs,
                                               30.0, 40)
            mock_study.write_json(os.path.join(folder, "summary.json"), summary)
            image = style.png(maps.single(os.path.join(folder, "filled.tif"), os.path.join(folder, "network.gpkg"))[0], 72)
            self.assertGreater(len(image), 5000)

    def edit(self, parts, change):
        content = json.loads(contents(self.path(*parts)))
        change(content)
        mock_study.write_json(self.path(*parts), content)


if __name__ == "__main__":
    unittest.main()
