#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws what the validation cases measured: figures.py FOLDER_OF_CSV FOLDER_OF_PNG

Each case writes NAME.csv when THALWEG_VALIDATION_OUT names a folder; the table below says how it is drawn. A CSV that
is not in the table is an error, so that no case goes unseen.
"""
import csv
import re
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ORDER = "order"  # errors over spacing, logarithmic, with the expected power beside them
SPREAD = "spread"  # one column of dots per estimator
TOLERANCE = "tolerance"  # one row of dots per category, logarithmic, with the largest that is allowed

# pattern of the name: (kind, title, expected power or truth)
FIGURES = {
    r"steady_profile": (ORDER, "Steady profile, Hack areas: error over relief", 1),
    r"knickpoint_width": (ORDER, "Base-level fall, n = 1: width of the wave", 0.5),
    r"knickpoint_speed": (ORDER, "Base-level fall, n = 1: speed off by", 1),
    r"speeds_n_2": (TOLERANCE, "n = 2: speeds off by", 0.01),
    r"kilometres": (TOLERANCE, "Whole runs in m and yr against km and kyr: worst node over relief", 1e-9),
    r"response_time": (ORDER, "Answer to uplift from the plain: mean error over relief", 1),
    r"two_solvers_(TIN|raster)_([\d.]+)": (SPREAD, "Steady solver and time stepping, {0}, n = {1}", None),
    r"estimators_([\d.]+)_([\d.]+)_(\d+)_(\d+)": (
        SPREAD, "Blind: θ = {0}, slopes scatter by {1}, steps {2} m, noise {3} m", None),
    r"flint": (SPREAD, "Flint's q of 40 random trees, over the truth", None),
    r"waves_([\d.]+)_(\d+)": (SPREAD, "A wave's knickpoints over the truth: slopes scatter by {0}, steps {1} m", None),
    r"steady_slopes": (TOLERANCE, "Steady slopes by time stepping: worst node against the law", 1e-8),
    r"steady_slopes_uneven": (TOLERANCE, "The same under uneven uplift, rain and rock", 1e-8),
    r"deposition_slopes": (TOLERANCE, "Steady slopes with deposition, n = 0.7, 1, 1.5: worst node against the law", 1e-6),
    r"creep_linear": (ORDER, "Linear creep, steady: error", -2),
    r"creep_critical": (ORDER, "Creep with a critical slope, steady: error", -2),
    r"gaussian_in_space": (ORDER, "A Gaussian that spreads: error over space", -2),
    r"gaussian_in_time": (ORDER, "A Gaussian that spreads: error over time", -1),
    r"recovery_of_m": (TOLERANCE, "Blind fits: m off by", 0.02),
    r"one_step_turned": (TOLERANCE, "One step turned and mirrored, by outlets and process: worst node", 1e-12),
    r"turned_runs": (TOLERANCE, "Whole runs turned and mirrored: difference over the seeds' scatter", 1),
    r"histories": (ORDER, "Base-level and uplift histories, n = 1: mean error over relief", 1),
    r"time_step_(raster|TIN)": (SPREAD, "At rest with steps of 20 and 100 kyr, {0}, eight seeds", None),
    r"node_counts": (TOLERANCE, "Nodes over those asked for, minus 1 (150 to 300 000)", 0.02),
    r"cell_areas": (TOLERANCE, "Sum of cells over the domain's area, minus 1", 1e-12),
    r"memory_order": (ORDER, "Numbers between neighbours, nine in ten: along a Hilbert curve", 0),
    r"solids": (TOLERANCE, "Closed solids: volume in another program over ours, minus 1", 1e-8),
    r"recovery_with_deposition": (TOLERANCE, "Blind fits with G = 0.5, 1, 2: k·A0^m off by", 0.1),
    r"ellipsoid_(domes|valleys|catchments)": (TOLERANCE, "Degrees and an equal-area plane, {0}: off by, over its bound", 1),
    r"knickpoint_places": (SPREAD, "Knickpoints' χ over that of the wave", 1),
}


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: [float(row[name]) for row in rows if row[name]] for name in rows[0]}


def draw_order(axes, columns, power):
    names = list(columns)
    x = columns[names[0]]
    for marker, name in zip("os^", names[1:]):
        axes.loglog(x, columns[name], marker=marker, color="black", fillstyle="none", linewidth=0.8, label=name)
    first = columns[names[1]]
    axes.loglog(x, [first[0] * (value / x[0]) ** power for value in x], "--", color="grey", label=f"power {power:g}")
    axes.set_xlabel(names[0])
    axes.legend(frameon=False, fontsize=8)


def draw_spread(axes, columns, truth):
    for place, values in enumerate(columns.values()):
        middle = sum(values) / len(values)
        axes.plot([value / middle for value in values], [place] * len(values), "o", color="black", fillstyle="none")
        axes.text(1.0, place + 0.18, f"mean {middle:.4g}", ha="center", fontsize=8)
    if truth is not None:
        axes.axvline(truth / (sum(next(iter(columns.values()))) / len(next(iter(columns.values())))), color="grey")
    axes.set_yticks(range(len(columns)), list(columns), fontsize=8)
    axes.set_ylim(-0.6, len(columns) - 0.2)
    axes.set_xlabel("value over its mean")


def draw_tolerance(axes, columns, most):
    least = min([value for values in columns.values() for value in values if value > 0] + [most]) / 10
    for place, values in enumerate(columns.values()):
        axes.semilogx([max(value, least) for value in values], [-place] * len(values), "o", color="black", fillstyle="none")
    axes.axvline(most, color="grey", linestyle="--", label=f"allowed: {most:g}")
    axes.set_yticks([-place for place in range(len(columns))], list(columns), fontsize=8)
    axes.set_xlabel("0 stands at the left end")
    axes.legend(frameon=False, fontsize=8)


DRAWING = {ORDER: draw_order, SPREAD: draw_spread, TOLERANCE: draw_tolerance}


def draw(path, out):
    for pattern, (kind, title, extra) in FIGURES.items():
        match = re.fullmatch(pattern, path.stem)
        if not match:
            continue
        columns = read(path)
        height = max(3.2, 0.6 + 0.19 * len(columns)) if kind == TOLERANCE else 3.2
        figure, axes = plt.subplots(figsize=(5.2, height), layout="constrained")
        DRAWING[kind](axes, columns, extra)
        figure.suptitle(title.format(*match.groups()), fontsize=9)
        figure.savefig(out / (path.stem + ".png"), dpi=110, metadata={"Software": None})
        plt.close(figure)
        return
    raise SystemExit(f"figures.py: no figure is described for {path.name}")


def main():
    source, out = Path(sys.argv[1]), Path(sys.argv[2])
    out.mkdir(parents=True, exist_ok=True)
    for path in sorted(source.glob("*.csv")):
        draw(path, out)


if __name__ == "__main__":
    main()
