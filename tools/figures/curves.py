# SPDX-License-Identifier: GPL-3.0-or-later
"""Hypsometric, slope–area, Horton and history plots. Each `draw_…` fills given axes; each other function is a figure."""
import textwrap
from dataclasses import dataclass, field

import numpy as np
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter, NullLocator

import style
from data import columns, get

CLOUD_POINTS = 12000


@dataclass
class Side:
    """One terrain's numbers, ready to be drawn."""
    label: str
    look: dict
    terrain: dict = field(default_factory=dict)      # keys of the summary
    hypsometry: tuple = ((), ())                     # relative area, relative height
    cloud: tuple = ((), (), None)                    # area m², slope, length m (None: all count alike)
    bins: tuple = ((), (), ())                       # area m², slope, standard error


def absent(axes, sentence):
    """Says in the plot's place why there is none."""
    axes.text(0.5, 0.5, sentence, transform=axes.transAxes, ha="center", va="center", color=style.MUTED, wrap=True)
    axes.grid(False)


def label_decades(axis):
    """Labels powers of ten, or 1, 2 and 5 of each decade where an axis spans fewer than two and would be left bare."""
    low, high = axis.get_view_interval()
    bare = low > 0 and high / low < 100
    if bare:
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}" if bare else _power_of_ten(value)))
    axis.set_minor_formatter(NullFormatter())


RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def _power_of_ten(value):
    return "10" + f"{np.log10(value):.0f}".translate(RAISED) if value > 0 else ""


def draw_hypsometry(axes, sides):
    """Share of the area that lies above each relative height (Strahler 1952)."""
    drawn = False
    for side in sides:
        area, height = side.hypsometry
        if len(area) < 2:
            continue
        integral = get(side.terrain, "hypsometry.integral")
        label = side.label if integral is None else f"{side.label}: integral {integral:.3f}"
        axes.plot(area, height, color=side.look["color"], linestyle=side.look["linestyle"], label=label)
        if len(sides) == 1:
            axes.fill_between(area, height, color=side.look["color"], alpha=0.10, linewidth=0)
        drawn = True
    axes.set(xlim=(0, 1), ylim=(0, 1), xlabel="Relative area above, a/A (–)",
             ylabel="Relative height, (h − min) / (max − min) (–)", aspect="equal")
    if drawn:
        axes.legend(loc="upper right")
    else:
        absent(axes, "no hypsometric curve")


def draw_slope_area(axes, side, fit=None, regression=None, theory=None, remark=""):
    """Cloud, bins with their standard errors, and what is known of the law: fit and regression as (curve, label), the
    given one as areas and slopes; `remark` stands in the lower left corner."""
    _draw_cloud(axes, side)
    _draw_bins(axes, side)
    if fit is not None:
        draw_fitted_line(axes, fit, side.look["color"])
    if regression is not None:
        (area, slope), label = regression
        axes.plot(area, slope, color=style.INK if fit is None else side.look["color"], linewidth=1.2,
                  linestyle=(0, (4, 3)), zorder=5, label=label)
    if remark:
        axes.text(0.015, 0.015, textwrap.fill(remark, 44), transform=axes.transAxes, ha="left", va="bottom", fontsize=6.5,
                  color=style.MUTED, zorder=7)
    if theory is not None:
        axes.plot(theory[0], theory[1], color=style.THEORY, linewidth=1.0, linestyle=(0, (1, 1.2)), zorder=5,
                  label="steady state, (u/k)$^{1/n}$ A$^{−m/n}$")
    axes.set(xscale="log", yscale="log", xlabel="Drainage area (m²)", ylabel="Slope (m/m)")
    if len(side.cloud[0]) or len(side.bins[0]):
        axes.legend(loc="upper right").set_zorder(8)  # slopes fall with area: there it hides least
        for axis in (axes.xaxis, axes.yaxis):
            label_decades(axis)
    else:
        axes.set(xlim=(1e4, 1e8), ylim=(1e-3, 1))
        absent(axes, "no slopes measured")


def _draw_cloud(axes, side):
    """Dots; where each has its length, their area is in proportion to it, as is their weight in the bins' means."""
    area, slope = (np.asarray(values, dtype=float) for values in side.cloud[:2])
    usable = (area > 0) & (slope > 0)
    stride = 1 + np.count_nonzero(usable) // CLOUD_POINTS
    chosen = np.flatnonzero(usable)[::stride]
    if chosen.size == 0:
        return
    opacity = float(np.clip(1500 / chosen.size, 0.2, 0.65))
    size = 4.4 if chosen.size < 3000 else 1.8
    if side.cloud[2] is not None:
        length = np.nan_to_num(np.asarray(side.cloud[2], dtype=float)[chosen])
        size = np.clip(size * length / (np.mean(length) or 1), 0.8, 60)
    axes.scatter(area[chosen], slope[chosen], s=size, linewidths=0, color=side.look["color"], alpha=opacity,
                 rasterized=True, zorder=2)


