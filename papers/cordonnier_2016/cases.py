# SPDX-License-Identifier: GPL-3.0-or-later
"""Relief against uplift and erodibility, and large time steps: Cordonnier et al. (2016)."""
import numpy as np

import style
from fits import power_by_logarithms
from harness import Case, Run, column, history, number, select, verdict

TITLE = "Cordonnier et al. 2016: terrain from uplift and stream-power erosion"
LEAD = """
They bring Braun & Willett's solver to computer graphics, with lakes joined over their passes, steps of 250 000 yr, and the
rule that the highest point at rest is a constant times u/k. The paper itself was not at hand: parameters, constant and
number of iterations are those that public implementations quote from it, and no other number of theirs stands in
`published.csv`. Their uplift map, number of vertices and talus angle are not known to us.
"""

STEADY = ("time.solver=steady", "time.max_steps=3000")
RATES = [5e-5, 1e-4, 2e-4, 5e-4, 1e-3, 2e-3]
ERODIBILITIES = [1e-7, 2e-7, 5.61e-7, 1e-6, 2e-6]


def nodes_of(quick):
    return ("domain.nodes=5000",) if quick else ()


def relief_runs(quick):
    runs = []
    for talus, angle in (("no talus limit", 90), ("talus limit of 30°", 30)):
        common = (*nodes_of(quick), *STEADY, f"hillslope.talus_angle_deg={angle}")
        runs += [Run({"varied": "u", "talus": talus, "u": u, "k": 5.61e-7}, (*common, f"uplift.rate_m_per_yr={u}"))
                 for u in (RATES[::2] if quick else RATES)]
        runs += [Run({"varied": "k", "talus": talus, "u": 5e-4, "k": k}, (*common, f"river.k={k}"))
                 for k in (ERODIBILITIES[::2] if quick else ERODIBILITIES)]
    for m in (0.4, 0.5):
        for pattern in ("constant", "radial"):
            runs.append(Run({"varied": "pattern", "talus": "no talus limit", "u": 5e-4, "k": 5.61e-7, "m": m, "pattern": pattern},
                            (*nodes_of(quick), *STEADY, f"river.m={m}", f"uplift.pattern={pattern}")))
    return runs


def constants(rows):
    """Highest point over u/k."""
    return [row["elevation_max_m"] * row["k"] / row["u"] for row in rows]


def relief_judge(rows, published):
    free = [row for row in rows if row["talus"] == "no talus limit" and row["varied"] != "pattern"]
    u, k = select(free, varied="u"), select(free, varied="k")
    by_u = power_by_logarithms(column(u, "u"), column(u, "elevation_max_m"))[1]
    by_k = power_by_logarithms(column(k, "k"), column(k, "elevation_max_m"))[1]
    limited = [row for row in rows if row["talus"] != "no talus limit" and row["u"] == 5e-4 and row["k"] == 5.61e-7]
    constant, theirs = constants(limited[:1])[0], published[0]["published"]
    even, uneven = (constants(select(rows, varied="pattern", m=0.5, pattern=pattern))[0] for pattern in ("constant", "radial"))
    return [verdict("highest point at rest ∝ u", "1", f"{by_u:.4f}", "exponent within 0.01, no talus limit",
                    abs(by_u - 1) < 0.01),
            verdict("highest point at rest ∝ 1/k", "-1", f"{by_k:.4f}", "exponent within 0.01, no talus limit",
                    abs(by_k + 1) < 0.01),
            verdict("the constant: highest point over u/k", number(theirs, 4), f"{constant:.2f} (talus limit of 30°); "
                    f"{even:.1f} even, {uneven:.1f} radial uplift without a limit",
                    "within 15 %; explained if theirs lies under the unlimited ones and the talus limit lowers ours by a third",
                    abs(constant / theirs - 1) < 0.15, explained=theirs < min(even, uneven) and constant < even * 2 / 3)]


