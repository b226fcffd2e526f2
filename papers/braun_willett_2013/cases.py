# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear cost and insensitivity to the time step: Braun & Willett (2013)."""
import numpy as np

import style
from fits import power_by_logarithms
from harness import Case, column, number, printed_rows, select, verdict

TITLE = "Braun & Willett 2013: the implicit stream-power solver, linear in the nodes"
LEAD = """
An order in which receivers come before donors makes the implicit step explicit: its cost is O(n), and it is stable for
any time step. Their abstract claims both; of their tables and figures no number is known to us, so none stands in
`published.csv` but the exponent of the cost. One experiment answers (`one_experiment.cpp`): an island on a raster of 100 m
cells, u = 1e-3 m/yr, m = 0.5, n = 1, from uniform noise of 1 m, all sides at base level, lakes led over their passes.
"""


def ask(tools, *arguments):
    return printed_rows(tools, "paper_braun_willett_2013", *arguments)


# ---- cost

def cost_rows(tools, quick):
    """Per number of nodes: the quickest step of the later half, and the first, with the most lakes."""
    rows = ask(tools, "cost", 30, *([50, 100, 200] if quick else [100, 200, 500, 1000, 2000]))
    found = []
    for nodes in sorted(set(column(rows, "nodes"))):
        mine = select(rows, nodes=nodes)
        later = column(mine[len(mine) // 2:], "seconds")
        found.append({"nodes": nodes, "lakes_first": mine[0]["lakes"], "lakes_last": mine[-1]["lakes"],
                      "seconds_first_step": mine[0]["seconds"], "seconds_later_step": min(later),
                      "seconds_per_node_step": min(later) / nodes})
    return found, []


def cost_judge(rows, _):
    first, later = (power_by_logarithms(column(rows, "nodes"), column(rows, name))[1]
                    for name in ("seconds_first_step", "seconds_later_step"))
    span = f"{number(rows[0]['nodes'])} to {number(rows[-1]['nodes'])} nodes"
    return [verdict("cost of a step by nodes: exponent", "1", f"{later:.2f} ({span})", "under 1.15 (caches included)",
                    later < 1.15, full_only=True),
            verdict("the same for the first step, when a tenth of the nodes are lakes", "1", f"{first:.2f}", "under 1.15",
                    first < 1.15, full_only=True)]


def cost_draw(rows, _, __):
    drawing = style.figure(3, 5)
    axes = drawing.add_subplot()
    nodes = np.array(column(rows, "nodes"))
    for name, look in (("seconds_first_step", style.LOOK["real"]), ("seconds_later_step", style.LOOK["synthetic"])):
        axes.loglog(nodes, column(rows, name), **look, label=name.replace("seconds_", "").replace("_", " "))
    axes.loglog(nodes, rows[0]["seconds_later_step"] * nodes / nodes[0], ":", color=style.INK, label="linear")
    axes.set_xlabel("nodes")
    axes.set_ylabel("seconds")
    axes.legend()
    return drawing


# ---- one landscape, many time steps

def transient_judge(rows, _):
    reference = rows[0]["mean_halfway_m"]
    near = [row for row in rows[1:] if row["step_yr"] <= 2e5]
    error = [1 - row["mean_halfway_m"] / reference for row in near]
    order = power_by_logarithms(column(near, "step_yr"), error)[1]
    at_most = abs(1 - rows[-1]["mean_halfway_m"] / reference)
    ends = np.array(column(rows, "mean_end_m"))
    return [verdict("transient: the error is the scheme's truncation error, of first order in dt", "implicit Euler: 1",
                    f"{order:.2f}", "between 0.9 and 1.1, dt from 1e4 to 2e5 yr", 0.9 < order < 1.1),
            verdict("transient: even dt = 1e6 yr, two steps in all, stays near", "stable", f"{100 * at_most:.1f} % of the mean "
                    "height off", "under 15 %", at_most < 0.15),
            verdict("steady: the same mean height for dt from 1e3 to 1e6 yr", "independent of dt",
                    f"{100 * (ends.max() / ends.min() - 1):.2f} % between least and most", "under 3 %",
                    ends.max() / ends.min() < 1.03)]


def transient_text(rows, _):
    share = rows[0]["mean_halfway_m"] / rows[0]["mean_start_m"] - 1
    return f"""
k = 2e-6 /yr, so that the island answers within some million years. It is steady, then its uplift doubles; after 2 Myr
{100 * share:.0f} % of the way to twice the mean height is done (dt = 1e3 yr), after 40 Myr all of it."""


def transient_draw(rows, _, __):
    drawing = style.figure(3, 7.2)
    left, right = drawing.subplots(1, 2)
    steps = np.array(column(rows[1:], "step_yr"))
    reference = rows[0]["mean_halfway_m"]
    error = 1 - np.array(column(rows[1:], "mean_halfway_m")) / reference
    left.loglog(steps / 1e3, error, **style.LOOK["synthetic"], label="of the mean height")
    left.loglog(steps / 1e3, column(rows[1:], "difference_halfway"), **style.LOOK["real"],
                label="root mean square of all heights")
    left.loglog(steps / 1e3, error[0] * steps / steps[0], ":", color=style.INK, label="first order")
    left.set_ylabel("error after 2 Myr, relative to dt = 1 kyr")
    right.semilogx(np.array(column(rows, "step_yr")) / 1e3, column(rows, "mean_end_m"), **style.LOOK["synthetic"],
                   label="after 40 Myr")
    right.semilogx(np.array(column(rows, "step_yr")) / 1e3, column(rows, "mean_halfway_m"), **style.LOOK["real"],
                   label="after 2 Myr")
    right.set_ylim(0, 1.15 * max(column(rows, "mean_end_m")))
    right.set_ylabel("mean height (m)")
    for axes in (left, right):
        axes.set_xlabel("time step (kyr)")
        axes.legend()
    return drawing


# ---- eight seeds, two time steps

def seeds_judge(rows, _):
    short, long = (select(rows, step_yr=step) for step in (2e4, 1e5))
    mean = [float(np.mean(column(mine, "mean_m"))) for mine in (short, long)]
    relief = [float(np.mean(column(mine, "relief_m"))) for mine in (short, long)]
    scatter = float(np.std(column(short, "relief_m"), ddof=1))
    standing = sum(column(rows, "standing_at_4_myr"))
    return [verdict("mean height: dt = 1e5 yr against 2e4 yr", "independent of dt", f"{100 * (mean[1] / mean[0] - 1):+.2f} %",
                    "within 3 %", abs(mean[1] / mean[0] - 1) < 0.03),
            verdict("relief", "independent of dt", f"{number(relief[1])} m against {number(relief[0])} m", "within the "
                    f"standard deviation between seeds, {number(scatter)} m", abs(relief[1] - relief[0]) < scatter,
                    full_only=True),
            verdict("vertices left standing at u·t after 4 Myr", "none", number(standing), "none", standing == 0)]


def seeds_text(rows, _):
    return """
k = 2e-5 /yr, from noise; each run goes on until neither mean height nor relief moves by 0.1 % in a million years. A solver
that skips vertices whose receiver stands higher leaves plateaus at u·t, and more of them with longer steps (13–30 % of
the vertices after 4 Myr, measured with another program at dt = 1e5 yr)."""


def seeds_draw(rows, _, __):
    drawing = style.figure(3, 7.2)
    left, right = drawing.subplots(1, 2)
    for step, look in ((2e4, style.LOOK["real"]), (1e5, style.LOOK["synthetic"])):
        mine = select(rows, step_yr=step)
        for axes, name in ((left, "mean_m"), (right, "relief_m")):
            axes.plot(column(mine, "seed"), column(mine, name), **{**look, "linestyle": "none"}, label=f"dt = {number(step / 1e3)} kyr")
    left.set_ylabel("mean height at rest (m)")
    right.set_ylabel("relief at rest (m)")
    for axes, name in ((left, "mean_m"), (right, "relief_m")):
        axes.set_xlabel("seed")
        axes.set_ylim(0, 1.15 * max(column(rows, name)))
        axes.legend(loc="lower right")
    return drawing


CASES = [
    Case("cost", "Cost by nodes", None, cost_judge, cost_draw, columns=("nodes", "lakes_first", "lakes_last",
         "seconds_first_step", "seconds_later_step", "seconds_per_node_step"), compute=cost_rows, timed=True),
    Case("transient", "One transient, time steps from 1e3 to 1e6 yr", None, transient_judge, transient_draw, transient_text,
         columns=("step_yr", "mean_halfway_m", "difference_halfway", "mean_end_m"),
         compute=lambda tools, quick: (ask(tools, "transient", 25 if quick else 100), [])),
    Case("seeds", "Eight seeds from noise, dt = 2e4 and 1e5 yr", None, seeds_judge, seeds_draw, seeds_text,
         columns=("step_yr", "seed", "time_yr", "mean_m", "relief_m", "standing_at_4_myr"),
         compute=lambda tools, quick: (ask(tools, "seeds", 64 if quick else 128, 3 if quick else 8, 2e4, 1e5), [])),
]
