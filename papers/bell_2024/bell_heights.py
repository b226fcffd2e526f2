# SPDX-License-Identifier: GPL-3.0-or-later
"""Bell's tables of the highest point: by m, u, k and the side of the domain."""
import matplotlib.ticker
import numpy as np

import style
from fits import line, log_distance, power_by_logarithms, power_by_values
from harness import Case, Run, column, number, select, verdict

THEIRS = {"color": style.REAL, "marker": "o", "linestyle": "none", "label": "Bell 2024"}
OURS = {"color": style.SYNTHETIC, "marker": "^", "linestyle": "-", "label": "ours, his setting"}
OTHERS = ("#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#6c737c")


def few(values, quick, most=6):
    """All values, or a few of them evenly from the first to the last."""
    return [values[round(i)] for i in np.linspace(0, len(values) - 1, most)] if quick else values


def setting(quick):
    return ("domain.nodes=10000",) if quick else ()


def theirs(published, quantity="elevation_max_m"):
    """Values of the parameter and what Bell reports there."""
    rows = [row for row in published if row["quantity"] == quantity and row["value"] is not None]
    return column(rows, "value"), column(rows, "published")


def beside(rows, published, quantity="elevation_max_m"):
    """(parameter, ours, his) where both have a number."""
    his = dict(zip(*theirs(published, quantity)))
    found = [(row["value"], row[quantity], his[row["value"]]) for row in rows if row["value"] in his]
    return tuple(np.array(found).T)


def by_value(values, override, quick, variant="his setting", *further):
    return [Run({"variant": variant, "value": value}, (*setting(quick), override.format(value), *further)) for value in values]


def axes_of(drawing, xlabel, ylabel="highest point (m)", logarithmic="xy"):
    axes = drawing.add_subplot()
    if "x" in logarithmic:
        axes.set_xscale("log")
    if "y" in logarithmic:
        axes.set_yscale("log")
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    return axes


def plain_numbers(axis):
    axis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda value, _: number(value)))


# ---- A.1: the exponent of the area

M_VALUES = [.1, .25, .4, .45, .475, .5, .525, .55, .6, .75, .9]


def m_runs(quick):
    values = few(M_VALUES, quick, 7)
    return (by_value(values, "river.m={}", quick)
            + by_value(values, "river.m={}", quick, "no talus limit", "hillslope.talus_angle_deg=90", "time.solver=steady",
                       "time.max_steps=3000", "river.receiver=steepest"))


def m_fall(m, height):
    """d ln h/dm over 0.4–0.9, where rivers and not the talus limit make the relief."""
    river = m >= 0.4
    return line(m[river], np.log(height[river]))[0]


def m_judge(rows, published):
    m, ours, his = beside(select(rows, variant="his setting"), published)
    apart = log_distance(ours, his)
    free = select(rows, variant="no talus limit", value=0.1)[0]["elevation_max_m"]
    return [verdict("relief falls by m: d ln h/dm, m from 0.4", number(m_fall(m, his)), number(m_fall(m, ours)), "within 7 %",
                    abs(m_fall(m, ours) / m_fall(m, his) - 1) < 0.07, full_only=True),
            verdict("each height", "table A.1", f"{100 * apart:.0f} % apart (root mean square)", "under 20 %", apart < 0.2),
            verdict("little change for m under 0.4: the talus limit alone stands", number(his[0]), number(ours[0]),
                    "within 15 %, and 20 times higher without the limit",
                    abs(ours[0] / his[0] - 1) < 0.15 and free > 20 * ours[0])]


def m_draw(rows, published, _):
    drawing = style.figure(3.2, 5)
    axes = axes_of(drawing, "exponent of the area, m", logarithmic="y")
    axes.plot(*theirs(published), **THEIRS)
    ours = select(rows, variant="his setting")
    axes.plot(column(ours, "value"), column(ours, "elevation_max_m"), **OURS)
    free = select(rows, variant="no talus limit")
    axes.plot(column(free, "value"), column(free, "elevation_max_m"), ":", color=style.MUTED, label="ours, no talus limit")
    axes.set_ylim(20, 5e4)
    axes.legend()
    return drawing


# ---- A.3: erodibility

K_VALUES = [5e-8, 3e-7, 5e-7, 6e-7, 8e-7, 1e-6, 1.2e-6, 1.5e-6]


def k_runs(quick):
    return by_value(few(K_VALUES, quick), "river.k={}", quick)


