# SPDX-License-Identifier: GPL-3.0-or-later
"""What was measured on a network beside what networks measure that were grown with the dials found for it."""
import style
from data import get

#: measure: what it is, its unit
WORDS = {
    "links": ("number of links", ""), "channel_maintenance_m": ("basin area per channel length, C", "m"),
    "exterior_length_m": ("exterior links: mean length", "m"),
    "exterior_length_sd_m": ("exterior links: standard deviation", "m"),
    "interior_length_m": ("interior links: mean length", "m"),
    "interior_length_sd_m": ("interior links: standard deviation", "m"),
    "junction_place": ("junctions: place along the stream", "–"), "junction_place_delta": ("junctions: spread of the place", "–"),
    "headward_reach": ("sources: share of the way to the divide", "–"),
    "headward_reach_delta": ("sources: spread of that share", "–"),
    "valley_side_deg": ("valley sides: mean slope", "°"), "valley_side_delta_deg": ("valley sides: spread of the slope", "°"),
    "farthest_ridges_m": ("farthest ridges from their channel", "m"),
    "lower_obtuse": ("lower thirds: tributaries on the obtuse side", "–"),
    "middle_opposite": ("middle thirds: on the other side than the next", "–"),
    "upper_obtuse": ("upper thirds: tributaries on the obtuse side", "–"),
    "flint_p": ("gradient of exterior links, Flint’s p", "m/m"), "flint_q": ("Flint’s exponent q", "–"),
    "divide_across": ("divide across from a tributary: share of the angle", "–"),
    "divide_across_delta": ("divide across from a tributary: spread", "–"),
    "divide_below": ("divide below a tributary: share of the angle", "–"),
    "divide_below_delta": ("divide below a tributary: spread", "–"),
    "divide_above": ("divide above a tributary: share of the angle", "–"),
    "divide_above_delta": ("divide above a tributary: spread", "–"),
    "junction_angle_deg": ("angle between two inflows", "°"),
}


#: dial: what it is, its unit
DIALS = {
    "channel_maintenance_m": ("basin area per channel length, C", "m"),
    "flint_p": ("gradient of exterior links, Flint’s p", "m/m"), "flint_q": ("Flint’s exponent q", "–"),
    "mean_junction": ("place of a tributary on its link", "–"), "delta_junction": ("its spread", "–"),
    "mean_length": ("length of a tributary, 1: to the divide", "–"), "delta_length": ("its spread", "–"),
    "sidewall_angle_deg": ("slope of valley sides", "°"), "delta_sidewall_angle_deg": ("its spread", "°"),
    "sidewall_reach_m": ("reach of valley sides", "m"),
    "lower_bias": ("lower thirds: share of tributaries on the obtuse side", "–"),
    "middle_bias": ("middle thirds: share on the other side than the next", "–"),
    "divide_across": ("divide across from a tributary: share of the angle", "–"), "delta_divide_across": ("its spread", "–"),
    "divide_below": ("divide below a tributary: share of the angle", "–"), "delta_divide_below": ("its spread", "–"),
    "divide_above": ("divide above a tributary: share of the angle", "–"), "delta_divide_above": ("its spread", "–"),
}


def words_of(row):
    """What a measure is, and what the real network has."""
    words, unit = WORDS.get(row["measure"], (row["measure"].replace("_", " "), ""))
    space = "" if unit in ("", "–", "°") else " "
    value = row["measured"]
    shown = f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"
    return f"{words} ({shown}{space}{'' if unit == '–' else unit})".replace("(-", "(−")


def rows_of(fit):
    """(words, grown over measured, its spread) of every measure that both have."""
    rows = []
    for row in fit.get("check", []):
        measured, mean, spread = row["measured"], row["grown_mean"], row["grown_sd"]
        if measured and mean is not None:
            rows.append((words_of(row), mean / measured, abs((spread or 0) / measured)))
    return rows


def draw_check(axes, fit):
    rows = rows_of(fit)
    for place, (_, ratio, spread) in enumerate(rows):
        axes.plot([ratio - 2 * spread, ratio + 2 * spread], [place, place], color=style.SYNTHETIC, linewidth=1.2)
        axes.plot(ratio, place, color=style.SYNTHETIC, marker="^", markersize=4, linestyle="none")
    axes.axvline(1, color=style.REAL, linewidth=1.2)
    axes.set_yticks(range(len(rows)), [words for words, _, _ in rows])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlabel("Grown over measured (–): mean of 20 networks; bars: two standard deviations of one", loc="right")
    axes.grid(axis="y", visible=False)


def check(fit):
    drawing = style.figure(0.9 + 0.19 * len(rows_of(fit)))
    axes = drawing.add_subplot()
    links = get(fit, "growth.channel_maintenance_m.count")
    axes.set_title(f"Networks grown with the fitted dials over the measured one ({links} links; its values in brackets)",
                   loc="right")
    draw_check(axes, fit)
    return drawing
