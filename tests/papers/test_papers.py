#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper cases' harness: fits, tables, verdicts; and whether the pages are what the recorded results say."""
import contextlib
import io
import os
import stat
import sys
import tempfile
import types
import unittest

import numpy as np

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "papers"))
import fits  # noqa: E402
import harness  # noqa: E402
import papers  # noqa: E402

#: Stands for the thalweg program: as many metres as the override asks for.
PROGRAM = """#!/usr/bin/python3
import json, os, sys
if "--refuse" in sys.argv[2]:
    sys.exit("thalweg: error: no such luck")
height = float(next(each for each in sys.argv if each.startswith("height=")).split("=")[1])
os.makedirs(sys.argv[sys.argv.index("--out") + 1], exist_ok=True)
with open(os.path.join(sys.argv[sys.argv.index("--out") + 1], "summary.json"), "w") as stream:
    json.dump({"nodes": 4, "steps": 2, "converged": True, "frozen_receivers": 0, "lakes_final": 0, "elevation_max_m": height,
               "elevation_mean_m": height / 3, "mass_balance": {"uplifted_m3": 8, "talus_m3": 2},
               "seconds": {"mesh": 0.5, "simulate": 1, "total": 2}}, stream)
"""

CASES = """
from harness import Case, Run, verdict
import style

def judge(rows, published):
    highest = max(row["elevation_max_m"] for row in rows)
    return [verdict("high", str(published[0]["published"]), str(highest), "equal", highest == published[0]["published"])]

def draw(rows, published, folders):
    drawing = style.figure(1, 1)
    drawing.add_subplot().plot([row["value"] for row in rows], [row["elevation_max_m"] for row in rows])
    return drawing

TITLE, LEAD = "A paper", "Its lead."
CASES = [Case("heights", "Heights", lambda quick: [Run({"value": h}, (f"height={h * FACTOR}",), keep=h == 2) for h in (1, 2, 3)],
              judge, draw, columns=("value", "elevation_max_m"))]
"""


class Fits(unittest.TestCase):
    def test_both_fits_find_an_exact_power_law(self):
        x = np.array([2.5e-5, 1e-4, 4e-4, 2e-3])
        for fit in (fits.power_by_logarithms, fits.power_by_values):
            a, b = fit(x, 3e5 * x**0.57)
            self.assertAlmostEqual(b, 0.57, places=5)
            self.assertAlmostEqual(a / 3e5, 1, places=4)

    def test_a_fit_to_values_is_the_least_sum_of_squares(self):
        x, y = np.array([1.0, 2, 5, 10]), np.array([1.0, 3, 4, 9])
        a, b = fits.power_by_values(x, y)
        least = np.sum((y - a * x**b)**2)
        for da, db in ((1e-3, 0), (-1e-3, 0), (0, 1e-3), (0, -1e-3), (1e-3, -1e-3)):
            self.assertLess(least, np.sum((y - (a + da) * x**(b + db))**2))

    def test_a_line_knows_how_well_it_fits(self):
        self.assertEqual([round(value, 12) for value in fits.line([0, 1, 2], [1, 3, 5])], [2, 1, 1])
        self.assertAlmostEqual(fits.line([-1, 0, 1], [1, 0, 1])[2], 0)

    def test_a_distance_of_ten_percent_is_told_as_such(self):
        self.assertAlmostEqual(fits.log_distance([1.1, 10 / 1.1], [1, 10]), np.log(1.1))


class Words(unittest.TestCase):
    def test_numbers_are_written_with_three_digits_and_thousands_apart(self):
        for value, text in ((0.568, "0.568"), (0.5, "0.5"), (9.996, "10"), (29.6928, "29.7"), (99927.0, "99 927"), (0, "0"),
                            (5.6e-7, "5.6e-7"), (2.465e9, "2.46e9"), (-11.54, "-11.5"), (None, "–"), ("a", "a"), (999.7, "1 000")):
            self.assertEqual(harness.number(value), text)

    def test_a_verdict_is_reproduced_explained_or_open(self):
        words = [harness.verdict("", "", "", "", *met).word for met in ((True,), (True, True), (False, True), (False,))]
        self.assertEqual(words, ["reproduced", "reproduced", "differs, explained", "differs, open"])