def k_judge(rows, published):
    k, ours, his = beside(rows, published)
    (slope, rest, r2), (his_slope, his_rest, his_r2) = line(k, 1 / ours), line(k, 1 / his)
    apart = log_distance(ours, his)
    exponent, his_exponent = power_by_logarithms(k, ours)[1], power_by_logarithms(k, his)[1]
    return [verdict("1/h is linear in k", f"r² {his_r2:.4f}", f"r² {r2:.4f}", "r² over 0.99", r2 > 0.99),
            verdict("its slope, yr/m per unit of k", number(his_slope), number(slope), "within 15 %",
                    abs(slope / his_slope - 1) < 0.15),
            verdict("its intercept is not 0: even k = 0 leaves a finite height, the talus cone", f"{number(1 / his_rest)} m",
                    f"{number(1 / rest)} m", "between 8 000 and 20 000 m", 8e3 < 1 / rest < 2e4),
            verdict("exponent of k", number(his_exponent), number(exponent), "within 0.06",
                    abs(exponent - his_exponent) < 0.06, full_only=True),
            verdict("each height", "table A.3", f"{100 * apart:.0f} % apart (root mean square)", "under 15 %", apart < 0.15,
                    full_only=True)]


def k_draw(rows, published, _):
    drawing = style.figure(3.2, 5)
    axes = axes_of(drawing, "k (10$^{-6}$ yr$^{-1}$)", "1 / highest point (1/km)", "")
    k, height = theirs(published)
    axes.plot(np.array(k) * 1e6, 1e3 / np.array(height), **THEIRS)
    k, height = np.array(column(rows, "value")), np.array(column(rows, "elevation_max_m"))
    axes.plot(k * 1e6, 1e3 / height, **{**OURS, "linestyle": "none"})
    slope, rest, _ = line(k, 1e3 / height)
    reach = np.array([0, 1.6e-6])
    axes.plot(reach * 1e6, rest + slope * reach, "-", color=style.SYNTHETIC, label="line through ours")
    axes.set_xlim(0, None)
    axes.set_ylim(0, None)
    axes.legend()
    return drawing


# ---- A.2: uplift

U_VALUES = [2.5e-5, 5e-5, 1e-4, 2.5e-4, 4e-4, 5e-4, 6e-4, 7.5e-4, 9e-4, 1e-3, 1.5e-3, 2e-3]
FREE = "hillslope.talus_angle_deg=90"
STEADY = ("time.solver=steady", "time.max_steps=3000")
#: Each suspect alone, and what he did.
U_VARIANTS = {
    "his setting": (),
    "theory: steepest receiver, steady, no talus limit": (FREE, "river.receiver=steepest", *STEADY),
    "lowest neighbour alone": (FREE,),
    "150 steps alone": (FREE, "river.receiver=steepest", "time.max_steps=150", "time.convergence=0"),
    "uneven uplift alone": (FREE, "river.receiver=steepest", "uplift.pattern=radial", *STEADY),
    "talus limit alone": ("river.receiver=steepest", *STEADY),
    "talus limit and uneven uplift": ("river.receiver=steepest", "uplift.pattern=radial", *STEADY),
}


def u_runs(quick):
    return [Run({"variant": variant, "seed": seed, "value": value},
                (*setting(quick), f"seed={seed}", f"uplift.rate_m_per_yr={value}", *overrides))
            for variant, overrides in U_VARIANTS.items() for seed in ((1,) if quick or FREE in overrides else (1, 2, 3))
            for value in few(U_VALUES, quick)]


def exponents(rows, variant, fit):
    """One per seed."""
    found = []
    for seed in sorted(set(column(select(rows, variant=variant), "seed"))):
        mine = select(rows, variant=variant, seed=seed)
        found.append(fit(column(mine, "value"), column(mine, "elevation_max_m"))[1])
    return found


