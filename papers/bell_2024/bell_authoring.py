# SPDX-License-Identifier: GPL-3.0-or-later
"""What Bell lets an author choose: patterns of uplift, islands, outlets, rainfall; and what the talus angle decides.

His pictures hold no numbers that are known to us. The criteria are what such a picture must show; they were written down
before the runs were made, and have stood since.
"""
import json
import os
import subprocess
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import style
from bell_heights import FREE, K_VALUES, M_VALUES, STEADY, THEIRS, U_VALUES, by_value, few, m_fall, plain_numbers, theirs
from bell_pictures import draw_maps
from fits import log_distance, power_by_logarithms
from harness import Case, Failure, Run, column, number, select, verdict

HERE = os.path.dirname(os.path.realpath(__file__))
SIDE_M = 32768  # of experiment.toml
#: On top of his setting; heights at the nodes themselves, so that no interpolation comes between.
SETTING = ("output.mesh_file=obj", "time.max_steps=400")
#: Height of every node if nothing were dug: uplift's own shape, on the same nodes.
UPLIFT_ALONE = ("river.k=1e-30", "initial.amplitude_m=0", "hillslope.talus_angle_deg=90", "time.max_steps=1",
                "time.convergence=0")


def resolution(quick):
    return ("domain.nodes=5000", "output.resolution=64") if quick else ("output.resolution=160",)


def nodes_of(tools, case, name, *overrides):
    """(columns x, y, z of the nodes, summary, folder) of a run by his setting and the overrides."""
    folder = os.path.join(tools.work, "bell_2024", case, name)
    os.makedirs(os.path.dirname(folder), exist_ok=True)
    command = [tools.thalweg, "simulate", os.path.join(HERE, "experiment.toml"), "--out", folder, "--force", "--quiet",
               "--no-figures", "--threads", "1"]
    for override in (*SETTING, *overrides):
        command += ["--set", override]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise Failure(f"{' '.join(command)}: {done.stderr.strip() or done.returncode}")
    with open(os.path.join(folder, "summary.json"), encoding="utf-8") as stream:
        summary = json.load(stream)
    with open(os.path.join(folder, "mesh.obj"), encoding="utf-8") as stream:
        nodes = np.loadtxt((line[2:] for line in stream if line.startswith("v ")))
    return nodes.T, summary, folder


def two_at_a_time(work, *many):
    with ThreadPoolExecutor(2) as pool:
        return list(pool.map(work, *many))


def on_rim(x, y):
    return (x < 1) | (y < 1) | (x > SIDE_M - 1) | (y > SIDE_M - 1)


def maps_of(titles, columns, width=7.2):
    def draw(rows, _, folders):
        return draw_maps([os.path.join(folder, "elevation.tif") for folder in folders], titles(rows), columns, False, width)
    return draw


# ---- patterns of uplift

PATTERNS = {"constant": (), "gradient": (), "stepped": ("uplift.steps=4",), "diamond": (), "radial": (),
            **{kind: ("uplift.pattern=noise", f"uplift.noise={kind}") for kind in ("fbm", "billow", "ridge", "warped")}}


def patterns_rows(tools, quick):
    """Of each pattern: its mean uplift, and mean heights where it is above and below its median."""
    def one(name):
        given = (*resolution(quick), f"uplift.pattern={name}", *PATTERNS[name])
        (_, _, uplifted), _, _ = nodes_of(tools, "patterns", f"{name} alone", *given, *UPLIFT_ALONE)
        (_, _, z), summary, folder = nodes_of(tools, "patterns", name, *given)
        share, free = uplifted / uplifted.max(), uplifted > 0
        high = share > np.median(share[free])
        row = {"pattern": name, "nodes": summary["nodes"], "steps": summary["steps"],
               "mean_uplift_share": share[free].mean(), "elevation_max_m": z.max(), "elevation_mean_m": z.mean(),
               "mean_m_where_uplift_is_high": z[free & high].mean() if high.any() else None,
               "mean_m_where_it_is_low": z[free & ~high].mean() if high.any() else None}
        return row, folder
    found = two_at_a_time(one, PATTERNS)
    return [row for row, _ in found], [folder for _, folder in found]


