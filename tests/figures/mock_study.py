# SPDX-License-Identifier: GPL-3.0-or-later
"""A small made-up study in the files and keys of the commands: numbers are plausible, not computed by Thalweg."""
import json
import os

import numpy as np
from osgeo import gdal, ogr, osr

gdal.UseExceptions()
ogr.UseExceptions()
NEIGHBOURS = [(0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1)]


def hills(rows, cols):
    """A smooth surface that falls to the south with valleys in it; no data in one corner."""
    y, x = np.mgrid[0:rows, 0:cols]
    z = 200 + 6.0 * (rows - y) + 25 * np.cos(x / 5.0) * (1 - y / (2 * rows)) + 3 * np.sin(x * 1.7 + y * 0.9)
    z[: rows // 6, : cols // 6] = np.nan
    return z


def route(z, cell):
    """Steepest receivers (own index where lower neighbours are missing) and drainage area in cells, high to low."""
    rows, cols = z.shape
    padded = np.pad(z, 1, constant_values=np.nan)
    best, receiver = np.zeros(z.shape), np.arange(z.size).reshape(z.shape)
    for dr, dc in NEIGHBOURS:
        other = padded[1 + dr:1 + dr + rows, 1 + dc:1 + dc + cols]
        slope = (z - other) / (cell * np.hypot(dr, dc))
        better = slope > best
        receiver[better] = (np.arange(z.size).reshape(z.shape) + dr * cols + dc)[better]
        best[better] = slope[better]
    receiver = receiver.ravel()
    area = np.isfinite(z).ravel().astype(float)
    for node in np.argsort(-np.nan_to_num(z.ravel(), nan=-1e9), kind="stable"):
        if receiver[node] != node:
            area[receiver[node]] += area[node]
    return receiver, area, best.ravel()


def links(receiver, area, threshold):
    """Node lists from sources and junctions down to the next junction, with Strahler orders."""
    channel = np.flatnonzero(area >= threshold)
    donors = {}
    for node in channel:
        if receiver[node] != node:
            donors.setdefault(receiver[node], []).append(node)
    order = {}
    for node in channel[np.argsort(area[channel], kind="stable")]:
        up = sorted((order.get(d, 1) for d in donors.get(node, [])), reverse=True)
        order[node] = 1 if not up else up[0] + (len(up) > 1 and up[0] == up[1])
    found = []
    for node in channel:
        if len(donors.get(node, [])) == 1:
            continue
        line = [node]
        while receiver[line[-1]] != line[-1] and (len(line) == 1 or len(donors.get(line[-1], [])) == 1):
            line.append(receiver[line[-1]])
        if len(line) > 1:
            found.append((line, order[node]))
    return found


def write_raster(path, z, origin, step, crs):
    rows, cols = z.shape
    dataset = gdal.GetDriverByName("GTiff").Create(path, cols, rows, 1, gdal.GDT_Float64, ["TILED=YES"])
    dataset.SetGeoTransform((origin[0], step, 0, origin[1], 0, -step))
    dataset.SetSpatialRef(crs)
    dataset.GetRasterBand(1).SetNoDataValue(float("nan"))
    dataset.GetRasterBand(1).WriteArray(z)


def write_network(path, rivers, shape, origin, step, crs, cell):
    source = ogr.GetDriverByName("GPKG").CreateDataSource(path)
    layer = source.CreateLayer("links", crs, ogr.wkbLineString)
    for name, kind in (("strahler", ogr.OFTInteger), ("length_m", ogr.OFTReal)):
        layer.CreateField(ogr.FieldDefn(name, kind))
    for line, order in rivers:
        feature, geometry = ogr.Feature(layer.GetLayerDefn()), ogr.Geometry(ogr.wkbLineString)
        for node in line:
            row, col = divmod(int(node), shape[1])
            geometry.AddPoint_2D(origin[0] + (col + 0.5) * step, origin[1] - (row + 0.5) * step)
        feature.SetGeometry(geometry)
        feature["strahler"], feature["length_m"] = int(order), 1.15 * cell * (len(line) - 1)
        layer.CreateFeature(feature)
    basins = source.CreateLayer("basins", crs, ogr.wkbPolygon)
    basins.CreateField(ogr.FieldDefn("area_m2", ogr.OFTReal))
    feature = ogr.Feature(basins.GetLayerDefn())
    corners = [(2, 2), (shape[1] - 2, 2), (shape[1] - 2, shape[0] - 2), (2, shape[0] - 2), (2, 2)]
    text = ", ".join(f"{origin[0] + c * step} {origin[1] - r * step}" for c, r in corners)
    feature.SetGeometry(ogr.CreateGeometryFromWkt(f"POLYGON (({text}))"))
    feature["area_m2"] = shape[0] * shape[1] * cell**2
    basins.CreateFeature(feature)


def bins(area, slope):
    number = np.floor(10 * np.log10(area)).astype(int)
    result = []
    for each in np.unique(number):
        logs = np.log(slope[number == each])
        if logs.size > 2:
            mean = float(np.exp(logs.mean()))
            result.append({"area_m2": float(np.exp(np.log(area[number == each]).mean())), "slope": mean,
                           "slope_se": mean * float(logs.std() / np.sqrt(logs.size)), "count": int(logs.size)})
    return result


def write_csv(path, **table):
    with open(path, "w", encoding="utf-8") as stream:
        stream.write(",".join(table) + "\n")
        for row in zip(*table.values()):
            stream.write(",".join(f"{value!r}" if np.isfinite(value) else "" for value in map(float, row)) + "\n")


def write_json(path, content):
    with open(path, "w", encoding="utf-8") as stream:
        json.dump(content, stream, indent=1)


def terrain_summary(z, rivers, area, slope, cell):
    height = np.linspace(0, 1, 51)
    relative = np.sort((z[np.isfinite(z)] - np.nanmin(z)) / (np.nanmax(z) - np.nanmin(z)))
    share = 1 - np.searchsorted(relative, height) / relative.size
    top = max((order for _, order in rivers), default=1)
    strahler = [{"order": o, "streams": max(1, round(3.9 ** (top - o))), "mean_length_m": 300.0 * 2.1**o,
                 "mean_area_m2": 1e5 * 4.2**o, "mean_slope": 0.3 / 1.7**o, "mean_drop_m": 40.0}
                for o in range(1, top + 1)]
    ratio = {"regression": 3.9, "mean_ratio": 4.0}
    table = bins(area, slope)
    theta, level = (-np.polyfit(np.log([b["area_m2"] for b in table]), np.log([b["slope"] for b in table]), 1)
                    * [1, -1] if len(table) > 1 else (None, None))
    return {
        "hypsometry": {"integral": float(relative.mean()), "integral_by_curve": float(relative.mean()),
                       "skewness": 0.31, "kurtosis": 2.4, "relative_area": list(map(float, share)),
                       "relative_height": list(map(float, height))},
        "channels": {"threshold_area_m2": 40 * cell**2, "share_used": 0.8, "cells": int(sum(len(r) for r, _ in rivers)),
                     "sources": len(rivers) // 2 + 1, "links": len(rivers), "junctions": len(rivers) // 2, "outlets": 3,
                     "total_length_m": 1.15 * cell * sum(len(r) for r, _ in rivers), "drainage_density_per_m": 0.0021,
                     "constant_of_channel_maintenance_m": 476.2, "max_strahler": int(top), "max_shreve": 40},
        "strahler": strahler,
        "horton": {"RB": ratio, "RL": {"regression": 2.1, "mean_ratio": 2.0}, "RA": {"regression": 4.2, "mean_ratio": 4.1},
                   "RS": {"regression": None, "mean_ratio": None}},
        "slope_area": {"theta": theta if theta is None else float(theta), "theta_se": 0.012,
                       "theta_ci95": None if theta is None else [float(theta) - 0.024, float(theta) + 0.024],
                       "ks": None if level is None else float(np.exp(level)), "ks_se": None, "r2": 0.93, "bins": table},
        "basins": [],
        "notes": {"horton.RS": "slopes of the highest order are not known", "slope_area.ks_se": "made up"},
    }


def write_terrain(folder, raster, z, origin, step, crs, cell, threshold):
    """The files that analyze and simulate share; returns the terrain's summary and its slope–area bins."""
    os.makedirs(folder, exist_ok=True)
    receiver, cells, slope = route(z, cell)
    rivers = links(receiver, cells, threshold)
    used = (cells >= threshold) & (slope > 0)
    area, slope = cells[used] * cell**2, slope[used]
    summary = terrain_summary(z, rivers, area, slope, cell)
    write_raster(os.path.join(folder, raster), z, origin, step, crs)
    write_network(os.path.join(folder, "network.gpkg"), rivers, z.shape, origin, step, crs, cell)
    curve, table = summary["hypsometry"], summary["slope_area"]["bins"]
    write_csv(os.path.join(folder, "hypsometry.csv"), relative_height=curve["relative_height"],
              relative_area=curve["relative_area"])
    write_csv(os.path.join(folder, "slope_area.csv"), **{k: [b[k] for b in table] for k in
                                                         ("area_m2", "slope", "slope_se", "count")})
    points = "slope_area_points.csv" if raster == "filled.tif" else "slope_area_nodes.csv"
    weight = {"talus_limited": np.zeros(area.size)} if raster == "elevation.tif" else {"length_m": 10 / slope}
    write_csv(os.path.join(folder, points), area_m2=area, slope=slope, **weight)
    return summary


EXPERIMENT = """seed = 7
[domain]
dem = "hills.tif"
[uplift]
rate_m_per_yr = 1e-4
[river]
k = 1e-6
m = 0.45
n = 1.0
"""


def write_study(folder, z=None, synthetic=None, origin=(-84.3, 36.6), step=1 / 1200, cell=80.0, threshold=40):
    """The folder of a whole study."""
    z = hills(60, 80) if z is None else z
    synthetic = np.where(np.isfinite(z), 0.8 * z + 40, np.nan) if synthetic is None else synthetic
    crs = osr.SpatialReference()
    crs.ImportFromEPSG(4326)
    crs.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    place = dict(origin=origin, step=step, crs=crs, cell=cell, threshold=threshold)
    real = write_terrain(os.path.join(folder, "measure"), "filled.tif", z, **place)
    made = write_terrain(os.path.join(folder, "simulate"), "elevation.tif", synthetic, **place)
    write_terrain(os.path.join(folder, "basin"), "filled.tif", z, **place)
    remade = write_terrain(os.path.join(folder, "synthetic"), "filled.tif", synthetic, **place)
    valid = int(np.isfinite(z).sum())
    real["input"] = {"file": "hills.tif", "sha256": "0" * 64, "crs": "EPSG:4326 (WGS 84)", "geographic": True,
                     "rows": z.shape[0], "cols": z.shape[1], "dx_m": cell, "dy_m": cell, "valid_cells": valid,
                     "nodata_cells": int(z.size - valid), "area_m2": valid * cell**2,
                     "elevation_min_m": float(np.nanmin(z)), "elevation_max_m": float(np.nanmax(z)),
                     "elevation_mean_m": float(np.nanmean(z))}
    real["conditioning"] = {"method": "fill", "pits": 12, "cells_changed": 40, "volume_m3": 1.2e6, "flat_cells": 9}
    remade["input"] = {**real["input"], "file": "elevation.tif", "elevation_min_m": float(np.nanmin(synthetic)),
                       "elevation_max_m": float(np.nanmax(synthetic)), "elevation_mean_m": float(np.nanmean(synthetic))}
    for step, summary in (("measure", real), ("basin", real), ("synthetic", remade)):
        write_json(os.path.join(folder, step, "summary.json"), summary)
    write_simulation(os.path.join(folder, "simulate"), made, synthetic, valid * cell**2)
    write_fit(os.path.join(folder, "fit"), real["slope_area"])
    write_comparison(os.path.join(folder, "compare"), real, made)
    with open(os.path.join(folder, "experiment.toml"), "w", encoding="utf-8") as stream:
        stream.write(EXPERIMENT)
    write_json(os.path.join(folder, "manifest.json"), {
        "program": "thalweg", "version": "0.1.0", "commit": "0123abc", "command": ["thalweg", "run", "hills.toml"],
        "seed": 7, "inputs": [{"file": "hills.tif", "sha256": "0" * 64}], "libraries": {"GDAL": "3.6.2"}})


def write_simulation(folder, terrain, z, area):
    terrain["measured_on"] = "mesh"
    write_json(os.path.join(folder, "summary.json"), {
        "nodes": int(np.isfinite(z).sum()), "steps": 200, "time_yr": 2e7, "converged": True,
        "stop_reason": "mean rate below 1e-3 of the uplift", "max_rate_m_per_yr": 3e-8, "mean_rate_m_per_yr": 1e-8,
        "frozen_receivers": 0, "domain_area_m2": area, "cell_area_sum_m2": area, "elevation_max_m": float(np.nanmax(z)),
        "elevation_mean_m": float(np.nanmean(z)), "lakes_final": 0,
        "mass_balance": {"uplifted_m3": 1e9, "eroded_m3": 9e8, "relative_residual": 3e-14},
        "seconds": {"total": 1.0}, "terrain": terrain, "notes": {}})
    step = np.arange(1, 41)
    write_csv(os.path.join(folder, "history.csv"), step=step, time_yr=step * 5e5,
              elevation_max_m=900 * (1 - np.exp(-step / 8)), elevation_mean_m=400 * (1 - np.exp(-step / 6)),
              max_rate_m_per_yr=1e-4 * np.exp(-step / 4))
    with open(os.path.join(folder, "experiment.toml"), "w", encoding="utf-8") as stream:
        stream.write(EXPERIMENT)


def write_fit(folder, law):
    os.makedirs(folder, exist_ok=True)
    table = law["bins"]
    write_json(os.path.join(folder, "fit.json"), {
        "method": "slope-area", "n": 1.0, "uplift_m_per_yr": 1e-4, "uplift_sd_m_per_yr": 0, "k": 1.1e-6,
        "k_unit": "m^(1-2m)/yr", "k_se": 2e-7, "k_ci95": [7e-7, 1.5e-6], "reference_area_m2": 3e6,
        "k_at_reference_area": 9e-4, "k_at_reference_area_se": 2e-5, "m": law["theta"], "m_se": law["theta_se"],
        "m_ci95": law["theta_ci95"], "area_range_m2": [2.6e5, 1e7], "steady_check": None, "theta": law["theta"],
        "theta_se": law["theta_se"], "ks": law["ks"], "correlation_log_k_m": -0.98, "reduced_chi2": 1.4, "iterations": 6,
        "converged": True, "message": "gradient below tolerance", "identifiable": ["k", "m"],
        "notes": {"steady_check": "one DEM cannot tell whether uplift and incision balance"}})
    write_csv(os.path.join(folder, "fit.csv"), area_m2=[b["area_m2"] for b in table], slope=[b["slope"] for b in table],
              slope_se=[b["slope_se"] for b in table],
              fitted_slope=[law["ks"] * b["area_m2"] ** -law["theta"] for b in table])


def write_comparison(folder, real, made):
    os.makedirs(folder, exist_ok=True)
    aspects = [{"name": name, "a": a, "b": b, "distance": d, "scale": None, "verdict": None,
                "distance_definition": "root mean square of ln(ratio of a / ratio of b)"} for name, a, b, d in
               (("slope_area", 0.44, 0.45, 0.06), ("hypsometry", 0.41, 0.47, 0.061), ("horton", None, None, 0.2))]
    write_json(os.path.join(folder, "comparison.json"), {
        "aspects": aspects, "a": {"name": "hills.tif", "terrain": real}, "b": {"name": "simulate", "terrain": made},
        "notes": {"scale": "the model's own spread is not measured yet"}})


def write_growth(folder):
    """What a study by network growth adds to a whole study: a terrain on a plane of its own."""
    z = hills(50, 70) + 10
    for step, raster in (("grow", "elevation.tif"), ("grown", "filled.tif")):
        summary = write_terrain(os.path.join(folder, step), raster, z, (-2000.0, 1500.0), 80.0, None, 80.0, 40)
        summary["input"] = {"area_m2": 2e7, "elevation_min_m": float(np.nanmin(z)), "elevation_max_m": float(np.nanmax(z))}
        write_json(os.path.join(folder, step, "summary.json"), {"links": 77, **summary})
    for step in ("growth_fit", "compare_grown"):
        os.makedirs(os.path.join(folder, step))
    dial = {"estimate": 1067.0, "standard_error": 34.0, "ci95": [999.0, 1134.0], "count": 163, "identified": True}
    write_json(os.path.join(folder, "growth_fit", "fit.json"), {
        "method": "growth", "growth": {"channel_maintenance_m": dial}, "check": [
            {"measure": "divide_across_delta", "measured": 0.27, "grown_mean": 0.28, "grown_sd": 0.02}]})
    write_json(os.path.join(folder, "compare_grown", "comparison.json"), {
        "realisations": 20, "notes": [], "aspects": [{"name": "hypsometry", "a": 0.26, "b": 0.24, "distance": 0.083,
                                                      "scale": 0.052, "verdict": "within the model's own scatter"}]})
