#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A run that is killed again and again ends with the bytes of one that never was: test_resume.py THALWEG

Times of stopping are drawn from a fixed seed; when they strike the program depends on the machine, the result does not.
"""
import hashlib
import json
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

THALWEG = Path(sys.argv[1]).resolve()

EXPERIMENT = """seed = 5
[domain]
size_m = [12000, 9000]
nodes = 4000
mesh = "{mesh}"
[uplift]
rate_m_per_yr = 1e-3
history = "uplift.csv"
[base_level]
history = "level.csv"
[river]
k = 2e-5
m = 0.45
n = 1.4
[hillslope]
{hillslope}
[deposition]
g = {g}
[time]
step_yr = 2e4
max_steps = {steps}
convergence = 1e-9
[output]
snapshots_every = 25
"""
PLAIN = {"hillslope": "talus_angle_deg = 30", "g": 0, "steps": 300}
CREEP = {"hillslope": "diffusivity_m2_per_yr = 0.01\ncritical_slope = 1", "g": 0.5, "steps": 60}
UPLIFT = "time_yr,factor\n0,1\n2e6,1\n3e6,2\n"
LEVEL = "time_yr,elevation_m\n0,0\n1e6,0\n1e6,-40\n5e6,20\n"


def command(*arguments):
    return [THALWEG, "simulate", *map(str, arguments), "--no-figures", "--quiet"]


def fingerprints(folder):
    """SHA-256 of every file by its relative path; seconds, and how often the run saved itself, left out."""
    found = {}
    for path in sorted(p for p in folder.rglob("*") if p.is_file()):
        name, content = str(path.relative_to(folder)), path.read_bytes()
        if name == "summary.json":
            summary = json.loads(content)
            del summary["seconds"], summary["seconds_per_node_step"]
            content = json.dumps(summary).encode()
        elif name == "history.csv":
            content = b"\n".join(line.rsplit(b",", 1)[0] for line in content.splitlines())
        elif name == "experiment.toml":
            content = b"\n".join(line for line in content.splitlines() if not line.startswith(b"checkpoint_every"))
        found[name] = hashlib.sha256(content).hexdigest()
    return found


class Resume(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.here = Path(self.folder.name)
        (self.here / "uplift.csv").write_text(UPLIFT)
        (self.here / "level.csv").write_text(LEVEL)
        self.experiment = self.here / "experiment.toml"
        self.experiment.write_text(EXPERIMENT.format(mesh="raster", **PLAIN))

    def done(self, *arguments):
        result = subprocess.run(command(self.experiment, *arguments), capture_output=True, text=True, timeout=600)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def refused(self, *arguments, saying):
        before = sorted(self.here.rglob("*"))
        result = subprocess.run(command(self.experiment, *arguments), capture_output=True, text=True, timeout=600)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertIn(saying, result.stderr)
        self.assertEqual(sorted(self.here.rglob("*")), before)

    def stop(self, sign, seconds, *arguments):
        """Starts the command and sends it a signal after a while; returns whether that came before its end."""
        process = subprocess.Popen(command(self.experiment, *arguments), stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, text=True)
        try:
            _, error = process.communicate(timeout=seconds)
            self.assertEqual(process.returncode, 0, error)
            return False
        except subprocess.TimeoutExpired:
            process.send_signal(sign)
            _, error = process.communicate(timeout=60)
        if process.returncode == 0:
            return False
        if process.returncode == 128 + sign:
            self.assertIn("nothing was written", error)
        else:
            self.assertEqual(process.returncode, -sign)  # killed, or stopped before it took signals into its hands
        return True

    def saved(self, arguments, steps):
        """Runs until a checkpoint is there and kills it then."""
        process = subprocess.Popen(command(self.experiment, *arguments), stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        state = self.here / ".out.checkpoint" / "state"
        while process.poll() is None and not state.exists():
            time.sleep(0.002)
        process.kill()
        process.wait()
        self.assertTrue(state.exists())
        return state

    def killed_again_and_again(self, mesh, seed, processes):
        self.experiment.write_text(EXPERIMENT.format(mesh=mesh, **processes))
        start = time.monotonic()
        self.done("--out", self.here / "whole")
        whole = time.monotonic() - start
        chance = random.Random(seed)
        # Where the whole run was slowed by others, the next may be done before the first signal: sooner, then.
        while self.stops_until_done(whole, chance) == 0:
            shutil.rmtree(self.here / "out")
            shutil.rmtree(self.here / ".out.checkpoint", ignore_errors=True)
            whole /= 2
        self.assertEqual(fingerprints(self.here / "out"), fingerprints(self.here / "whole"))
        self.assertEqual([p.name for p in self.here.glob(".*.partial-*")], [])

    def stops_until_done(self, whole, chance):
        """Stops the run and goes on with it until it ends; returns how often. `whole`: seconds of one undisturbed."""
        for stops in range(40):
            sign = chance.choice([signal.SIGKILL, signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
            # Longer and longer, so that it ends however slow the machine is.
            if not self.stop(sign, whole * chance.uniform(0.05, 0.5) * 1.2**stops, "--out", self.here / "out",
                             "--set", "output.checkpoint_every=7", "--resume"):
                return stops
            if (self.here / "out").exists():  # killed after its results, whole then, got their name
                self.assertEqual(sign, signal.SIGKILL)
                return stops + 1
        self.fail("the run never came to its end")

    def test_a_raster_run_killed_again_and_again_ends_with_the_same_bytes(self):
        self.killed_again_and_again("raster", 1, PLAIN)

    def test_a_tin_run_killed_again_and_again_ends_with_the_same_bytes(self):
        self.killed_again_and_again("tin", 2, PLAIN)

    def test_a_run_with_creep_and_sediment_killed_again_and_again_ends_with_the_same_bytes(self):
        self.killed_again_and_again("tin", 3, CREEP)

    def test_an_interrupted_run_says_how_it_can_go_on(self):
        out = ("--out", self.here / "out", "--set", "output.checkpoint_every=5", "--set", "time.max_steps=100000")
        process = subprocess.Popen(command(self.experiment, *out), stderr=subprocess.PIPE, text=True)
        while process.poll() is None and not (self.here / ".out.checkpoint" / "state").exists():
            time.sleep(0.002)
        process.send_signal(signal.SIGTERM)
        _, error = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 128 + signal.SIGTERM)
        self.assertRegex(error, r"^thalweg: error: .*; --resume goes on from the last checkpoint\n$")
        self.assertEqual(sorted(p.name for p in self.here.iterdir() if p.name.startswith(".")), [".out.checkpoint"])

    def test_a_run_without_checkpoints_leaves_nothing_when_interrupted(self):
        before = sorted(self.here.rglob("*"))
        process = subprocess.Popen(command(self.experiment, "--out", self.here / "out", "--set",
                                           "time.max_steps=1000000"), stderr=subprocess.DEVNULL)
        while process.poll() is None and not list(self.here.glob(".out.partial-*/.frames/*")):
            time.sleep(0.002)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=60), 128 + signal.SIGINT)
        self.assertEqual(sorted(self.here.rglob("*")), before)

    def test_what_cannot_be_resumed_is_refused_in_one_sentence_and_kept(self):
        out = ("--out", self.here / "out", "--set", "output.checkpoint_every=20", "--set", "time.max_steps=100000")
        state = self.saved(out, 20)
        for partial in self.here.glob(".out.partial-*"):
            subprocess.run(["rm", "-r", partial], check=True)
        self.refused(*out, "--resume", "--set", "river.k=3e-5", saying="k = 2e-05 is now k = 3e-05")
        self.refused(*out, "--resume", "--seed", 6, saying="seed = 5 is now seed = 6")
        self.refused(*out, saying="--resume")
        (self.here / "level.csv").write_text(LEVEL + "9e6,0\n")
        self.refused(*out, "--resume", saying="base_level.history")
        (self.here / "level.csv").write_text(LEVEL)
        whole = state.read_bytes()
        state.write_bytes(whole[:-1])
        self.refused(*out, "--resume", saying="damaged")
        state.write_bytes(whole[:1000] + bytes([whole[1000] ^ 1]) + whole[1001:])
        self.refused(*out, "--resume", saying="damaged")
        body = whole[:-32].replace(b"thalweg checkpoint 1\n", b"thalweg checkpoint 0\n")
        state.write_bytes(body + hashlib.sha256(body).digest())
        self.refused(*out, "--resume", saying="version")
        state.write_bytes(whole)
        self.done(*out, "--resume", "--set", "time.max_steps=3000")

    def test_a_full_disk_while_snapshots_are_written_leaves_nothing(self):
        before = sorted(self.here.rglob("*"))

        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (60000, 60000))

        result = subprocess.run(command(self.experiment, "--out", self.here / "out", "--set", "output.snapshots_every=1"),
                                capture_output=True, text=True, timeout=600, preexec_fn=limit)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertEqual(sorted(self.here.rglob("*")), before)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