def _draw_bins(axes, side):
    area, slope, error = (np.asarray(values, dtype=float) for values in side.bins)
    if area.size == 0:
        return
    known = np.isfinite(error)
    low = np.minimum(error[known], 0.95 * slope[known])
    axes.errorbar(area[known], slope[known], yerr=[low, error[known]], linestyle="none",
                  marker=side.look["marker"], markersize=4.2, markerfacecolor="white", markeredgewidth=1.0,
                  color=side.look["color"], elinewidth=0.9, capsize=0, zorder=6, label=f"{side.label}: bin means ± 1 s.e.")
    if not known.all():
        axes.plot(area[~known], slope[~known], linestyle="none", marker="x", markersize=4.2, markeredgewidth=1.0,
                  color=side.look["color"], zorder=6, label="bin of one piece: error not known")


def fitted_curve(fit, table):
    """The fitted line and its 95 % band, as area, slope, low, high; None without a fit.

    At the fit's reference area (the weighted mean of ln A) the line's level and its slope θ are uncorrelated, so that the
    half widths of their 95 % intervals add as squares.
    """
    area, fitted = (np.asarray(table.get(name, ()), dtype=float) for name in ("area_m2", "fitted_slope"))
    usable = (area > 0) & (fitted > 0)
    if fit.get("theta") is None or usable.sum() < 2:
        return None
    order = np.argsort(area[usable])
    log_area, log_slope = np.log(area[usable])[order], np.log(fitted[usable])[order]
    count = np.asarray(table.get("count", np.ones(area.size)), dtype=float)[usable][order]
    middle = fit.get("reference_area_m2")
    centre = np.log(middle) if middle else np.average(log_area, weights=count)
    steepness = _half_width(fit, "theta")
    level = _level_half_width(fit, steepness * np.sqrt(np.average((log_area - centre)**2, weights=count)))
    x = np.linspace(log_area[0], log_area[-1], 60)
    line = np.interp(x, log_area, log_slope)
    half = np.hypot(level, steepness * (x - centre))
    return np.exp(x), np.exp(line), np.exp(line - half), np.exp(line + half)


def _half_width(fit, key):
    low, high = fit.get(key + "_ci95") or (None, None)
    return 0.5 * (high - low) if low is not None and high is not None else 1.96 * (fit.get(key + "_se") or 0.0)


def _level_half_width(fit, otherwise):
    """Half width of ln S at the reference area: that of ln(k·A0^m)/n, as long as the error of the uplift is not in it."""
    low, high = fit.get("k_at_reference_area_ci95") or (None, None)
    if fit.get("uplift_sd_m_per_yr") or not (low and high and fit.get("n")):
        return otherwise
    return 0.5 * np.log(high / low) / fit["n"]


def draw_fitted_line(axes, fit, color):
    """`fit`: (curve of `fitted_curve`, label)."""
    (area, slope, low, high), label = fit
    axes.fill_between(area, low, high, color=color, alpha=0.18, linewidth=0, zorder=3)
    axes.plot(area, slope, color=style.INK, linewidth=1.3, zorder=4, label=label)


def law_label(name, theta, error):
    """The legend's words for S ∝ A^−θ; `name` tells the robust "fit" from the plain "regression"."""
    if theta is None:
        return name
    if not error:
        return f"{name}: θ = {theta:.3f}"
    return f"{name}: θ = {theta:.3f} ± " + (f"{error:.3f}" if error >= 0.0005 else "< 0.001")


def summary_line(side):
    """The slope–area law of a summary as a curve over its bins (no band); None when it has none."""
    theta, ks = get(side.terrain, "slope_area.theta"), get(side.terrain, "slope_area.ks")
    area = np.asarray(side.bins[0], dtype=float)
    if theta is None or ks is None or area.size < 2:
        return None
    x = np.geomspace(np.nanmin(area), np.nanmax(area), 2)
    return (x, ks * x**-theta), law_label("regression", theta, get(side.terrain, "slope_area.theta_se"))


def fitted_line(fit, table):
    """The law of fit.json as a curve with its band and label; None when there is none."""
    curve = fitted_curve(fit, table)
    return curve and (curve, law_label("fit", fit.get("theta"), fit.get("theta_se")))


HORTON = (("streams", "Number of streams", "RB", "$R_B$"), ("mean_length_m", "Mean length (km)", "RL", "$R_L$"),
          ("mean_area_m2", "Mean drainage area (km²)", "RA", "$R_A$"), ("mean_slope", "Mean slope (m/m)", "RS", "$R_S$"))
HORTON_SCALE = {"mean_length_m": 1e-3, "mean_area_m2": 1e-6}


