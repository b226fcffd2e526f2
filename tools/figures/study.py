# SPDX-License-Identifier: GPL-3.0-or-later
"""A study's results as the report needs them: both terrains, the fit, the comparison, and what was noted on the way."""
import os

import sides
from data import absences, get, notes_of, read_csv, read_json, read_toml, reason, require_json

#: What a reader misses first: a note that explains why one of these is absent is a warning.
HEADLINE = ("hypsometry.integral", "slope_area.theta", "channels.drainage_density_per_m", "horton.RB.regression", "theta",
            "k_at_reference_area")


class Study:
    """Everything that `run` wrote, read once. A study by network growth alone has no simulation: its grown terrain then is
    the synthetic one, and where there are both the grown one is the third. The two terrains set side by side are the measured basin and the simulated
    landscape measured like a DEM, where the study has them; else the whole DEM and the simulation itself."""

    def __init__(self, folder):
        self.folder = folder
        self.measure = require_json(self.step("measure"), "summary.json")
        self.grown_alone = (os.path.exists(self.step("grown/summary.json"))
                            and not os.path.exists(self.step("simulate/summary.json")))
        self.simulate = {} if self.grown_alone else require_json(self.step("simulate"), "summary.json")
        self.grow = read_json(self.step("grow"), "summary.json") or {}
        self.growth_fit = read_json(self.step("growth_fit"), "fit.json") or {}
        self.grown_comparison = read_json(self.step("compare_grown"), "comparison.json") or {}
        self.fit = read_json(self.step("fit"), "fit.json") or {}
        self.fit_table = read_csv(self.step("fit"), "fit.csv")
        self.comparison = (self.grown_comparison if self.grown_alone
                           else read_json(self.step("compare"), "comparison.json") or {})
        self.manifest = read_json(folder, "manifest.json") or {}
        self.experiment = read_toml(folder, "experiment.toml") or read_toml(self.step("simulate"), "experiment.toml")
        self.history = read_csv(self.step("simulate"), "history.csv")
        self.real_step = self._first_step("basin", "measure")
        self.synthetic_step = "grown" if self.grown_alone else self._first_step("synthetic", "simulate")
        self.real = sides.from_folder(self.step(self.real_step), "real", "real")
        self.synthetic = sides.from_folder(self.step(self.synthetic_step), "synthetic", "synthetic")
        self.theory, self.no_theory = (None, "") if self.grown_alone else sides.theory(self.step("simulate"), self.synthetic)
        self.grown = None
        steps = [self.real_step, self.synthetic_step]
        if not self.grown_alone and os.path.exists(self.step("grown/summary.json")):
            self.grown = sides.from_folder(self.step("grown"), "grown", "grown")
            steps.append("grown")
        self.summaries = [read_json(self.step(step), "summary.json") for step in steps]

    def _first_step(self, *names):
        return next(name for name in names if name == names[-1] or os.path.exists(self.step(f"{name}/summary.json")))

    def step(self, name):
        return os.path.join(self.folder, name)

    def sides(self):
        return [self.real, self.synthetic]

    def all_sides(self):
        """Real, synthetic and, where a network was grown beside a simulation, grown."""
        return self.sides() + ([self.grown] if self.grown else [])

    def synthetic_raster(self):
        return self.step("grow/elevation.tif" if self.grown_alone else "simulate/elevation.tif")

    def name(self):
        """The DEM's file name without folders and extension."""
        file = get(self.measure, "input.file") or get(self.experiment, "study.dem") or "the terrain"
        return os.path.splitext(os.path.basename(str(file)))[0]

    def value(self, which, *paths):
        """The first of the paths that one side has (0 real, 1 synthetic, 2 grown), and where it is null the reason."""
        documents = [self.all_sides()[which].terrain, self.summaries[which]]
        for document in documents:
            for path in paths:
                found = get(document, path)
                if found is not None:
                    return found, ""
        reasons = (reason(document, path) for document in documents for path in paths)
        return None, next(filter(None, reasons), "")

    def relief(self, which):
        """Lowest and highest elevation of one side and their difference (m); None where one is not known."""
        low, high = (self.value(which, f"input.elevation_{end}_m")[0] for end in ("min", "max"))
        return None if low is None or high is None else (low, high, high - low)

    def notes(self):
        """Every note and warning once: (step, key, sentence, whether it only explains an empty value of lesser weight)."""
        found = []
        steps = {"measure": self.measure, self.real_step: self.summaries[0], "fit": self.fit, "simulate": self.simulate,
                 self.synthetic_step: self.summaries[1], "compare": self.comparison, "growth_fit": self.growth_fit,
                 "grow": self.grow, "grown": self.summaries[-1], "compare_grown": self.grown_comparison,
                 "run": self.manifest}
        for step, content in steps.items():
            content = content or {}
            warnings = notes_of({"notes": content.get("warnings")})
            for key, sentence in (*notes_of(content), *notes_of(content.get("terrain")), *warnings):
                if key not in steps and (key, sentence) not in (each[1:3] for each in found):
                    found.append((step, key, sentence, _only_explains(content, key)))
        return found


def _only_explains(content, key):
    """True for a note on values that are null, none of them a headline."""
    if not key:
        return False
    missing = [name for part in key.split(" and ") for name in absences(content, part)]
    return bool(missing) and not any((headline + ".").startswith(name.removeprefix("terrain.") + ".")
                                     for name in missing for headline in HEADLINE)
