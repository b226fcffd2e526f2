# SPDX-License-Identifier: GPL-3.0-or-later
"""Bell's pictures and settings: landscapes through time, one beside a real DEM, talus angles, uplift, outlets, rain."""
import itertools
import json
import os
import subprocess

import numpy as np

import maps
import style
from bell_heights import K_VALUES, M_VALUES, U_VALUES, few
from fits import log_distance
from harness import Case, Run, column, number, select, verdict

STEADY = ("time.solver=steady", "time.max_steps=3000", "river.receiver=steepest")
DEM = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "validation", "data", "jacksboro.tif")


def resolution(quick):
    return ("domain.nodes=5000", "output.resolution=64") if quick else ("output.resolution=256",)


def draw_maps(paths, titles, columns, same_heights, width=7.2):
    """Shaded maps in rows (width in inches); with the same heights they share one key of colours."""
    terrains = [maps.read_terrain(path) for path in paths]
    rows = -(-len(terrains) // columns)
    drawing = style.figure(rows * width / columns * 0.98 + 0.4, width)
    every = drawing.subplots(rows, columns, squeeze=False)
    for axes, terrain, title in itertools.zip_longest(every.flat, terrains, titles):
        if terrain is None:
            axes.set_axis_off()
            continue
        limits = maps.height_range(*terrains) if same_heights else maps.height_range(terrain)
        maps.draw_terrain(axes, terrain, limits)
        axes.set(xlabel="", ylabel="")
        axes.set_title(title)
    if same_heights:
        maps.draw_colours(drawing, list(every.flat), maps.height_range(*terrains), terrains)
    return drawing


def maps_of(titles, columns, same_heights):
    def draw(rows, _, folders):
        return draw_maps([os.path.join(folder, "elevation.tif") for folder in folders], titles(rows), columns, same_heights)
    return draw


# ---- Fig 5.3: snapshots

SNAPSHOTS = [1, 5, 20, 60, 150, 400]


def snapshots_runs(quick):
    return [Run({"step": step}, (*resolution(quick), f"time.max_steps={step}", "time.convergence=0"), keep=True)
            for step in SNAPSHOTS]


def snapshots_judge(rows, _):
    first, last = rows[0], rows[-1]
    lakes = [row["lakes_final"] for row in rows]
    return [verdict("rivers grow inward from the rim, lakes vanish, relief tends to a limit", "figure",
                    f"lakes {', '.join(number(each) for each in lakes)}; highest {number(first['elevation_max_m'])} m, "
                    f"{number(rows[-2]['elevation_max_m'])} m, {number(last['elevation_max_m'])} m at steps 1, 150, 400",
                    "lakes never more than before and none at the end; highest point within 10 % from step 150 on",
                    all(a >= b for a, b in zip(lakes, lakes[1:])) and lakes[-1] == 0
                    and abs(rows[-2]["elevation_max_m"] / last["elevation_max_m"] - 1) < 0.1, full_only=True)]


# ---- Fig 5.6: beside a real landscape

def analyzed(program, path, folder):
    subprocess.run([program, "analyze", path, "--out", folder, "--force", "--quiet", "--no-figures"], check=True,
                   stderr=subprocess.DEVNULL)  # it warns that a simulated raster has no coordinate system
    with open(os.path.join(folder, "summary.json"), encoding="utf-8") as stream:
        summary = json.load(stream)
    elevation, network = summary["input"], summary["horton"]
    return {"relief_m": elevation["elevation_max_m"] - elevation["elevation_min_m"],
            "hypsometric_integral": summary["hypsometry"]["integral"], "concavity": summary["slope_area"]["theta"],
            "bifurcation_ratio": network["RB"]["regression"], "length_ratio": network["RL"]["regression"],
            "area_ratio": network["RA"]["regression"], "drainage_density_per_km": summary["channels"]["drainage_density_per_m"] * 1e3}


def beside_rows(tools, quick):
    """Both measured like any DEM, with the same channel threshold rule and cells of about 90 m."""
    here = os.path.dirname(os.path.realpath(__file__))
    work = os.path.join(tools.work, "bell_2024", "beside_dem")
    os.makedirs(work, exist_ok=True)
    simulated = os.path.join(work, "simulated")
    subprocess.run([tools.thalweg, "simulate", os.path.join(here, "experiment.toml"), "--out", simulated, "--force", "--quiet",
                    "--no-figures", "--set", "output.resolution=364", "--set", f"domain.nodes={10000 if quick else 30000}",
                    "--set", "uplift.rate_m_per_yr=6e-5"], check=True)
    rows = [{"terrain": name, **analyzed(tools.thalweg, path, os.path.join(work, f"analyzed {name}"))}
            for name, path in (("Cumberland Mountains", DEM), ("simulated", os.path.join(simulated, "elevation.tif")))]
    return rows, [simulated]


def beside_judge(rows, _):
    real, made = rows
    ratios = [(made[name], real[name]) for name in ("bifurcation_ratio", "length_ratio", "area_ratio")]
    far = max(abs(np.log(a / b)) for a, b in ratios)
    return [verdict("looks like the Blue Ridge or the Cumberland Mountains: Horton's ratios RB, RL, RA", "by eye",
                    " ".join(number(a) for a, _ in ratios) + " against " + " ".join(number(b) for _, b in ratios),
                    "each within 30 %", far < np.log(1.3), full_only=True),
            verdict("the same for the concavity θ", "by eye", f"{number(made['concavity'])} against {number(real['concavity'])}",
                    "within 0.1", abs(made["concavity"] - real["concavity"]) < 0.1, full_only=True)]


def beside_draw(rows, _, folders):
    made = os.path.join(folders[0], "elevation.tif")
    drawing = style.figure(3.9, 7.2)
    for axes, path, title in zip(drawing.subplots(1, 2), (DEM, made), ("Cumberland Mountains (SRTM)", "simulated")):
        terrain = maps.read_terrain(path)
        maps.draw_terrain(axes, terrain, maps.height_range(terrain))
        maps.draw_scale_bar(axes, terrain)
        axes.set_title(title)
    return drawing


# ---- the talus angle that his heights speak for

ANGLES = [25, 30, 35, 40, 45]
TABLES = {"area_exponent": ("river.m={}", M_VALUES[::2]), "uplift": ("uplift.rate_m_per_yr={}", U_VALUES[1::3]),
          "erodibility": ("river.k={}", K_VALUES[::2])}


def talus_runs(quick):
    return [Run({"pattern": pattern, "angle_deg": angle, "table": table, "value": value},
                (*(("domain.nodes=5000",) if quick else ("domain.nodes=15000",)), *STEADY, f"uplift.pattern={pattern}",
                 f"hillslope.talus_angle_deg={angle}", override.format(value)))
            for pattern in ("constant", "radial") for angle in (ANGLES[1::2] if quick else ANGLES)
            for table, (override, values) in TABLES.items() for value in few(values, quick, 2)]


def talus_distances(rows, published):
    """{(pattern, angle): distance} from all of his heights that were run."""
    his = {(row["case"], row["value"]): row["published"] for row in published}
    found = {}
    for pattern, angle in sorted({(row["pattern"], row["angle_deg"]) for row in rows}):
        mine = select(rows, pattern=pattern, angle_deg=angle)
        found[pattern, angle] = log_distance(column(mine, "elevation_max_m"), [his[row["table"], row["value"]] for row in mine])
    return found


def talus_judge(rows, published):
    distance = talus_distances(rows, published)
    best = {pattern: min((value, angle) for (each, angle), value in distance.items() if each == pattern)
            for pattern in ("constant", "radial")}
    return [verdict("talus angle", "30 to 45°", f"{number(best['constant'][1])}° with even, {number(best['radial'][1])}° with "
                    f"radial uplift fit his heights best ({100 * best['constant'][0]:.0f} and {100 * best['radial'][0]:.0f} % "
                    "apart)", "both between 30 and 45°, and under 20 % apart",
                    all(30 <= angle <= 45 and value < 0.2 for value, angle in best.values()), full_only=True)]


def talus_draw(rows, published, _):
    drawing = style.figure(3, 5)
    axes = drawing.add_subplot()
    distance = talus_distances(rows, published)
    for pattern, look in (("constant", style.LOOK["real"]), ("radial", style.LOOK["synthetic"])):
        angles = sorted(angle for each, angle in distance if each == pattern)
        axes.plot(angles, [100 * distance[pattern, angle] for angle in angles], **look,
                  label=f"{'even' if pattern == 'constant' else pattern} uplift")
    axes.set_ylim(0, None)
    axes.set_xlabel("talus angle (°)")
    axes.set_ylabel("distance from Bell's heights (%)")
    axes.legend()
    return drawing


CASES = [
    Case("talus", "Talus angles: which one his heights speak for", talus_runs, talus_judge, talus_draw,
         also_published=tuple(TABLES)),
    Case("snapshots", "Fig 5.3 A landscape through time", snapshots_runs, snapshots_judge,
         maps_of(lambda rows: [f"{number(row['step'] / 4)} Myr: {number(row['elevation_max_m'])} m" for row in rows], 3, False),
         columns=("step", "lakes_final", "elevation_max_m", "elevation_mean_m"), palette=True),
    Case("beside_dem", "Fig 5.6 Beside a real landscape", None, beside_judge, beside_draw, compute=beside_rows, palette=True,
         columns=("terrain", "relief_m", "hypsometric_integral", "concavity", "bifurcation_ratio", "length_ratio", "area_ratio",
                  "drainage_density_per_km")),
]