def draw_horton(axes, sides, key, label, ratio, symbol):
    """One of Horton's laws: the statistic of each order with its regression line and ratio."""
    top = 1
    for side in sides:
        order, value = columns(side.terrain.get("strahler"), "order", key)
        value = value * HORTON_SCALE.get(key, 1)
        usable = np.isfinite(order) & (value > 0)
        if not usable.any():
            continue
        order, value = order[usable], value[usable]
        top = max(top, int(order.max()))
        number = get(side.terrain, f"horton.{ratio}.regression")
        text = side.label if number is None else f"{side.label}: {symbol} = {number:.2f}"
        if order.size == 2:
            text += " (two orders only)"
        axes.plot(order, value, linestyle="none", marker=side.look["marker"], markersize=4.5, markerfacecolor="white",
                  markeredgewidth=1.1, color=side.look["color"], label=text, zorder=3)
        if order.size > 1:
            line = np.polyfit(order, np.log(value), 1)
            axes.plot(order, np.exp(np.polyval(line, order)), color=side.look["color"], linewidth=0.9,
                      linestyle=side.look["linestyle"])
    axes.set(yscale="log", xlabel="Strahler order (–)", ylabel=label, xlim=(0.7, top + 0.3))
    axes.xaxis.set_major_locator(FixedLocator(range(1, top + 1)))
    axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_locator(NullLocator())
    if axes.lines:
        axes.legend(loc="best")
    else:
        axes.set_yticks([])
        absent(axes, "no streams")


def draw_horton_panels(axes, sides):
    for axis, (key, label, ratio, symbol) in zip(np.ravel(axes), HORTON):
        draw_horton(axis, sides, key, label, ratio, symbol)


def draw_history(height_axes, rate_axes, history):
    """Heights and rates of change against time (or against the step, where a run has no time)."""
    time = np.asarray(history.get("time_yr", ()), dtype=float) / 1e6
    label = "Time (Myr)"
    if time.size == 0 or not np.isfinite(time).all() or np.ptp(time) == 0:
        time, label = np.asarray(history.get("step", ()), dtype=float), "Sweep of the steady solver (–)"
    for name, word, line in (("elevation_max_m", "highest", "-"), ("elevation_mean_m", "mean", (0, (5, 1.6)))):
        if name in history and time.size:
            height_axes.plot(time, history[name], color=style.SYNTHETIC, linestyle=line, label=word)
    drawn = [_draw_rate(rate_axes, time, history.get(name), word, line)
             for name, word, line in (("max_rate_m_per_yr", "largest", "-"), ("mean_rate_m_per_yr", "mean", (0, (5, 1.6))))]
    if any(drawn):
        rate_axes.set_yscale("log")
        label_decades(rate_axes.yaxis)
        _legend_above(rate_axes)
    else:
        absent(rate_axes, "no rates of change recorded")
    height_axes.set(ylabel="Elevation (m)", xlabel=label)
    rate_axes.set(ylabel="Rate of change (mm/yr)", xlabel=label)
    if time.size:
        _legend_above(height_axes)
    else:
        absent(height_axes, "no history recorded")


def _legend_above(axes):
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncol=2, borderaxespad=0.2)


def _draw_rate(axes, time, rate, word, line):
    """True where there was something to draw on a logarithmic axis."""
    rate = np.asarray(rate if rate is not None else (), dtype=float) * 1000
    usable = rate > 0
    if not usable.any():
        return False
    axes.plot(time[usable], rate[usable], color=style.SYNTHETIC, linestyle=line, label=word)
    return True


def hypsometry(sides):
    drawing = style.figure(3.6, 3.6)
    draw_hypsometry(drawing.add_subplot(), sides)
    return drawing


def slope_area(side, fit=None, regression=None, theory=None, remark=""):
    drawing = style.figure(3.6, 4.8)
    draw_slope_area(drawing.add_subplot(), side, fit, regression, theory, remark)
    return drawing


def slope_area_pair(sides, titles, fit=None, theory=None, remark=""):
    """Side by side with shared axes, so that level and slope can be compared by eye, each with its regression; `fit`
    belongs to the first, `theory` and `remark` to the second."""
    drawing = style.figure(3.3)
    axes = drawing.subplots(1, 2, sharex=True, sharey=True)
    draw_slope_area(axes[0], sides[0], fit, summary_line(sides[0]))
    draw_slope_area(axes[1], sides[1], None, summary_line(sides[1]), theory, remark)
    for axis, title in zip(axes, titles):
        axis.set_title(title)
    axes[1].set_ylabel("")
    return drawing


def horton(sides):
    drawing = style.figure(4.6)
    draw_horton_panels(drawing.subplots(2, 2), sides)
    return drawing


def history(table):
    drawing = style.figure(2.7)
    draw_history(*drawing.subplots(1, 2), table)
    return drawing