def relief_text(rows, published):
    table = select(rows, varied="pattern")
    lines = "\n".join(f"| {number(row['m'])} | {row['pattern']} | {constants([row])[0]:.3g} |" for row in table)
    return f"""
Without a talus limit the law is linear in u/k for n = 1, whatever the pattern of uplift, and so are our heights. The
constant is not universal: it depends on m, on the pattern of uplift, on the resolution (the smallest area that counts as
a river) and on the talus limit, with which the proportion itself ends (figure; `../bell_2024`). Highest point over u/k:

| m | uplift | no talus limit |
|---|---|---|
{lines}

For m other than 0.5 it has a unit, m^(1−2m), and depends on the side of the domain."""


def relief_draw(rows, published, _):
    drawing = style.figure(3.2, 7.2)
    for axes, varied, unit, label in zip(drawing.subplots(1, 2, sharey=True), "uk", (1e3, 1e6),
                                         ("uplift rate (mm/yr)", "k (10$^{-6}$ yr$^{-1}$)")):
        for talus, look in (("no talus limit", style.LOOK["synthetic"]), ("talus limit of 30°", style.LOOK["real"])):
            mine = select(rows, varied=varied, talus=talus)
            axes.loglog(np.array(column(mine, varied)) * unit, column(mine, "elevation_max_m"), **look, label=f"ours, {talus}")
        values = np.array(column(mine, varied))
        ratio = values / 5.61e-7 if varied == "u" else 5e-4 / values
        axes.loglog(values * unit, published[0]["published"] * ratio, ":", color=style.INK, label="2.244 u/k")
        axes.set_xlabel(label)
        axes.legend()
        if varied == "u":
            axes.set_ylabel("highest point at rest (m)")
    return drawing


# ---- steps until at rest

def steps_runs(quick):
    return [Run({"step_yr": step, "talus": angle}, (*nodes_of(quick), f"time.step_yr={step}", f"hillslope.talus_angle_deg={angle}",
                                                    f"time.max_steps={round(2e8 / step)}"))
            for angle in (90, 30) for step in ([2.5e5, 1e6] if quick else [5e4, 2.5e5, 1e6])]


def steps_rows(_, __, folder):
    rate, = history(folder, "mean_rate_m_per_yr")
    return {"steps_to_10_percent": next((i for i, value in enumerate(rate, 1) if value < 0.1 * 5e-4), None)}


def steps_judge(rows, published):
    least, most = column(published, "published")
    mine = select(rows, step_yr=2.5e5)
    steps = [step for row in mine for step in (row["steps_to_10_percent"], row["steps"])]
    means = {talus: column(select(rows, talus=talus), "elevation_mean_m") for talus in (90, 30)}
    apart = max(max(values) / min(values) - 1 for values in means.values())
    return [verdict("iterations to rest with steps of 250 000 yr", f"{number(least)} to {number(most)}",
                    f"{number(min(steps))} to {number(max(steps))} (10 % to 1 % of u; with and without talus limit)",
                    "the ranges overlap", min(steps) <= most and max(steps) >= least),
            verdict("large steps are feasible: mean height at rest, dt up to 1e6 yr", "stable",
                    f"{100 * apart:.1f} % between least and most", "under 5 %", apart < 0.05)]


def steps_draw(rows, _, __):
    drawing = style.figure(3, 5)
    axes = drawing.add_subplot()
    for talus, look, label in ((90, style.LOOK["synthetic"], "no talus limit"), (30, style.LOOK["real"], "talus limit of 30°")):
        mine = select(rows, talus=talus)
        axes.loglog(np.array(column(mine, "step_yr")) / 1e3, column(mine, "steps"), **look, label=f"ours, {label}")
    axes.axhspan(100, 300, color=style.MUTED, alpha=0.2, label="Cordonnier et al.: 100 to 300 at 250 kyr")
    axes.set_xlabel("time step (kyr)")
    axes.set_ylabel("steps until the mean rate is 1 % of u")
    axes.legend()
    return drawing


CASES = [
    Case("relief", "Highest point by u and k", relief_runs, relief_judge, relief_draw, relief_text,
         columns=("varied", "talus", "u", "k", "steps", "elevation_max_m", "elevation_mean_m")),
    Case("steps", "Steps until at rest", steps_runs, steps_judge, steps_draw, measure=steps_rows,
         columns=("step_yr", "talus", "steps_to_10_percent", "steps", "elevation_max_m", "elevation_mean_m")),
]
