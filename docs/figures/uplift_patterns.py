#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws docs/figures/uplift_patterns.png: uplift_patterns.py THALWEG [IMAGE]

Each pattern's uplift is the height after one year of uplift and no erosion; its landscape is the steady state.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from osgeo import gdal
from PIL import Image

gdal.UseExceptions()
HERE = Path(__file__).resolve().parent
ONE_YEAR = ["time.solver=implicit", "time.step_yr=1", "time.max_steps=1", "river.k=1e-30", "initial.amplitude_m=0",
            "hillslope.talus_angle_deg=90", "time.convergence=0"]
RIVERS = ('{"type": "LineString", "coordinates": [[0, 14000], [9000, 19000], [16000, 15000], [23000, 20000], '
          '[32768, 17000]]}')
RIDGES = '{"type": "LineString", "coordinates": [[8000, 0], [11000, 12000], [22000, 21000], [24000, 32768]]}'


def cases(folder):
    """Title and settings of each column."""
    (folder / "rivers.geojson").write_text(RIVERS)
    (folder / "ridges.geojson").write_text(RIDGES)
    noise = [(f"noise, {kind}", ["uplift.pattern=noise", f"uplift.noise={kind}"])
             for kind in ("fbm", "billow", "ridge", "warped")]
    lines = [(f"painted {name}", [f"uplift.lines={folder}/{name}.geojson", "uplift.lines_width_m=9000",
                                  f"uplift.lines_value={value}"])
             for name, value in (("rivers", 0), ("ridges", 5))]
    return [("constant", []), ("gradient, 45°", ["uplift.pattern=gradient", "uplift.direction_deg=45"]),
            ("stepped, 90°", ["uplift.pattern=stepped", "uplift.direction_deg=90"]),
            ("diamond", ["uplift.pattern=diamond"]), ("radial", ["uplift.pattern=radial"]), *noise, *lines,
            ("gradient × ridges", ["uplift.pattern=gradient", *lines[1][1]])]


def surface(thalweg, settings, folder):
    overrides = [word for setting in settings for word in ("--set", setting)]
    subprocess.run([thalweg, "simulate", HERE / "uplift_patterns.toml", *overrides, "--out", folder, "--quiet", "--force",
                    "--no-figures"], check=True)
    return gdal.Open(str(folder / "elevation.tif")).ReadAsArray()


def shaded(height, cell):
    south, east = np.gradient(np.nan_to_num(height), cell)
    normal = np.dstack([-east, south, np.ones_like(height)])
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    return np.clip(normal @ np.array([-0.5, 0.5, 0.7071]), 0, 1)


def main():
    thalweg, image = sys.argv[1], Path(sys.argv[2]) if len(sys.argv) > 2 else HERE / "uplift_patterns.png"
    plt.rcParams.update({"font.size": 7})
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        columns = cases(folder)
        figure, axes = plt.subplots(4, 6, figsize=(9, 6.6), layout="constrained")
        for number, (title, settings) in enumerate(columns):
            row, column = 2 * (number // 6), number % 6
            uplift = surface(thalweg, settings + ONE_YEAR, folder / "uplift")
            height = surface(thalweg, settings, folder / "land")
            axes[row, column].imshow(uplift / 4e-4, cmap="magma", vmin=0, vmax=1)
            axes[row, column].set_title(title)
            land = axes[row + 1, column]
            land.imshow(height, cmap="terrain", vmin=-800, vmax=3600)
            land.imshow(shaded(height, 32768 / height.shape[1]), cmap="gray", alpha=0.45, vmin=0, vmax=1)
            land.set_xlabel(f"highest {np.nanmax(height):.0f} m", labelpad=2)
        for axis in axes.flat:
            axis.set_xticks([])
            axis.set_yticks([])
        figure.savefig(folder / "full.png", dpi=110)
        with Image.open(folder / "full.png") as full:  # a palette makes it a quarter of the size
            full.convert("RGB").quantize(256).save(image, optimize=True)


if __name__ == "__main__":
    main()
