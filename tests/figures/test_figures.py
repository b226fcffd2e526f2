# SPDX-License-Identifier: GPL-3.0-or-later
"""The figures and the report on a small made-up study. Run: /usr/bin/python3 -m unittest discover tests/figures"""
import base64
import contextlib
import io
import itertools
import json
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import types
import unittest
from html.parser import HTMLParser

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from osgeo import ogr, osr

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, HERE)
import mock_study  # noqa: E402

PROGRAM = os.environ.get("THALWEG_FIGURES", os.path.join(HERE, "..", "..", "tools", "figures", "thalweg_figures.py"))
sys.path.insert(0, os.path.dirname(os.path.realpath(PROGRAM)))
import curves  # noqa: E402
import growth  # noqa: E402
import maps  # noqa: E402
import report  # noqa: E402
import sides  # noqa: E402
import study  # noqa: E402
import style  # noqa: E402
import thalweg_figures  # noqa: E402

EXPECTED = {"analyze": ("basin", ("map", "hypsometry", "slope_area", "horton")),
            "simulate": ("simulate", ("map", "hypsometry", "slope_area", "history", "horton")),
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


def heighten(content):
    """Twice the relief of the real terrain."""
    content["input"]["elevation_max_m"] = content["input"]["elevation_min_m"] + 800.0


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
    @classmethod
    def setUpClass(cls):
        """One study, drawn once as the thalweg program has it drawn: the tests read it, or change a copy of it."""
        style.prepare()
        cls.temporary = tempfile.TemporaryDirectory()
        cls.study = os.path.join(cls.temporary.name, "drawn")
        mock_study.write_study(cls.study)
        cls.undrawn = shutil.copytree(cls.study, os.path.join(cls.temporary.name, "undrawn"))
        for step, theta in (("basin", 0.4321), ("synthetic", 0.5678)):
            cls.edit(cls.study, (step, "summary.json"),
                     lambda content, value=theta: content["slope_area"].update(theta=value))
        cls.edit(cls.study, ("synthetic", "summary.json"), heighten)
        cls.edit(cls.study, ("simulate", "summary.json"), lambda content: content["notes"].update(converged="not quite"))
        cls.drawing = run_apart("study", cls.study)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def changeable(self):
        """A copy of the study without figures."""
        folder = tempfile.mkdtemp(dir=self.temporary.name)
        return shutil.copytree(self.undrawn, folder, dirs_exist_ok=True)

    def succeed(self, *arguments):
        result = run_here(*arguments)
        self.assertEqual((result.returncode, result.stderr), (0, ""), arguments)

    def page(self):
        return contents(os.path.join(self.study, "report.html")).decode()

    def assert_says(self, page, *sentences):
        for sentence in sentences:
            self.assertTrue(sentence in page, f"the report does not say: {sentence}")

    def test_a_study_drawn_at_once_in_another_process_has_the_bytes_of_its_parts_drawn_here(self):
        drawing = self.drawing
        self.assertEqual((drawing.returncode, drawing.stderr, drawing.stdout), (0, "", ""))
        for folder, names in EXPECTED.values():
            figures = os.path.join(self.study, folder, "figures")
            self.assertEqual(sorted(os.listdir(figures)), sorted(f"{name}.png" for name in names))
            for name in names:
                self.assert_is_small_picture(contents(os.path.join(figures, name + ".png")))
        for name, figure in itertools.islice(thalweg_figures.figures_of_analyze(os.path.join(self.study, "basin")), 2):
            first = contents(os.path.join(self.study, "basin", "figures", name + ".png"))
            self.assertTrue(first == style.png(figure, palette=name == "map"), name)
        curve = style.svg(curves.hypsometry(study.Study(self.study).sides()))
        self.assert_says(self.page(), base64.b64encode(curve).decode())

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
        self.assertFalse("script" in links.tags)
        self.assertNotRegex(page.split("</style>")[0], r"@import|url\(")
        self.assertEqual(len(links.alternatives), 6)
        self.assertTrue(all(links.alternatives))
        self.assertFalse(self.study in page)

    def test_the_report_loads_nothing_shows_both_terrains_and_says_why_a_number_is_missing(self):
        page = self.page()
        self.assert_loads_nothing(page)
        self.assert_says(page, "Concavity θ, regression</th><td>0.4321</td><td>0.5678</td>", "1.10 × 10<sup>−6</sup>",
                         "one DEM cannot tell whether uplift and incision balance", "0" * 64,
                         "Slope ratio <i>R</i><sub>S</sub></th><td>–<sup>a</sup></td>",
                         "<sup>a</sup> slopes of the highest order are not known", "ln(ratio of real / ratio of synthetic)")

    def test_the_report_tells_the_relief_of_both_terrains_and_explains_one_that_is_far_off(self):
        page = self.page()
        self.assert_says(page, "rises 397 m from its lowest to its highest point, the synthetic one 800 m, 2.0 times",
                         "The fitted law holds on channels only", "Relief (highest − lowest)</th><td>397</td><td>800</td>")
        folder = self.changeable()
        lead = report.header(study.Study(folder), "")
        self.assert_says(lead, "rises 397 m from its lowest to its highest point, the synthetic one 317 m.")
        self.assertFalse("holds on channels only" in lead)

    def test_k_is_never_given_without_its_interval(self):
        self.assert_says(self.page(), "<i>k</i> = 1.10 × 10<sup>−6</sup> m<sup>1−2<i>m</i></sup>/yr (95 %: 7.00 × "
                         "10<sup>−7</sup> to 1.50 × 10<sup>−6</sup>)")

    def test_reasons_of_empty_values_are_folded_away_and_warnings_are_not(self):
        notes = self.page().split('id="notes"')[1].split("</section>")[0]
        shown, folded = notes.split("<details>")
        self.assertIn("not quite", shown)
        self.assertNotIn("slopes of the highest order", shown)
        self.assertIn("slopes of the highest order", folded)

    def test_a_note_on_an_absent_headline_is_a_warning(self):
        folder = self.changeable()
        self.edit(folder, ("basin", "summary.json"), lambda content: content.update(
            slope_area={"theta": None, "bins": []}, notes=["slope_area: fewer than three bins"]))
        found = {note[2]: note[3] for note in study.Study(folder).notes()}
        self.assertFalse(found["fewer than three bins"])
        self.assertTrue(found["one DEM cannot tell whether uplift and incision balance"])

    def test_each_model_is_shown_with_the_values_that_were_found(self):
        folder = self.changeable()
        asked, simulated, grown = "mean_junction = 0.5", "k = 1.25e-06", "mean_junction = 0.4375"
        mock_study.write_growth(folder)
        for step, text in (("", asked), ("simulate", simulated), ("grow", grown)):
            with open(os.path.join(folder, step, "experiment.toml"), "w", encoding="utf-8") as stream:
                stream.write(text + "\n")
        found = report.provenance(study.Study(folder))
        self.assertIn(simulated, found.split("The experiment that was simulated, every value resolved")[1])
        self.assertIn(grown, found.split("The experiment that was grown, every value resolved")[1])
        self.assertNotIn(asked + "\n", found)
        for step in ("simulate", "grow"):
            os.remove(os.path.join(folder, step, "experiment.toml"))
        self.assertIn(asked, report.provenance(study.Study(folder)).split("The experiment, every value resolved")[1])

    def test_warnings_of_growth_and_of_the_study_itself_are_shown(self):
        folder = self.changeable()
        mock_study.write_growth(folder)
        coarse, relief = "cells of 82 m are coarse for links of 99 m: the raster", "the grown relief is 9 m: another seed"
        self.edit(folder, ("grow", "summary.json"), lambda content: content.update(notes=[coarse]))
        self.edit(folder, ("manifest.json",), lambda content: content.update(notes=[relief]))
        shown = report.notes(study.Study(folder)).split("<details>")[0]
        self.assertIn(f"<li><b>grow</b>: {coarse}</li>", shown)
        self.assertIn(f"<li><b>run</b>: {relief}</li>", shown)

    def test_no_steady_line_is_drawn_where_uplift_varies_and_the_reason_is_told(self):
        folder = os.path.join(self.changeable(), "simulate")
        side = sides.from_folder(folder, "simulated", "synthetic")
        (area, slope), why = sides.theory(folder, side)
        self.assertEqual(why, "")
        self.assertAlmostEqual(slope[0] / (100 * area[0]**-0.45), 1)
        with open(os.path.join(folder, "experiment.toml"), "w", encoding="utf-8") as stream:
            stream.write(mock_study.EXPERIMENT.replace("[river]", 'pattern = "radial"\n[river]'))
        line, why = sides.theory(folder, side)
        self.assertIsNone(line)
        self.assertIn("uplift (radial)", why)

    def test_the_key_of_a_map_fits_the_figure_however_many_orders_there_are(self):
        for highest in (1, 4, 7, 12):
            drawing = Figure(figsize=(6.5, 4))
            FigureCanvasAgg(drawing)
            beside = drawing.add_axes([0.02, 0, 0.7, 0.1])  # not in the middle, as beside a key of colours
            maps.draw_key(beside, 1, highest, [("catchment", 0.5), ("the studied one", 1.4)])
            key = drawing.axes[0].get_legend()
            words = [text.get_text() for text in key.get_texts()]
            extent = key.get_window_extent(drawing.canvas.get_renderer())
            self.assertGreaterEqual(extent.x0, 0)
            self.assertLessEqual(extent.x1, drawing.bbox.width)
            self.assertEqual(words[0], "river of Strahler order 1")
            self.assertEqual(words[-2:], ["catchment", "the studied one"])
            if highest > 1:
                self.assertIn(f"order {highest}", words)

    def test_a_map_names_catchments_in_its_key_only_where_it_outlines_any(self):
        folder = self.changeable()
        raster, network = (os.path.join(folder, "basin", name) for name in ("filled.tif", "network.gpkg"))
        self.assertIn("catchment", self.key_of(maps.single(raster, network)[0]))
        source = ogr.Open(network, 1)
        source.ExecuteSQL("UPDATE basins SET area_m2 = 1")
        del source
        self.assertNotIn("catchment", self.key_of(maps.single(raster, network)[0]))

    @staticmethod
    def key_of(drawing):
        keys = [axes.get_legend() for axes in drawing.axes if axes.get_legend()]
        return [text.get_text() for text in keys[0].get_texts()]

    def test_a_bin_without_an_error_is_told_from_those_with_one(self):
        side = curves.Side("one", style.LOOK["real"], bins=([1e6, 2e6, 4e6], [0.1, 0.05, 0.02], [0.01, 0.01, np.nan]))
        axes = Figure().add_subplot()
        curves.draw_slope_area(axes, side)
        drawn = {line.get_label(): list(line.get_xdata()) for line in axes.lines}
        self.assertEqual(drawn["bin of one piece: error not known"], [4e6])
        self.assertEqual([text.get_text() for text in axes.get_legend().get_texts()],
                         ["bin of one piece: error not known", "one: bin means ± 1 s.e."])

    def test_terrains_without_common_coordinates_are_drawn_in_kilometres_from_their_middles(self):
        folder = self.changeable()
        mock_study.write_growth(folder)
        real, grown = ([os.path.join(folder, step, name) for name in (raster, "network.gpkg")] + [step]
                       for step, raster in (("basin", "filled.tif"), ("grow", "elevation.tif")))
        axes = [each for each in maps.pair(real, grown).axes if each.get_xlabel()]
        for each in axes[:2]:
            self.assertEqual(each.get_xlabel(), "East of the middle (km)")
            rivers = np.concatenate([path.vertices for path in each.collections[0].get_paths()])
            (left, right), (bottom, top) = each.get_xlim(), each.get_ylim()
            self.assertTrue(left < rivers[:, 0].min() < 0 < rivers[:, 0].max() < right)
            self.assertTrue(bottom < rivers[:, 1].min() < 0 < rivers[:, 1].max() < top)
        self.assertEqual(axes[0].get_xlim(), axes[1].get_xlim())
        rows, cols = 60, 80  # of the real terrain: 1/1200 of a degree each
        height = (rows / 1200) * 111.32
        width = (cols / 1200) * 111.32 * np.cos(np.radians(36.6 - rows / 2400))
        image = axes[0].images[0].get_extent()
        margin = 1 + 2 * round(0.03 * cols) / np.array([cols, rows])
        np.testing.assert_allclose([image[1] - image[0], image[3] - image[2]], [width, height] * margin, rtol=1e-3)

    def test_a_report_on_two_models_speaks_of_both_from_the_start(self):
        folder = self.changeable()
        mock_study.write_growth(folder)
        both = study.Study(folder)
        lead = report.header(both, "")
        self.assert_says(lead, "stream-power and grown twins", "A network of 77 links grown there by empirical rules",
                         "and the grown one", '<i class="grown" title="grown"></i>')
        section = report.grown(both)
        self.assert_says(section, "basin area per channel length, C</th><td>1 067</td>", "<td>m</td>")
        self.assert_says(section, "verdict on the grown one", "<td>0.0830</td><td>0.0520</td><td>within the model")
        self.assertIn("20 other seeds", report._scale_words(both.grown_comparison))
        self.assertEqual(report._scale_words({"realisations": 0}), "")
        self.assertEqual(growth.rows_of(both.growth_fit)[0][0], "divide across from a tributary: spread (0.27)")

    def test_the_area_of_a_dot_follows_its_length(self):
        side = curves.Side("one", style.LOOK["real"], cloud=([1e6, 2e6, 0], [0.1, 0.01, 0.1], np.array([10.0, 100.0, 1e9])))
        axes = Figure().add_subplot()
        curves.draw_slope_area(axes, side)
        small, large = axes.collections[0].get_sizes()
        self.assertAlmostEqual(large / small, 10)

    def test_horton_plots_have_whole_orders_and_say_where_there_are_two(self):
        side = curves.Side("Twin_a", style.LOOK["real"], {"strahler": [
            {"order": order, "streams": 12 // order**3, "mean_length_m": 1e3 * order} for order in (1, 2)]})
        axes = Figure().add_subplot()
        curves.draw_horton(axes, [side], "streams", "Streams", "RB", "$R_B$")
        self.assertEqual((list(axes.xaxis.get_majorticklocs()), len(axes.xaxis.get_minorticklocs())), ([1, 2], 0))
        self.assertEqual([text.get_text() for text in axes.get_legend().get_texts()], ["Twin_a (two orders only)"])

    def test_a_comparison_leaves_names_as_they_are(self):
        titles = next(thalweg_figures.figures_of_compare(os.path.join(self.study, "compare")))[1].axes
        self.assertEqual([axes.get_title(loc="left") for axes in titles], ["hills.tif", "simulate"])

    def test_summaries_without_any_number_survive(self):
        folder = self.changeable()
        for parts in (("measure", "summary.json"), ("basin", "summary.json"), ("synthetic", "summary.json"),
                      ("simulate", "summary.json"), ("fit", "fit.json"), ("compare", "comparison.json")):
            path = os.path.join(folder, *parts)
            mock_study.write_json(path, replace_numbers(json.loads(contents(path))))
        for name in ("hypsometry.csv", "slope_area.csv", "slope_area_points.csv"):
            os.remove(os.path.join(folder, "basin", name))
        os.remove(os.path.join(folder, "simulate", "history.csv"))
        for command in ("fit", "compare"):
            self.succeed(command, os.path.join(folder, command))
        self.succeed("report", folder)
        page = contents(os.path.join(folder, "report.html")).decode()
        self.assertNotRegex(page.split("<figure")[0], r"\bnan\b|None")

    def test_a_missing_raster_is_one_line_and_exit_code_1(self):
        folder = self.changeable()
        os.remove(os.path.join(folder, "measure", "filled.tif"))
        for arguments in (("analyze", os.path.join(folder, "measure")), ("report", folder), ("draw", folder), ("fit",)):
            result = run_here(*arguments)
            self.assertEqual(result.returncode, 1, arguments)
            self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)

    def test_projected_and_unreferenced_terrains_are_drawn_in_kilometres(self):
        utm = osr.SpatialReference()
        utm.ImportFromEPSG(32616)
        for name, crs in (("utm", utm), ("plain", None)):
            folder = os.path.join(self.temporary.name, name)
            summary = mock_study.write_terrain(folder, "filled.tif", mock_study.hills(50, 70), (700e3, 4050e3), 30.0, crs,
                                               30.0, 40)
            mock_study.write_json(os.path.join(folder, "summary.json"), summary)
            image = style.png(maps.single(os.path.join(folder, "filled.tif"), os.path.join(folder, "network.gpkg"))[0], 72)
            self.assertGreater(len(image), 5000)

    @staticmethod
    def edit(folder, parts, change):
        path = os.path.join(folder, *parts)
        content = json.loads(contents(path))
        change(content)
        mock_study.write_json(path, content)


if __name__ == "__main__":
    unittest.main()