def patterns_judge(rows, _):
    even, uneven = rows[0], rows[1:]
    ratio = [row["mean_m_where_uplift_is_high"] / row["mean_m_where_it_is_low"] for row in uneven]
    share = [row["elevation_mean_m"] / even["elevation_mean_m"] for row in uneven]
    return [verdict("mountains stand where it is painted that they rise", "figure",
                    f"the half with more uplift stands {number(min(ratio))} to {number(max(ratio))} times as high as the other",
                    "higher in all eight uneven patterns", min(ratio) > 1),
            verdict("theory: uplift that is nowhere more than even uplift raises less", "less",
                    f"mean height {number(min(share))} to {number(max(share))} of that of even uplift", "under 1, all eight",
                    max(share) < 1)]


# ---- islands

#: Zero uplift toward the rim, all of the rim as outlet. `islands.pgm` is a painted picture: two islands.
ISLANDS = {"round": ("uplift.pattern=radial",),
           "two, painted": (f"uplift.field={os.path.join(HERE, 'islands.pgm')}",)}


def pieces(x, y, land):
    """Number of separate pieces of land larger than 1 % of it, counted on cells of twice the nodes' distance."""
    cells = int(np.sqrt(len(x)) / 2)
    place = [np.minimum((each / SIDE_M * cells).astype(int), cells - 1) for each in (y, x)]
    dry, count = np.zeros((cells, cells)), np.zeros((cells, cells))
    np.add.at(dry, tuple(place), land)
    np.add.at(count, tuple(place), 1)
    left = {(int(r), int(c)) for r, c in zip(*np.nonzero(dry * 2 > count))}
    total, found = len(left), []
    while left:
        stack, size = [left.pop()], 0
        while stack:
            r, c = stack.pop()
            size += 1
            for beside in ((r + 1, c), (r - 1, c), (r, c + 1), (r, c - 1)):
                if beside in left:
                    left.remove(beside)
                    stack.append(beside)
        found.append(size)
    return sum(size > 0.01 * total for size in found)


def islands_rows(tools, quick):
    def one(name):
        given = (*resolution(quick), *ISLANDS[name])
        (_, _, uplifted), _, _ = nodes_of(tools, "islands", f"{name} alone", *given, *UPLIFT_ALONE)
        (x, y, z), summary, folder = nodes_of(tools, "islands", name, *given)
        sea = uplifted <= 0
        return {"island": name, "nodes": summary["nodes"], "steps": summary["steps"], "elevation_max_m": z.max(),
                "sea_share": sea.mean(), "highest_at_sea_m": z[sea].max(), "sea_p99_m": np.quantile(z[sea], 0.99),
                "land_that_is_not_above_sea_share": (z[~sea] <= 0).mean(), "pieces": pieces(x, y, z > 0.01 * z.max())}, folder
    found = two_at_a_time(one, ISLANDS)
    return [row for row, _ in found], [folder for _, folder in found]


def islands_judge(rows, _):
    flat = max(row["sea_p99_m"] / row["elevation_max_m"] for row in rows)
    sunk = max(row["land_that_is_not_above_sea_share"] for row in rows)
    return [verdict("where nothing rises there is the sea", "figure",
                    f"99 % of the nodes without uplift under {number(flat, 1)} of the highest point",
                    "under 0.01 of it", flat < 0.01),
            verdict("what rises is land", "figure", f"{number(100 * sunk)} % of the rising nodes at sea level", "under 1 %",
                    sunk < 0.01),
            verdict("as many islands as were painted", "1 and 2", " and ".join(number(row["pieces"]) for row in rows), "equal",
                    [row["pieces"] for row in rows] == [1, 2])]


# ---- outlets

OUTLETS = {"whole rim": 'outlets="all"', "uplift under 0.33": "outlets={uplift_below=0.33}", "south side": 'outlets=["south"]'}


