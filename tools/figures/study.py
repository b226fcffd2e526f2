# SPDX-License-Identifier: GPL-3.0-or-later
"""A study's results as the report needs them: both terrains, the fit, the comparison, and what was noted on the way."""
import os

import sides
from data import get, notes_of, read_csv, read_json, read_toml, reason, require_json, terrain_of


class Study:
    """Everything that `run` wrote, read once."""

    def __init__(self, folder):
        self.folder = folder
        self.measure = require_json(self.step("measure"), "summary.json")
        self.simulate = require_json(self.step("simulate"), "summary.json")
        self.fit = read_json(self.step("fit"), "fit.json") or {}
        self.fit_table = read_csv(self.step("fit"), "fit.csv")
        self.comparison = read_json(self.step("compare"), "comparison.json") or {}
        self.manifest = read_json(folder, "manifest.json") or {}
        self.experiment = read_toml(folder, "experiment.toml") or read_toml(self.step("simulate"), "experiment.toml")
        self.history = read_csv(self.step("simulate"), "history.csv")
        self.real = sides.from_folder(self.step("measure"), "real", "real")
        self.synthetic = sides.from_folder(self.step("simulate"), "synthetic", "synthetic")
        self.theory = sides.theory(self.step("simulate"), self.synthetic)
        self.compared = [sides.from_comparison(self.comparison, key, self.step("compare"), label, label)
                         for key, label in (("a", "real"), ("b", "synthetic"))]
        self.compared = [side if side.terrain else whole
                         for side, whole in zip(self.compared, (self.real, self.synthetic))]

    def step(self, name):
        return os.path.join(self.folder, name)

    def name(self):
        """The DEM's file name without folders and extension."""
        file = get(self.measure, "input.file") or get(self.experiment, "study.dem") or "the terrain"
        return os.path.splitext(os.path.basename(str(file)))[0]

    def value(self, which, *paths):
        """The first of the paths that one side has (0 real, 1 synthetic), and where it is null the reason."""
        documents = [self.compared[which].terrain]
        if which == 1 and documents[0] is not terrain_of(self.simulate):
            documents.append({key: self.simulate.get(key) for key in SIMULATION_KEYS})
        elif which == 1:
            documents.append(self.simulate)
        for document in documents:
            for path in paths:
                found = get(document, path)
                if found is not None:
                    return found, ""
        whole = self.measure if which == 0 else self.simulate
        reasons = (reason(document, path) for document in (*documents, whole) for path in paths)
        return None, next(filter(None, reasons), "")

    def notes(self):
        """Every note and warning once, with the step it came from."""
        seen, found = set(), []
        sources = (("measure", self.measure), ("fit", self.fit), ("simulate", self.simulate),
                   ("simulate", self.simulate.get("terrain") or {}), ("compare", self.comparison), ("run", self.manifest))
        for step, content in sources:
            warnings = {"notes": content.get("warnings")} if isinstance(content, dict) else {}
            for key, sentence in (*notes_of(content).items(), *notes_of(warnings).items()):
                if sentence and (key, sentence) not in seen and sentence not in (text for _, _, text in found):
                    seen.add((key, sentence))
                    found.append((step, "" if key.startswith("#") else key, sentence))
        return found


#: What belongs to the run itself and not to how its terrain was measured.
SIMULATION_KEYS = ("domain_area_m2", "elevation_max_m", "elevation_mean_m")
