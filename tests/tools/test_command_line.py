#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line as a script sees it: exit codes, one line per error, nothing half-written.

Usage: test_command_line.py THALWEG SOURCE_FOLDER
"""
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


def thalweg(*arguments, limit_bytes=None, stderr=subprocess.PIPE):
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit_bytes, limit_bytes))

    return subprocess.run([THALWEG, *map(str, arguments)], stdout=subprocess.PIPE, stderr=stderr, text=True, timeout=300,
                          preexec_fn=limit if limit_bytes else None)


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
        self.refused("analyze", DEM, "--condition", "burn", *out, saying="burn")
        self.refused("analyze", DEM, "--threads", "-1", *out, saying="-1")
        self.refused("fit", DEM, "--uplift-m-per-yr", "much", *out, saying="--uplift-m-per-yr")
        self.refused("fit", DEM, "--method", "guess", *out, saying="guess")
        self.refused("fit", self.here, *out, saying=str(self.here))
        self.refused("simulate", self.here / "nowhere.toml", *out, saying="nowhere.toml")
        for change in ("river.k=-1", "river.m=abc", "river.erodability=1", "domain.nodes=0", "time.step_yr=inf"):
            self.refused("simulate", self.experiment, "--set", change, *out, saying=change.split("=")[0])

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
                                        "time.max_steps=1000000", "--set", "time.convergence=0"],
                                       stderr=subprocess.PIPE, text=True)
            self.wait_for_a_partial_folder()
            process.send_signal(sign)
            _, said = process.communicate(timeout=60)
            self.assertNotEqual(process.returncode, 0)
            self.assertEqual(len(said.splitlines()), 1, said)
            self.assertEqual(sorted(self.here.rglob("*")), before)

    def wait_for_a_partial_folder(self):
        for _ in range(600):
            if list(self.here.glob(".out*")):
                return
            time.sleep(0.05)
        self.fail("the command did not start")

    def test_a_fit_without_uplift_tells_what_slopes_alone_can_tell(self):
        result = thalweg("fit", DEM, "--out", self.here / "fit", "--json", "--no-figures")
        self.assertEqual(result.returncode, 0, result.stderr)
        fit = json.loads(result.stdout)
        self.assertIsNone(fit["k"])
        self.assertGreater(fit["theta"], 0)
        self.assertGreater(fit["k_over_uplift"], 0)
        self.assertTrue(any("uplift" in note for note in fit["notes"]), fit["notes"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