def outlets_rows(tools, quick):
    """Uplift rises from west to east; where may water leave, and where does the land stand highest?"""
    def one(case):
        name, seed = case
        (x, y, z), summary, folder = nodes_of(tools, "outlets", f"{name} {seed}", *resolution(quick), f"seed={seed}",
                                              "uplift.pattern=gradient", "uplift.direction_deg=90", OUTLETS[name])
        rim, share = on_rim(x, y), x / SIDE_M
        wanted = {"whole rim": rim, "uplift under 0.33": rim & (share < 0.33), "south side": rim & (y < 1)}[name]
        others = rim & ~wanted & (share > 0)  # at the very west nothing rises, which stays at base level by itself
        away = (y if name == "south side" else x) / SIDE_M  # from the open side, in sides
        return {"outlets": name, "seed": seed, "nodes": summary["nodes"], "steps": summary["steps"],
                "outlet_nodes": wanted.sum(), "outlets_not_at_base_level": (z[wanted] != 0).sum(),
                "other_rim_nodes": others.sum(), "other_rim_nodes_at_base_level": (z[others] <= 0).sum(),
                "elevation_max_m": z.max(), "elevation_mean_m": z.mean(), "highest_at_share": away[np.argmax(z)],
                "highest_quarter": 1 + np.argmax([z[(away * 4).astype(int) == quarter].mean() for quarter in range(4)])}, folder
    found = two_at_a_time(one, [(name, seed) for name in OUTLETS for seed in range(1, 3 if quick else 5)])
    return [row for row, _ in found], [folder for row, folder in found if row["seed"] == 1]


def outlets_judge(rows, _):
    threshold, south = (select(rows, outlets=name) for name in list(OUTLETS)[1:])
    moved = sum(row["outlets_not_at_base_level"] for row in rows)
    sunk = sum(row["other_rim_nodes_at_base_level"] for row in rows)
    mean = [np.mean(column(select(rows, outlets=name), "elevation_mean_m")) for name in OUTLETS]
    places = column(threshold + south, "highest_at_share")
    quarters = column(threshold + south, "highest_quarter")
    return [verdict("water leaves the rim where uplift is under the threshold, and nowhere else", "0.33 of the largest",
                    f"{number(threshold[0]['outlet_nodes'])} outlets; {number(moved)} of all off base level, "
                    f"{number(sunk)} other rising rim nodes at it", "none of either, all three kinds", moved == 0 and sunk == 0),
            verdict("a closed rim becomes the divide: the highest point moves to it", "figure",
                    f"{sum(place > 0.75 for place in places)} of {len(places)} highest points in the quarter before it (threshold "
                    "and south, each seed)", "all; explained, one point being a matter of the seed, if that quarter's mean height "
                    "is the highest in all", min(places) > 0.75, explained=min(quarters) == 4, full_only=True),
            verdict("fewer outlets, longer rivers, higher ground", "figure",
                    f"mean {', '.join(number(each) for each in mean)} m: rim, threshold, south",
                    "threshold and south above the whole rim", min(mean[1:]) > mean[0])]


# ---- rainfall

RAIN = [0.25, 0.5, 1, 2, 4]
RAIN_PATTERNS = {"even rain": (), "wet in the east": ("rainfall.pattern=gradient", "rainfall.direction_deg=90"),
                 "wet in the middle": ("rainfall.pattern=radial",)}


def rainfall_rows(tools, quick):
    """Even rain of several amounts, with a talus limit and without; and patterns of rain, the first of them with a map."""
    def even(case):
        variant, value = case
        given = (f"rainfall.maximum={value}", *((FREE, "river.receiver=steepest", *STEADY) if variant != "his setting" else ()))
        (_, _, z), summary, _ = nodes_of(tools, "rainfall", f"{variant} {value}", *resolution(quick), *given)
        return {"variant": variant, "value": value, "nodes": summary["nodes"], "steps": summary["steps"],
                "elevation_max_m": z.max(), "elevation_mean_m": z.mean()}

    def pattern(name):
        (x, _, z), summary, folder = nodes_of(tools, "rainfall", name, *resolution(quick), *RAIN_PATTERNS[name])
        east, west = z[x > SIDE_M / 2].mean(), z[x < SIDE_M / 2].mean()
        return {"variant": name, "value": 1, "nodes": summary["nodes"], "steps": summary["steps"], "elevation_max_m": z.max(),
                "elevation_mean_m": z.mean(), "west_over_east": west / east}, folder
    values = RAIN[::2] if quick else RAIN
    rows = two_at_a_time(even, [(variant, value) for variant in ("his setting", "no talus limit") for value in values])
    maps = two_at_a_time(pattern, RAIN_PATTERNS)
    return rows + [row for row, _ in maps], [folder for _, folder in maps]


