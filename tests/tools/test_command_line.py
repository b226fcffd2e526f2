#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line as a script sees it: exit codes, one line per error, nothing half-written.

Usage: test_command_line.py THALWEG SOURCE_FOLDER
"""
import ctypes
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

THALWEG, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
DEM = SOURCE / "validation/data/jacksboro.tif"

EXPERIMENT = """seed = 3
[domain]
size_m = [10000, 8000]
nodes = 1000
[uplift]
rate_m_per_yr = 1e-3
[river]
k = 2e-5
m = 0.5
[time]
step_yr = 1e5
max_steps = 10
"""


def without_privileges():
    """From here on root, too, may do only what the rights of files allow (Linux: SECBIT_NOROOT)."""
    if os.geteuid() == 0 and ctypes.CDLL(None, use_errno=True).prctl(28, 1, 0, 0, 0) != 0:
        raise OSError(ctypes.get_errno(), "prctl")


def thalweg(*arguments, limit_bytes=None, stderr=subprocess.PIPE, preexec=None):
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit_bytes, limit_bytes))

    return subprocess.run([THALWEG, *map(str, arguments)], stdout=subprocess.PIPE, stderr=stderr, text=True, timeout=300,
                          preexec_fn=limit if limit_bytes else preexec)


class CommandLine(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.here = Path(self.folder.name)
        self.experiment = self.here / "experiment.toml"
        self.experiment.write_text(EXPERIMENT)

    def refused(self, *arguments, saying, code=2, **options):
        """The command fails with one line that says `saying`, and changes nothing on disk."""
        before = sorted(self.here.rglob("*"))
        result = thalweg(*arguments, **options)
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertTrue(result.stderr.startswith("thalweg: error: "), result.stderr)
        self.assertIn(saying, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(sorted(self.here.rglob("*")), before)

    def test_render_writes_one_picture_whole_or_not_at_all(self):
        view = self.here / "view.png"
        draw = ["render", DEM, "--size", "96x64", "--samples", 1, "--out"]
        result = thalweg(*draw, view, "--json", "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads(result.stdout), {"file": "view.png", "width": 96, "height": 64})
        self.assertEqual(view.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.refused(*draw, view, saying="--force")
        self.refused(*draw, self.here / "view.jpg", saying=".png or .svg")
        self.refused(*draw, self.here / "other.png", "--size", "96", saying="--size")
        self.refused(*draw, self.here / "other.png", "--color", "pink", saying="clay, kelley, elevation")
        self.refused(*draw, self.here / "other.png", "--elevation-angle", 120, saying="90")
        self.refused("render", self.here / "no.tif", "--out", self.here / "other.png", saying="no.tif")
        self.refused(*draw, self.here / "full.png", saying="full", limit_bytes=500)
        self.assertEqual(thalweg(*draw, view, "--force").returncode, 0)
        self.assertEqual([p.name for p in self.here.iterdir() if p.name.startswith(".")], [])

    def test_help_and_version_explain_themselves(self):
        self.assertIn("analyze", thalweg("--help").stdout)
        for command in ("analyze", "simulate", "fit", "compare", "run", "fetch"):
            result = thalweg(command, "--help")
            self.assertEqual(result.returncode, 0)
            self.assertIn("--out", result.stdout)
        self.assertIn("river.k", thalweg("simulate", "--help").stdout)
        for library in ("thalweg", "GDAL", "CGAL", "Ceres", "GeographicLib"):
            self.assertIn(library, thalweg("version").stdout)

    def test_a_dem_that_cannot_be_read_is_refused(self):
        out = ["--out", self.here / "out"]
        text, empty, cut = self.here / "text.tif", self.here / "empty.tif", self.here / "cut.tif"
        text.write_text("not a raster\n")
        empty.write_bytes(b"")
        cut.write_bytes(DEM.read_bytes()[:60000])
        for path in (self.here / "nowhere.tif", text, empty, cut, self.here, "/dev/null"):
            self.refused("analyze", path, *out, saying=str(path))

    def test_what_the_user_types_wrong_is_refused(self):
        out = ["--out", self.here / "out"]
        self.refused("analyze", DEM, "--nonsense", *out, saying="--nonsense")
        self.refused("analyze", *out, saying="DEM")
        self.refused("erode", saying="erode")
        self.refused(saying="subcommand")
        for value in ("-5", "0", "nan", "inf", "much"):
            self.refused("analyze", DEM, "--channel-area-m2", value, *out, saying="--channel-area-m2")
        self.refused("analyze", DEM, "--crs", "EPSG:0", *out, saying="EPSG:0")
        for option in ("--crs", "--nodata", "--theta", "--heads", "--reproject"):
            self.refused("analyze", DEM, option, "", *out, saying=option + ": has an empty value")
        self.refused("analyze", "", *out, saying="DEM: has an empty value")
        for option in ("--crs", "--cell-m"):
            self.refused("fit", DEM, option, "", *out, saying=option)
            self.refused("compare", DEM, DEM, option, "", *out, saying=option)
        self.refused("simulate", self.experiment, "--set", "", *out, saying="--set")
        self.refused("analyze", DEM, "--condition", "burn", *out, saying="burn")
        self.refused("analyze", DEM, "--threads", "-1", *out, saying="-1")
        self.refused("fit", DEM, "--uplift-m-per-yr", "much", *out, saying="--uplift-m-per-yr")
        self.refused("fit", DEM, "--method", "guess", *out, saying="guess")
        self.refused("fit", self.here, *out, saying=str(self.here))
        self.refused("simulate", self.here / "nowhere.toml", *out, saying="nowhere.toml")
        for change in ("river.k=-1", "river.m=abc", "river.erodability=1", "domain.nodes=0", "time.step_yr=inf"):
            self.refused("simulate", self.experiment, "--set", change, *out, saying=change.split("=")[0])

    def test_heads_say_where_channels_begin(self):
        def place(x, y):
            return {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [x, y]}}

        heads, lines = self.here / "heads.geojson", self.here / "none.geojson"
        heads.write_text(json.dumps({"type": "FeatureCollection", "features": [
            place(-84.2, 36.4), place(-84.25, 36.3), place(-84.2, 36.4), place(10, 50)]}))
        lines.write_text(json.dumps({"type": "FeatureCollection", "features": []}))
        done = thalweg("analyze", DEM, "--heads", heads, "--keep-edge-basins", "--out", self.here / "out", "--json",
                       "--no-figures")
        self.assertEqual(done.returncode, 0, done.stderr)
        channels = json.loads(done.stdout)["channels"]
        self.assertEqual(channels["rule"], "heads")
        self.assertEqual(channels["heads"], {"given": 4, "outside": 1, "merged": 1})
        self.assertEqual(channels["sources"], 2)
        self.assertIsNone(channels["threshold_area_m2"])
        self.assertIn("(10, 50)", done.stderr)
        out = ["--out", self.here / "refused"]
        self.refused("analyze", DEM, "--heads", lines, *out, saying="no points")
        self.refused("analyze", DEM, "--heads", self.here / "nowhere.gpkg", *out, saying="nowhere.gpkg")
        self.refused("analyze", DEM, "--heads", DEM, *out, saying="no vector file")
        self.refused("analyze", DEM, "--heads", heads, "--channel-area-m2", "1e5", *out, saying="--channel-area-m2")
        self.refused("analyze", DEM, "--heads", heads, "--channels", "drop", *out, saying="--channels")
        self.refused("analyze", DEM, "--channels", "drop", "--channel-area-m2", "1e5", *out, saying="--channels drop")
        self.refused("analyze", DEM, "--slope-area-m2", "1e5", *out, saying="--slope-area-m2")
        self.refused("analyze", DEM, "--channels", "guess", *out, saying="guess")
        self.refused("analyze", DEM, "--heads-snap-m", "50", *out, saying="--heads-snap-m")
        self.refused("analyze", DEM, "--heads", heads, "--heads-snap-m", "-5", *out, saying="--heads-snap-m")
        self.refused("analyze", DEM, "--relief-radius-m", "500", *out, saying="--derivatives")
        self.refused("analyze", DEM, "--derivatives", "--relief-radius-m", "5", *out, saying="--relief-radius-m 5")
        self.refused("analyze", DEM, "--derivatives", "--relief-radius-m", "0", *out, saying="--relief-radius-m")
        heads.write_text(json.dumps({"type": "FeatureCollection", "features": [place(10, 50)]}))
        self.refused("analyze", DEM, "--heads", heads, *out, saying="(10, 50)")

    def test_an_outlet_is_looked_for_where_the_dem_has_data(self):
        out = ["--out", self.here / "refused"]
        for command in ("analyze", "fit"):
            self.refused(command, DEM, "--outlet", "10", "50", *out, saying="beside the DEM")
            self.refused(command, DEM, "--outlet", "10", *out, saying="--outlet")
            self.refused(command, DEM, "--outlet", "here", "50", *out, saying="'here'")
            self.refused(command, DEM, "--outlet", "-84.2", "36.3", "--snap-m", "-1", *out, saying="--snap-m")
            self.refused(command, DEM, "--snap-m", "100", *out, saying="--outlet")
        measured = self.here / "measured"
        self.assertEqual(thalweg("analyze", DEM, "--out", measured, "--no-figures").returncode, 0)
        self.refused("fit", measured, "--outlet", "-84.2", "36.3", *out, saying="--outlet")

    def test_parts_of_a_dem_are_read_and_put_on_other_cells(self):
        def measured(*options):
            done = thalweg("analyze", DEM, *options, "--out", self.here / "out", "--force", "--json", "--no-figures")
            self.assertEqual(done.returncode, 0, done.stderr)
            return json.loads(done.stdout)["input"]

        whole, part = measured(), measured("--crop", "-84.2", "36.25", "-84.0", "36.4")
        self.assertLess(part["area_m2"], 0.5 * whole["area_m2"])
        self.assertLess(measured("--sea-level", "400")["valid_cells"], whole["valid_cells"])
        warped = measured("--reproject", "EPSG:32616", "--cell-m", "180")
        self.assertEqual((warped["crs"], warped["geographic"], warped["dx_m"]), ("EPSG:32616", False, 180))
        # Cells that the edge cuts count whole, about half a cell on every side.
        self.assertAlmostEqual(warped["area_m2"] / whole["area_m2"], 1, delta=0.02)
        out = ["--out", self.here / "refused"]
        self.refused("analyze", DEM, "--crop", "-84", "36.4", "-84.2", "36.25", *out, saying="west, south, east and north")
        self.refused("analyze", DEM, "--crop", "5", "36", "6", "37", *out, saying="reaches from -84")
        self.refused("analyze", DEM, "--band", "2", *out, saying="no band 2")
        self.refused("analyze", DEM, "--band", "1.5", *out, saying="--band")
        for cell in ("1e9", "1e-3"):
            self.refused("analyze", DEM, "--reproject", "EPSG:32616", "--cell-m", cell, *out, saying="give a --cell-m of")
        self.refused("analyze", DEM, "--cell-m", "100", *out, saying="projected coordinate system")
        self.refused("analyze", DEM, "--reproject", "nowhere", *out, saying="'nowhere'")
        self.refused("analyze", DEM, "--sea-level", "9000", *out, saying="no data")

    def test_depressions_are_filled_cut_or_kept_as_asked(self):
        def conditioned(*options):
            done = thalweg("analyze", DEM, *options, "--out", self.here / "out", "--force", "--json", "--no-figures")
            self.assertEqual(done.returncode, 0, done.stderr)
            return json.loads(done.stdout)["conditioning"]

        filled, breached = conditioned(), conditioned("--condition", "breach")
        self.assertEqual((filled["cut_m3"], breached["filled_m3"]), (0, 0))
        self.assertEqual(breached["method"], "breach")
        self.assertGreater(breached["cut_m3"], 0)
        both = conditioned("--condition", "breach", "--breach-depth-m", "5", "--breach-length-m", "500")
        self.assertGreater(both["filled_m3"], 0)
        self.assertGreater(both["cut_m3"], 0)
        kept = conditioned("--endorheic-depth-m", "5")
        self.assertGreater(kept["endorheic_basins"], 0)
        self.assertLess(kept["filled_m3"], filled["filled_m3"])
        self.assertLess(conditioned("--endorheic-depth-m", "5", "--endorheic-area-m2", "1e5")["endorheic_basins"],
                        kept["endorheic_basins"])
        out = ["--out", self.here / "refused"]
        self.refused("analyze", DEM, "--breach-depth-m", "5", *out, saying="--condition breach")
        self.refused("analyze", DEM, "--endorheic-depth-m", "-5", *out, saying="--endorheic-depth-m")
        ridge = self.here / "ridge.geojson"
        ridge.write_text(json.dumps({"type": "Point", "coordinates": [-84.41, 36.44]}))
        self.refused("analyze", DEM, "--endorheic-points", ridge, *out, saying="no closed depression")

    def test_results_that_exist_are_kept_unless_force_is_given(self):
        out = self.here / "out"
        self.assertEqual(thalweg("simulate", self.experiment, "--out", out, "--no-figures").returncode, 0)
        self.refused("simulate", self.experiment, "--out", out, saying="--force")
        self.refused("simulate", self.experiment, "--out", out, "--force", "--set", "river.k=-1", saying="river.k")
        self.assertTrue((out / "elevation.tif").is_file())
        again = thalweg("simulate", self.experiment, "--out", out, "--no-figures", "--force")
        self.assertEqual(again.returncode, 0, again.stderr)

    def test_a_place_that_cannot_be_written_is_refused(self):
        (self.here / "file").write_text("")
        self.refused("simulate", self.experiment, "--out", self.here / "file/below", saying="cannot write")
        self.refused("simulate", self.experiment, "--out", "/proc/out", saying="cannot write")
        self.refused("simulate", self.experiment, "--out", "", saying="--out")
        self.refused("simulate", self.experiment, "--out", "/", "--force", saying="root of all folders")
        self.refused("simulate", self.experiment, "--out", self.here / ("x" * 300), saying="cannot write")

    def test_a_folder_without_the_rights_to_write_or_replace_it_is_refused_before_the_work(self):
        locked, out = self.here / "locked", self.here / "out"
        (locked / "in").mkdir(parents=True)
        (out / "below").mkdir(parents=True)
        (out / "below/file").write_text("")
        (out / ".thalweg-files").write_text("below/file\n")
        self.addCleanup(subprocess.run, ["chmod", "-R", "u+rwx", self.here], check=True)
        if subprocess.run(["true"], preexec_fn=without_privileges).returncode != 0:
            self.skipTest("root cannot give up its privileges here")

        def refused(where, saying, *more):
            self.refused("simulate", self.experiment, "--no-figures", "--out", where, *more, saying=saying,
                         preexec=without_privileges)

        locked.chmod(0o555)
        refused(locked / "out", "cannot write into")
        refused(locked / "in/../out", "cannot write into")
        locked.chmod(0o000)
        refused(locked / "out", "cannot write into")
        refused(locked / "in/out", "cannot write into")
        locked.chmod(0o755)
        (out / "below").chmod(0o555)
        refused(out, "no permission to delete", "--force")
        out.chmod(0o000)
        refused(out, "cannot be looked into", "--force")
        out.chmod(0o755)
        (out / "below").chmod(0o755)
        done = thalweg("simulate", self.experiment, "--no-figures", "--out", out, "--force", preexec=without_privileges)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertFalse((out / "below").exists())

    def test_a_full_disk_leaves_no_debris(self):
        for limit_bytes in (1000, 20000, 100000):
            self.refused("simulate", self.experiment, "--out", self.here / "out", "--no-figures", saying="",
                         limit_bytes=limit_bytes)
            self.refused("analyze", DEM, "--out", self.here / "out", "--no-figures", saying="",
                         limit_bytes=limit_bytes)

    def test_a_small_file_system_that_fills_up_leaves_no_debris(self):
        mount = self.here / "small"
        mount.mkdir()
        if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=300k", "tmpfs", mount],
                                               capture_output=True).returncode != 0:
            self.skipTest("only root can mount a small file system")
        self.addCleanup(subprocess.run, ["umount", mount], check=True)
        self.refused("analyze", DEM, "--out", mount / "out", "--no-figures", saying="")
        self.refused("simulate", self.experiment, "--out", mount / "out", "--set", "output.resolution=1000",
                     "--no-figures", saying="")

    def test_json_goes_to_standard_output_and_nothing_else_does(self):
        result = thalweg("analyze", DEM, "--out", self.here / "out", "--json", "--quiet", "--no-figures")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads(result.stdout), json.loads((self.here / "out/summary.json").read_text()))
        self.assertEqual(result.stderr, "")

    def test_an_interrupted_command_leaves_no_debris(self):
        before = sorted(self.here.rglob("*"))
        for sign in (signal.SIGINT, signal.SIGTERM):
            process = subprocess.Popen([THALWEG, "simulate", self.experiment, "--out", self.here / "out", "--set",
                                        "time.max_steps=1000000", "--set", "time.convergence=0", "--quiet"],
                                       stderr=subprocess.PIPE, text=True)
            self.wait_for_a_partial_folder()
            process.send_signal(sign)
            _, said = process.communicate(timeout=60)
            self.assertNotEqual(process.returncode, 0)
            self.assertEqual(len(said.splitlines()), 1, said)
            self.assertEqual(sorted(self.here.rglob("*")), before)

    def test_a_drawing_that_is_interrupted_leaves_neither_debris_nor_python(self):
        before = sorted(self.here.rglob("*"))
        process = subprocess.Popen([THALWEG, "analyze", DEM, "--out", self.here / "out", "--quiet"],
                                   stderr=subprocess.PIPE, text=True)
        self.wait_for_a_partial_folder("figures")  # made by Python before the first of them is drawn
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=60)  # returns only when Python has let go of the pipe, too
        self.assertEqual(process.returncode, 128 + signal.SIGINT, said)
        self.assertEqual(len(said.splitlines()), 1, said)
        self.assertEqual(sorted(self.here.rglob("*")), before)

    def test_a_log_is_told_of_each_phase_of_long_work_on_a_line_of_its_own(self):
        endless = [THALWEG, "simulate", self.experiment, "--out", self.here / "out", "--set", "time.max_steps=100000000",
                   "--set", "time.convergence=0", "--no-figures"]
        process = subprocess.Popen(endless, stderr=subprocess.PIPE, text=True)
        told = process.stderr.readline()  # waits for it
        process.send_signal(signal.SIGTERM)
        _, rest = process.communicate(timeout=60)
        self.assertRegex(told, r"^thalweg: (simulating|step|making the mesh).*\n$")
        self.assertNotIn("\r", told + rest)
        self.assertRegex(rest.splitlines()[-1], "^thalweg: error: stopped")

    def wait_for_a_partial_folder(self, holding=""):
        until = time.monotonic() + 120
        while time.monotonic() < until:
            if list(self.here.glob(".out*/" + holding if holding else ".out*")):
                return
            time.sleep(0.05)
        self.fail("the command did not start")

    def test_results_that_were_edited_are_refused_where_they_make_no_sense(self):
        measured, out = self.here / "measured", ["--no-figures", "--out", self.here / "out"]
        self.assertEqual(thalweg("analyze", DEM, "--out", measured, "--no-figures").returncode, 0)
        bins = measured / "slope_area.csv"
        lines = bins.read_text().splitlines()
        area, slope, error, _ = lines[1].split(",")
        for edited in (f"{area},{slope},,100", f"{area},{slope},{error},0", f"{area},{slope},{error},-3",
                       f"{area},{slope},{error},2.5"):
            bins.write_text("\n".join([lines[0], edited, *lines[2:]]) + "\n")
            self.refused("fit", measured, *out, saying="line 2")
        summary = json.loads((measured / "summary.json").read_text())
        summary["hypsometry"]["relative_area"] = []
        (measured / "summary.json").write_text(json.dumps(summary))
        self.refused("compare", measured, measured, *out, saying="summary.json")

    def test_exponents_beyond_reason_are_refused(self):
        out = ["--no-figures", "--out", self.here / "out"]
        for value in ("1e-300", "0.29", "1e300"):
            self.refused("fit", DEM, "--n", value, *out, saying="--n")
        for value in ("0", "-0.4", "2.01", "400"):
            self.refused("analyze", DEM, "--theta", value, *out, saying="--theta")
            self.refused("fit", DEM, "--theta-fixed", value, *out, saying="--theta-fixed")
        self.refused("fit", DEM, "--deposition-g", "-0.1", *out, saying="--deposition-g")
        self.refused("fit", DEM, "--theta-fixed", "1e300", *out, saying="--theta-fixed")

    def test_the_user_is_warned_where_most_rivers_are_left_out_or_a_run_is_not_steady(self):
        none = thalweg("analyze", DEM, "--channel-area-m2", "1e10", "--out", self.here / "a", "--no-figures", "--quiet")
        self.assertEqual(none.returncode, 0)
        self.assertIn("thalweg: warning: channels:", none.stderr)
        unsteady = thalweg("simulate", self.experiment, "--out", self.here / "s", "--no-figures", "--quiet")
        self.assertIn("not steady after 10 steps", unsteady.stderr)

    def test_growth_is_fitted_to_a_dem_and_takes_nothing_of_erosion(self):
        result = thalweg("fit", DEM, "--method", "growth", "--seed", "3", "--out", self.here / "growth", "--json",
                         "--no-figures")
        self.assertEqual(result.returncode, 0, result.stderr)
        fit = json.loads(result.stdout)
        self.assertEqual(fit["method"], "growth")
        self.assertIsNone(fit["k"])
        self.assertGreater(fit["growth"]["channel_maintenance_m"]["estimate"], 0)
        self.assertIn("seed = 3", (self.here / "growth" / "growth.toml").read_text())
        self.refused("fit", DEM, "--method", "growth", "--n", "2", "--out", self.here / "no", saying="--n")
        self.refused("fit", DEM, "--seed", "2", "--out", self.here / "no", saying="--seed")
        for seed in ("-2", "1.5", "1e30", "18446744073709551616"):
            self.refused("fit", DEM, "--method", "growth", "--seed", seed, "--out", self.here / "no", saying="--seed")

    def test_a_fit_without_uplift_tells_what_slopes_alone_can_tell(self):
        result = thalweg("fit", DEM, "--out", self.here / "fit", "--json", "--no-figures")
        self.assertEqual(result.returncode, 0, result.stderr)
        fit = json.loads(result.stdout)
        self.assertIsNone(fit["k"])
        self.assertGreater(fit["theta"], 0)
        self.assertGreater(fit["k_over_uplift"], 0)
        self.assertTrue(any("uplift" in note for note in fit["notes"]), fit["notes"])


class EveryOption(unittest.TestCase):
    """Each option has its own effect and no other."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.here = Path(cls.folder.name)
        cls.runs = 0
        (cls.here / "land.toml").write_text(EXPERIMENT)
        cls.result("simulate", cls.here / "land.toml", "--set", "domain.mesh=raster", "--set", "domain.nodes=5000",
                   "--set", "time.solver=steady")
        cls.dem = cls.here / "land.tif"
        cls.dem.write_bytes((cls.last / "elevation.tif").read_bytes())
        cls.bins = cls.here / "bins"
        cls.bins.mkdir()
        (cls.bins / "summary.json").write_text("{}")
        rows = [f"{area:g},{slope:g},{0.02 * slope:g},20\n" for area, slope in cls.broken_line()]
        (cls.bins / "slope_area.csv").write_text("area_m2,slope,slope_se,count\n" + "".join(rows))

    @staticmethod
    def broken_line():
        """Slopes that fall with A^-0.2 below 1e5 m2, with A^-0.4 up to 1e7 m2, and with A^-0.8 beyond."""
        for tenth in range(40, 81):
            area, exponent = 10 ** (tenth / 10 + 0.01), tenth / 10 + 0.01
            fall = 0.2 * min(exponent - 4, 1) + 0.4 * max(0, min(exponent, 7) - 5) + 0.8 * max(0, exponent - 7)
            yield area, 0.5 * 10 ** -fall

    @classmethod
    def result(cls, command, *arguments):
        """What the command prints as JSON; its folder is `cls.last`."""
        cls.runs += 1
        cls.last = cls.here / f"run{cls.runs}"
        done = thalweg(command, *arguments, "--out", cls.last, "--json", "--quiet", "--no-figures")
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        return json.loads(done.stdout)

    def alike(self, a, b, *keys):
        for key in keys:
            self.assertEqual(a[key], b[key], key)

    def same_files(self, a, b, *names):
        for name in names:
            self.assertEqual((a / name).read_bytes(), (b / name).read_bytes(), name)

    def fitted(self, *arguments):
        return self.result("fit", self.bins, "--uplift-m-per-yr", "1e-3", *arguments)

    def test_n_multiplies_m_and_leaves_theta(self):
        plain, squared = self.fitted(), self.fitted("--n", "2")
        self.alike(plain, squared, "area_range_m2", "uplift_m_per_yr")
        for key in ("theta", "theta_se", "ks", "reduced_chi2"):
            self.assertAlmostEqual(plain[key], squared[key], places=9)
        self.assertAlmostEqual(squared["m"], 2 * plain["theta"], places=12)
        self.assertAlmostEqual(plain["m"], plain["theta"], places=12)
        self.assertAlmostEqual(squared["k"] * squared["ks"] ** 2 / 1e-3, 1, places=9)

    def test_uplift_scales_k_alone(self):
        plain, doubled = self.fitted(), self.result("fit", self.bins, "--uplift-m-per-yr", "2e-3")
        self.alike(plain, doubled, "theta", "ks", "m", "m_se", "k_over_uplift", "area_range_m2")
        self.assertAlmostEqual(doubled["k"] / plain["k"], 2, places=12)

    def test_uplift_sd_widens_k_alone(self):
        plain, unsure = self.fitted(), self.fitted("--uplift-sd", "3e-4")
        self.alike(plain, unsure, "k", "theta", "theta_se", "ks", "ks_se", "m", "m_se", "k_over_uplift",
                   "k_over_uplift_se", "k_at_reference_area")
        self.assertEqual(unsure["uplift_sd_m_per_yr"], 3e-4)
        relative = [fit["k_at_reference_area_se"] / fit["k_at_reference_area"] for fit in (plain, unsure)]
        self.assertAlmostEqual(relative[1] ** 2 - relative[0] ** 2, 0.3 ** 2, places=9)

    def test_theta_fixed_holds_theta_alone(self):
        plain, held = self.fitted(), self.fitted("--theta-fixed", "0.45")
        self.alike(plain, held, "area_range_m2", "uplift_m_per_yr", "n")
        self.assertEqual(held["theta"], 0.45)
        self.assertEqual(held["m"], 0.45)
        self.assertNotAlmostEqual(plain["theta"], 0.45, places=2)
        self.assertEqual(self.fitted("--theta-fixed", "0.45", "--n", "2")["m"], 0.9)

    def test_area_min_and_area_max_cut_one_end_each(self):
        plain, low, high = self.fitted(), self.fitted("--area-min-m2", "1e5"), self.fitted("--area-max-m2", "1e7")
        both = self.fitted("--area-min-m2", "1e5", "--area-max-m2", "1e7")
        self.assertLess(plain["area_range_m2"][0], 1.1e4)
        self.assertGreater(plain["area_range_m2"][1], 9e7)
        for fit in (low, both):
            self.assertTrue(1e5 <= fit["area_range_m2"][0] < 1.3e5, fit["area_range_m2"])
        for fit in (high, both):
            self.assertTrue(0.79e7 < fit["area_range_m2"][1] <= 1e7, fit["area_range_m2"])
        self.assertEqual(low["area_range_m2"][1], plain["area_range_m2"][1])
        self.assertEqual(high["area_range_m2"][0], plain["area_range_m2"][0])
        self.assertAlmostEqual(both["theta"], 0.4, places=3)
        self.assertGreater(low["theta"], 0.42)
        self.assertLess(high["theta"], 0.39)

    def analyzed(self, *arguments, dem=None):
        return self.result("analyze", dem or self.dem, *arguments), self.last

    def test_channel_area_moves_the_sources_alone(self):
        (plain, at), (asked, there) = self.analyzed(), self.analyzed("--channel-area-m2", "300000")
        self.alike(plain, asked, "input", "conditioning", "hypsometry")
        self.same_files(at, there, "filled.tif", "flow_direction.tif", "drainage_area.tif", "hypsometry.csv")
        self.assertEqual(plain["channels"]["threshold_area_m2"], 1e5)
        self.assertEqual(asked["channels"]["threshold_area_m2"], 3e5)
        self.assertLess(asked["channels"]["sources"], plain["channels"]["sources"])

    def test_keep_edge_basins_counts_what_is_cut_alone(self):
        (plain, at), (kept, there) = self.analyzed(dem=DEM), self.analyzed("--keep-edge-basins", dem=DEM)
        self.alike(plain, kept, "input", "conditioning", "hypsometry")
        self.same_files(at, there, "filled.tif", "flow_direction.tif", "drainage_area.tif")
        self.assertEqual(kept["channels"]["threshold_area_m2"], plain["channels"]["threshold_area_m2"])
        self.assertLess(plain["channels"]["share_used"], 1)
        self.assertEqual(kept["channels"]["share_used"], 1)
        self.assertTrue(all(basin["complete"] for basin in plain["basins"]))
        self.assertFalse(all(basin["complete"] for basin in kept["basins"]))

    def test_nodata_takes_that_height_away_alone(self):
        plain, _ = self.analyzed()
        rim, _ = self.analyzed("--nodata", "0")  # the base level of the simulation
        cells = 2 * (plain["input"]["rows"] + plain["input"]["cols"]) - 4
        self.assertEqual(plain["input"]["nodata_cells"], 0)
        self.assertEqual(rim["input"]["nodata_cells"], cells)
        self.alike(plain["input"], rim["input"], "rows", "cols", "dx_m", "crs", "elevation_max_m", "sha256")
        self.assertGreater(rim["input"]["elevation_min_m"], 0)
        self.assertEqual(self.analyzed("--nodata", "-1")[0]["input"], plain["input"])

    def test_crs_gives_the_map_its_unit_alone(self):
        (plain, _), (metric, _) = self.analyzed(), self.analyzed("--crs", "EPSG:32611")
        self.assertEqual(metric["input"]["crs"], "EPSG:32611")
        self.alike(plain["input"], metric["input"], "dx_m", "dy_m", "area_m2", "valid_cells", "elevation_max_m")
        self.alike(plain, metric, "hypsometry", "channels", "slope_area")
        feet, _ = self.analyzed("--crs", "EPSG:2264")
        self.assertAlmostEqual(feet["input"]["dx_m"] / plain["input"]["dx_m"], 1200 / 3937, places=9)
        self.alike(plain["input"], feet["input"], "valid_cells", "rows")

    def test_condition_changes_what_is_done_to_pits_alone(self):
        pit = self.here / "pit.asc"
        pit.write_text("ncols 5\nnrows 5\nxllcorner 5000\nyllcorner 7000\ncellsize 10\n"
                       "10 10 10 10 10\n10 9 9 9 10\n10 9 7 9 10\n10 9 9 9 10\n10 10 10 10 8.5\n")
        expected = {"fill": (1, 200), "carve": (2, 350), "none": (0, 0)}
        results = {}
        for method, (cells, volume) in expected.items():
            summary = results[method] = self.result("analyze", pit, "--condition", method, "--channel-area-m2", "200")
            self.assertEqual(summary["conditioning"]["method"], method)
            self.assertEqual(summary["conditioning"]["cells_changed"], cells)
            self.assertAlmostEqual(summary["conditioning"]["volume_m3"], volume)
            self.assertEqual(summary["conditioning"]["pits"], 1)
            self.alike(summary, results["fill"], "input", "hypsometry")
        self.assertEqual(self.result("analyze", pit, "--channel-area-m2", "200")["conditioning"],
                         results["fill"]["conditioning"])

    def test_fit_and_compare_heed_the_options_of_a_dem_as_analyze_does(self):
        for options in ([], ["--channel-area-m2", "300000"], ["--keep-edge-basins"], ["--nodata", "0"],
                        ["--crs", "EPSG:2264"]):
            with self.subTest(options=options):
                dem = DEM if "--keep-edge-basins" in options else self.dem  # where edges cut something
                summary = self.result("analyze", dem, *options)
                measured = self.last
                self.alike(self.result("fit", dem, *options), self.result("fit", measured), "theta", "ks",
                           "theta_se", "area_range_m2")
                comparison = self.result("compare", dem, dem, *options)
                for side in ("a", "b"):
                    self.assertEqual(comparison[side]["channels"], summary["channels"])
                    self.assertEqual(comparison[side]["slope_area"]["theta"], summary["slope_area"]["theta"])

    def test_what_was_measured_before_is_not_measured_anew(self):
        for options in (["--channel-area-m2", "300000"], ["--keep-edge-basins"], ["--nodata", "0"],
                        ["--crs", "EPSG:2264"]):
            refusal = thalweg("fit", self.bins, *options, "--out", self.here / "refused")
            self.assertEqual(refusal.returncode, 2, refusal.stderr)
            self.assertIn("measured before", refusal.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