class Recorded(unittest.TestCase):
    """What stands in papers/."""

    @classmethod
    def setUpClass(cls):
        cls.papers = [papers.load(name) for name in papers.PAPERS]

    def test_the_pages_are_what_the_results_say(self):
        self.assertEqual(papers.check(self.papers), [])

    def test_every_published_row_belongs_to_a_case_and_says_where_it_stands(self):
        for paper in self.papers:
            names = {case.name for case in paper.cases}
            for row in paper.published:
                self.assertIn(row["case"], names)
                self.assertTrue(row["where"], row)

    def test_every_case_has_its_figure(self):
        for paper in self.papers:
            for case in paper.cases:
                self.assertTrue(os.path.exists(os.path.join(paper.folder, "figures", case.name + ".png")), case.name)


class Running(unittest.TestCase):
    """A made-up paper and a made-up program."""

    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.root = self.temporary.name
        self.program = self.write("thalweg", PROGRAM)
        os.chmod(self.program, stat.S_IRWXU)
        self.write("made_up/published.csv", "case,published,where\nheights,3,table 1\n")
        self.out = os.path.join(self.root, "out")

    def write(self, name, text):
        path = os.path.join(self.root, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as stream:
            stream.write(text)
        return path

    def paper(self, factor):
        self.write("made_up/cases.py", f"FACTOR = {factor}\n" + CASES)
        return papers.load("made_up", self.root)

    def run_paper(self, factor, record=False):
        options = types.SimpleNamespace(thalweg=self.program, out=self.out, names=[], quick=not record, record=record)
        paper = self.paper(factor)
        with contextlib.redirect_stdout(io.StringIO()):
            case = paper.cases[0]
            tools = harness.Tools(self.program, os.path.join(self.out, "work"), self.root)
            return paper, papers.changed_verdicts(paper, case, papers.run_and_judge(paper, case, tools, options))

    def test_runs_become_rows_and_only_kept_folders_stay(self):
        paper, _ = self.run_paper(1, record=True)
        rows = papers.recorded(paper)["heights"]
        self.assertEqual([row["elevation_max_m"] for row in rows], [1, 2, 3])
        self.assertEqual([row["talus_share"] for row in rows], [0.25] * 3)
        self.assertTrue(all(row["peak_mib"] > 1 for row in rows))
        self.assertEqual(os.listdir(os.path.join(self.out, "work", "made_up", "heights")), ["001"])
        self.assertGreater(os.path.getsize(os.path.join(paper.folder, "figures", "heights.png")), 300)

    def test_the_memory_of_a_run_is_the_programs_and_not_the_harness(self):
        held = np.ones(12_000_000)  # 92 MiB
        self.assertLess(harness._execute([self.program, "", "--out", self.out, "height=1"]), held.nbytes / 2**20)

    def test_a_verdict_other_than_the_recorded_one_is_told(self):
        self.assertEqual(self.run_paper(1, record=True)[1], [])
        self.assertEqual(self.run_paper(1)[1], [])
        complaints = self.run_paper(2)[1]
        self.assertEqual(len(complaints), 1)
        self.assertIn("differs, open (6.0), recorded: reproduced", complaints[0])

    def test_a_result_that_changed_makes_another_page(self):
        paper, _ = self.run_paper(1, record=True)
        results = papers.recorded(paper)
        before = harness.readme(paper, results)
        self.assertIn("| high | 3.0 | 3.0 | equal | *reproduced* |", before)
        self.assertIn("1 reproduced, 0 differs, explained, 0 differs, open.", harness.overview([paper], {"made_up": results}))
        results["heights"][2]["elevation_max_m"] = 4.0
        self.assertIn("| high | 3.0 | 4.0 | equal | *differs, open* |", harness.readme(paper, results))

    def test_a_program_that_refuses_is_one_sentence(self):
        paper = self.paper(1)
        paper.folder = os.path.join(self.root, "--refuse")
        with self.assertRaisesRegex(harness.Failure, "thalweg: error: no such luck"):
            harness.run_case(paper, paper.cases[0], harness.Tools(self.program, self.out, ""), True)

    def test_a_missing_program_is_one_sentence(self):
        paper = self.paper(1)
        with self.assertRaisesRegex(harness.Failure, "nowhere does not exist"):
            harness.run_case(paper, paper.cases[0], harness.Tools("nowhere", self.out, ""), True)
        with self.assertRaisesRegex(harness.Failure, "paper_x does not exist"):
            harness.printed_rows(harness.Tools("", "", self.root), "paper_x")

    def test_an_unknown_case_is_told_with_the_known_ones(self):
        with self.assertRaisesRegex(harness.Failure, "no paper or case 'b'; there are: made_up, made_up/heights"):
            papers.wanted([self.paper(1)], ["b"])


if __name__ == "__main__":
    unittest.main()