def rainfall_judge(rows, _):
    def exponent(variant):
        mine = select(rows, variant=variant)
        return power_by_logarithms(column(mine, "value"), column(mine, "elevation_max_m"))[1]
    free, limited = exponent("no talus limit"), exponent("his setting")
    west = select(rows, variant="wet in the east")[0]["west_over_east"]
    even = select(rows, variant="even rain")[0]["west_over_east"]
    return [verdict("theory: rain acts through k·(r·A)^m, so h ∝ r^−m without a talus limit", "-0.5", f"{free:.4f}",
                    "within 0.01", abs(free + 0.5) < 0.01),
            verdict("with a talus limit rain lowers less", "between -0.5 and 0", f"{limited:.3f}", "between -0.5 and 0",
                    -0.5 < limited < 0),
            verdict("the wetter side is worn lower", "figure", f"the dry half stands {number(west)} times as high as the wet one; "
                    f"with even rain {number(even)}", "over 1.1, and more than with even rain", west > 1.1 and west > even)]


# ---- what hangs on the talus angle

ANGLES = [25, 30, 35]
STUDIED = {"area_exponent": ("river.m={}", M_VALUES), "uplift": ("uplift.rate_m_per_yr={}", U_VALUES),
           "erodibility": ("river.k={}", K_VALUES)}


def angles_runs(quick):
    return [Run({"angle_deg": angle, "table": table, **run.labels},
                (*run.overrides, f"hillslope.talus_angle_deg={angle}", f"domain.nodes={5000 if quick else 15000}"))
            for angle in ANGLES for table, (override, values) in STUDIED.items()
            for run in by_value(few(values, quick, 5), override, quick)]


def angle_tests(rows, published, angle):
    """{claim: (his, ours, held)} with the criteria of A.1 to A.3."""
    found = {}
    for table in STUDIED:
        mine = select(rows, angle_deg=angle, table=table)
        his_all = dict(zip(*theirs([row for row in published if row["case"] == table])))
        value, ours = np.array(column(mine, "value")), np.array(column(mine, "elevation_max_m"))
        his = np.array([his_all[each] for each in value])
        apart, most = log_distance(ours, his), 0.2 if table == "area_exponent" else 0.15
        if table == "area_exponent":
            pair = m_fall(value, his), m_fall(value, ours)
            found["A.1 d ln h/dm, within 7 %"] = (*pair, abs(pair[1] / pair[0] - 1) < 0.07)
        else:
            name, room = ("A.2 exponent of u, within 0.05", 0.05) if table == "uplift" else ("A.3 exponent of k, within 0.06", 0.06)
            pair = power_by_logarithms(value, his)[1], power_by_logarithms(value, ours)[1]
            found[name] = (*pair, abs(pair[1] - pair[0]) < room)
        place = {"area_exponent": "A.1", "uplift": "A.2", "erodibility": "A.3"}[table]
        found[f"{place} heights apart, under {100 * most:.0f} %"] = (0, apart, apart < most)
    return found


def angles_judge(rows, published):
    tests = {angle: angle_tests(rows, published, angle) for angle in ANGLES}
    trends = [claim for claim in tests[30] if "apart" not in claim]
    heights = [claim for claim in tests[30] if "apart" in claim]

    def held(claims, angle):
        return sum(tests[angle][claim][2] for claim in claims)

    def counted(claims):
        return ", ".join(f"{held(claims, angle)} of {len(claims)} at {angle}°" for angle in ANGLES)
    return [verdict("the trends by m, u and k do not hang on the angle that was fitted", "not stated", counted(trends),
                    "all three at 25° and at 35°", all(held(trends, angle) == 3 for angle in (25, 35)), full_only=True),
            verdict("nor do the heights", "not stated", counted(heights), "all three tables at 25° and at 35°",
                    all(held(heights, angle) == 3 for angle in (25, 35)), full_only=True)]


