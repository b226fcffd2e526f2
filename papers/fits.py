# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves through a few points, and how far two series of numbers are apart."""
import numpy as np


def power_by_logarithms(x, y):
    """(a, b) of y = a·x^b by least squares of ln y: every point counts by its ratio to the curve."""
    b, ln_a = np.polyfit(np.log(x), np.log(y), 1)
    return float(np.exp(ln_a)), float(b)


def power_by_values(x, y):
    """(a, b) of y = a·x^b by least squares of y itself: large y decide. For each b the best a is known, so b is searched on
    a grid that is refined until it is 1e-6 wide."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    scaled = x / np.exp(np.mean(np.log(x)))
    middle, width = power_by_logarithms(scaled, y)[1], 2.0
    while width > 1e-6:
        exponents = middle + width * np.linspace(-1, 1, 41)
        powers = scaled[None, :] ** exponents[:, None]
        factors = (powers @ y) / np.sum(powers**2, axis=1)
        middle = exponents[np.argmin(np.sum((y - factors[:, None] * powers) ** 2, axis=1))]
        width /= 10
    power = x**middle
    return float((power @ y) / (power @ power)), float(middle)


def line(x, y):
    """(slope, intercept, r²) by least squares."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    slope, intercept = np.polyfit(x, y, 1)
    residual = y - (slope * x + intercept)
    return float(slope), float(intercept), float(1 - residual @ residual / np.sum((y - y.mean())**2))


def log_distance(ours, theirs):
    """Root mean square of ln(ours/theirs)."""
    return float(np.sqrt(np.mean(np.log(np.asarray(ours, float) / np.asarray(theirs, float))**2)))
