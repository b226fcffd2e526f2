# SPDX-License-Identifier: GPL-3.0-or-later
"""What was measured on a network beside what networks measure that were grown with the dials found for it."""
import style
from data import get

WORDS = {
    "links": "number of links", "channel_maintenance_m": "area per channel length C",
    "exterior_length_m": "exterior links: mean length", "exterior_length_sd_m": "exterior links: spread",
    "interior_length_m": "interior links: mean length", "interior_length_sd_m": "interior links: spread",
    "junction_place": "place of junctions", "junction_place_delta": "its spread",
    "headward_reach": "share of the way to the divide", "headward_reach_delta": "its spread",
    "valley_side_deg": "valley sides", "valley_side_delta_deg": "their spread",
    "lower_obtuse": "lower thirds: obtuse side", "middle_opposite": "middle thirds: opposite side",
    "upper_obtuse": "upper thirds: obtuse side", "flint_p": "gradient of exterior links (Flint p)",
    "flint_q": "its exponent (Flint q)", "junction_angle_deg": "junction angle",
}


def rows_of(fit):
    """(words, grown over measured, its spread) of every measure that both have."""
    rows = []
    for row in fit.get("check", []):
        measured, mean, spread = row["measured"], row["grown_mean"], row["grown_sd"]
        if measured and mean is not None:
            rows.append((WORDS.get(row["measure"], row["measure"]), mean / measured, abs((spread or 0) / measured)))
    return rows


def draw_check(axes, fit):
    rows = rows_of(fit)
    for place, (_, ratio, spread) in enumerate(rows):
        axes.plot([ratio - 2 * spread, ratio + 2 * spread], [place, place], color=style.SYNTHETIC, linewidth=1.2)
        axes.plot(ratio, place, color=style.SYNTHETIC, marker="^", markersize=4, linestyle="none")
    axes.axvline(1, color=style.REAL, linewidth=1.2)
    axes.set_yticks(range(len(rows)), [words for words, _, _ in rows])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlabel("grown over measured (mean of 20 networks, bars: two standard deviations of one)")
    axes.grid(axis="y", visible=False)


def check(fit):
    drawing = style.figure(4.0)
    axes = drawing.add_subplot()
    links = get(fit, "growth.channel_maintenance_m.count")
    axes.set_title(f"Networks grown with the fitted dials, beside the measured one ({links} links)")
    draw_check(axes, fit)
    return drawing