def angles_text(rows, published):
    tests = {angle: angle_tests(rows, published, angle) for angle in ANGLES}
    lines = []
    for claim, (his, _, _) in tests[30].items():
        ours = " | ".join(f"{100 * value:.0f} %{mark}" if "apart" in claim else f"{value:.3g}{mark}"
                          for value, mark in ((tests[angle][claim][1], "" if tests[angle][claim][2] else " (differs)")
                                              for angle in ANGLES))
        lines.append(f"| {claim} | {'0' if 'apart' in claim else f'{his:.3g}'} | {ours} |")
    return """
Our 30° is no choice of Bell's: it was fitted to the heights of his tables (above), so that verdicts on heights are partly
circular. His setting again with 15 000 nodes and one seed, with the angle that was fitted and 5° to either side, judged as
A.1 to A.3 are:

| claim and criterion | Bell 2024 | 25° | 30° | 35° |
|---|---|---|---|---|
""" + "\n".join(lines)


def angles_draw(rows, published, _):
    drawing = style.figure(2.8, 7.2)
    labels = {"area_exponent": "exponent of the area, m", "uplift": "uplift rate (mm/yr)", "erodibility": "k (10$^{-6}$ yr$^{-1}$)"}
    for axes, table in zip(drawing.subplots(1, 3), STUDIED):
        unit = {"uplift": 1e3, "erodibility": 1e6}.get(table, 1)
        value, height = theirs([row for row in published if row["case"] == table])
        axes.plot(np.array(value) * unit, height, **{**THEIRS, "zorder": 3})
        for angle, look in zip(ANGLES, ("--", "-", ":")):
            mine = select(rows, angle_deg=angle, table=table)
            axes.plot(np.array(column(mine, "value")) * unit, column(mine, "elevation_max_m"), look, color=style.SYNTHETIC,
                      label=f"ours, {angle}°")
        axes.set(xscale="linear" if table == "area_exponent" else "log", yscale="log", xlabel=labels[table])
        plain_numbers(axes.xaxis)
    drawing.axes[0].set_ylabel("highest point (m)")
    drawing.axes[0].legend()
    return drawing


CASES = [
    Case("patterns", "Patterns of uplift", None, patterns_judge,
         maps_of(lambda rows: [f"{row['pattern']}: {number(row['elevation_max_m'])} m" for row in rows], 3, 5.4),
         compute=patterns_rows, palette=True,
         columns=("pattern", "steps", "mean_uplift_share", "elevation_max_m", "elevation_mean_m", "mean_m_where_uplift_is_high",
                  "mean_m_where_it_is_low")),
    Case("islands", "Islands: no uplift, no land", None, islands_judge,
         maps_of(lambda rows: [f"{row['island']}: {number(row['elevation_max_m'])} m" for row in rows], 2),
         compute=islands_rows, palette=True,
         columns=("island", "steps", "elevation_max_m", "sea_share", "sea_p99_m", "highest_at_sea_m", "pieces")),
    Case("outlets", "Outlets by threshold and by side", None, outlets_judge,
         maps_of(lambda rows: [f"{row['outlets']}: {number(row['elevation_max_m'])} m" for row in select(rows, seed=1)], 3),
         compute=outlets_rows, palette=True,
         columns=("outlets", "seed", "steps", "outlet_nodes", "elevation_max_m", "elevation_mean_m", "highest_at_share",
                  "highest_quarter")),
    Case("rainfall", "Rainfall", None, rainfall_judge,
         lambda rows, _, folders: draw_maps([os.path.join(folder, "elevation.tif") for folder in folders],
                                            list(RAIN_PATTERNS), 3, True),
         compute=rainfall_rows, palette=True,
         columns=("variant", "value", "steps", "elevation_max_m", "elevation_mean_m", "west_over_east")),
    Case("talus_sensitivity", "What hangs on the talus angle", angles_runs, angles_judge, angles_draw, angles_text,
         also_published=tuple(STUDIED)),
]
