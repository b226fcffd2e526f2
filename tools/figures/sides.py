# SPDX-License-Identifier: GPL-3.0-or-later
"""Gathers one terrain's numbers for the plots from the folder of a command, or from a comparison."""
import os

import numpy as np

import curves
import style
from data import columns, get, read_csv, read_json, read_toml, terrain_of


def from_folder(folder, label, kind):
    """A terrain measured by `analyze` or written by `simulate`; kind is "real" or "synthetic"."""
    terrain = terrain_of(read_json(folder, "summary.json"))
    side = curves.Side(label, style.LOOK[kind], terrain)
    side.hypsometry = _hypsometry(read_csv(folder, "hypsometry.csv"), terrain)
    side.bins = _bins(read_csv(folder, "slope_area.csv"), terrain)
    side.cloud = _cloud(folder)
    return side


def from_comparison(comparison, key, folder, label, kind):
    """Side "a" or "b" of comparison.json: an object with the measures (or with "terrain"), or the path of a folder."""
    content = comparison.get(key)
    path = content if isinstance(content, str) else get(content or {}, "path", "")
    if path and os.path.isdir(os.path.join(folder, path)):
        side = from_folder(os.path.join(folder, path), label, kind)
    else:
        side = curves.Side(label, style.LOOK[kind])
    terrain = terrain_of(content) if isinstance(content, dict) else {}
    if "strahler" in terrain or "slope_area" in terrain or "hypsometry" in terrain:
        side.terrain = terrain
        side.hypsometry = _hypsometry({}, terrain)
        side.bins = _bins({}, terrain)
    return side


def name_of(comparison, key):
    """What the comparison calls its side, shortened to the last part of a path; A or B without a name."""
    content = comparison.get(key)
    name = content if isinstance(content, str) else get(content or {}, "name", "")
    return os.path.basename(str(name).rstrip("/")) or key.upper()


def _hypsometry(table, terrain):
    if "relative_area" in table and "relative_height" in table:
        return table["relative_area"], table["relative_height"]
    area, height = get(terrain, "hypsometry.relative_area", []), get(terrain, "hypsometry.relative_height", [])
    return np.array(area, dtype=float), np.array(height, dtype=float)


def _bins(table, terrain):
    names = ("area_m2", "slope", "slope_se")
    if all(name in table for name in names):
        return tuple(table[name] for name in names)
    return tuple(columns(get(terrain, "slope_area.bins", []), *names))


def _cloud(folder):
    """Mesh nodes where the terrain is a simulation on its own graph (bare rivers only: slopes at the talus limit follow
    another law), else the segments of the carved profile."""
    table = read_csv(folder, "slope_area_nodes.csv") or read_csv(folder, "slope_area_points.csv")
    area, slope = table.get("area_m2", np.array([])), table.get("slope", np.array([]))
    limited = table.get("talus_limited", np.zeros(area.size)) > 0
    length = table.get("length_m")
    return area[~limited], slope[~limited], None if length is None else length[~limited]


def theory(folder, side):
    """Area and slope of the steady state S = (u/k)^(1/n)·A^(−m/n) over the side's areas, or None and the reason: where
    u, k or rain vary from place to place, one area has many steady slopes."""
    experiment = read_toml(folder, "experiment.toml")
    varying = _varying(experiment)
    if varying:
        return None, f"no steady line: {varying} differs from place to place, so one area has many steady slopes"
    river, uplift = experiment.get("river", {}), experiment.get("uplift", {})
    k, m, n, u = river.get("k"), river.get("m"), river.get("n", 1.0), uplift.get("rate_m_per_yr")
    area = np.asarray(side.cloud[0] if len(side.cloud[0]) else side.bins[0], dtype=float)
    area = area[area > 0]
    if area.size == 0 or not all(isinstance(x, (int, float)) and x > 0 for x in (k, m, n, u)):
        return None, ""
    ends = np.array([area.min(), area.max()])
    return (ends, (u / k) ** (1 / n) * ends ** (-m / n)), ""


def _varying(experiment):
    """What the experiment lets differ from place to place, in words; nothing where all is uniform."""
    uplift, rain = experiment.get("uplift", {}), experiment.get("rainfall", {})
    pattern = uplift.get("pattern", "constant")
    if pattern != "constant" or uplift.get("field") or uplift.get("lines"):
        return "uplift" + (f" ({pattern})" if pattern != "constant" else "")
    if experiment.get("river", {}).get("k_field"):
        return "erodibility"
    uneven_rain = rain.get("pattern", "constant") != "constant" or rain.get("field") or rain.get("lines")
    return "rainfall" if uneven_rain else ""