def u_judge(rows, published):
    u, his = theirs(published)
    present = sorted({row["value"] for row in rows})
    his = [height for value, height in zip(u, his) if value in present]
    stated = next(row["published"] for row in published if row["quantity"] == "exponent")
    by_values, by_logs = (float(np.mean(exponents(rows, "his setting", fit))) for fit in (power_by_values, power_by_logarithms))
    refit, his_logs = power_by_values(present, his)[1], power_by_logarithms(present, his)[1]
    free = [exponents(rows, variant, power_by_logarithms) for variant in list(U_VARIANTS)[1:5]]
    talus = float(np.mean(exponents(rows, "talus limit alone", power_by_logarithms)))
    uneven = float(np.mean(exponents(rows, "talus limit and uneven uplift", power_by_values)))
    far = max(abs(exponent - 1) for each in free for exponent in each)
    mean = np.exp(np.mean([np.log(column(select(rows, variant="his setting", seed=seed), "elevation_max_m"))
                           for seed in sorted({row["seed"] for row in rows})], axis=0))
    apart = log_distance(mean, his)
    return [verdict("h ∝ u^b, fitted to heights", f"{stated} (from his heights: {refit:.3f})", f"{by_values:.3f}",
                    f"within 0.05; explained if his uplift image can do it: radial uplift gives {uneven:.3f}",
                    abs(by_values - refit) < 0.05, explained=abs(uneven - refit) < 0.05, full_only=True),
            verdict("the same, fitted to logarithms", f"{his_logs:.3f} (from his heights)", f"{by_logs:.3f}", "within 0.05",
                    abs(by_logs - his_logs) < 0.05, full_only=True),
            verdict("theory: h ∝ u wherever no slope is limited", "1", f"1 ± {number(max(far, 1e-3), 1)}",
                    "within 0.02, four variants", far < 0.02),
            verdict("the talus limit alone brings the exponent down", f"{his_logs:.3f}", f"{talus:.3f}", "within 0.06",
                    abs(talus - his_logs) < 0.06, full_only=True),
            verdict("each height", "table A.2", f"{100 * apart:.0f} % apart (root mean square)", "under 15 %", apart < 0.15,
                    full_only=True)]


def spread(values):
    return f"{np.mean(values):.3f}" + (f" ± {np.std(values, ddof=1):.3f}" if len(values) > 1 else "")


def u_text(rows, published):
    u, height = theirs(published)
    lines = []
    for variant in U_VARIANTS:
        logs, values = (exponents(rows, variant, fit) for fit in (power_by_logarithms, power_by_values))
        lines.append(f"| {variant} | {spread(logs)} | {spread(values)} |")
    local = np.diff(np.log(height)) / np.diff(np.log(u))
    return f"""
He fits h ∝ u^0.568; for n = 1 theory says h ∝ u. Two things make the difference.

1. *The fit.* Least squares of the heights themselves, in which the highest decide, give his number:
   {power_by_values(u, height)[1]:.3f}. Least squares of the logarithms of the same heights give
   {power_by_logarithms(u, height)[1]:.3f}. No power law fits: from one of his heights to the next the exponent is
   {local[0]:.2f} and {local[1]:.2f} at the lowest rates and {np.mean(local[-3:]):.2f} on average at the three highest.
2. *The talus limit.* For n = 1 the equations have no scale of height: u doubled is h doubled, whatever the receiver, the
   number of steps or the pattern of uplift. Only a limit to the slope brings a scale in: where u is high, slopes end at
   the limit. Each suspect by itself, exponents of u (where there are three seeds, mean and standard deviation):

| our runs | fitted to logarithms | fitted to heights |
|---|---|---|
| *Bell's heights* | {power_by_logarithms(u, height)[1]:.3f} | {power_by_values(u, height)[1]:.3f} |
""" + "\n".join(lines)


def u_draw(rows, published, _):
    drawing = style.figure(3.6, 5.6)
    axes = axes_of(drawing, "uplift rate (mm/yr)")
    u, height = theirs(published)
    axes.plot(np.array(u) * 1e3, height, **THEIRS)
    for variant, colour in zip(U_VARIANTS, (style.SYNTHETIC, style.INK, *OTHERS)):
        mine = select(rows, variant=variant, seed=1)
        look = OURS if variant == "his setting" else {"color": colour, "label": variant, "linewidth": 1,
                                                     "linestyle": "--" if variant.startswith("talus") else "-"}
        axes.plot(np.array(column(mine, "value")) * 1e3, column(mine, "elevation_max_m"), **look)
    plain_numbers(axes.xaxis)
    axes.legend()
    return drawing


CASES = [
    Case("area_exponent", "A.1 Highest point by m", m_runs, m_judge, m_draw,
         columns=("variant", "value", "steps", "elevation_max_m", "elevation_mean_m")),
    Case("uplift", "A.2 Highest point by uplift rate, and why h ∝ u^0.568", u_runs, u_judge, u_draw, u_text),
    Case("erodibility", "A.3 Highest point by k", k_runs, k_judge, k_draw,
         columns=("value", "steps", "elevation_max_m", "elevation_mean_m")),
]
