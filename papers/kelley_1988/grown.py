# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of `thalweg grow` and `thalweg render`, what is read from their files, and plans of grown networks."""
import json
import os
import subprocess
from xml.etree import ElementTree

import numpy as np
from matplotlib.path import Path
from osgeo import gdal, ogr

import style
from harness import Failure

gdal.UseExceptions()
EXPERIMENT = os.path.join(os.path.dirname(os.path.realpath(__file__)), "experiment.toml")


def run(command):
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise Failure(f"{' '.join(command)}: {done.stderr.strip() or done.returncode}")


def grown(tools, name, *overrides, resolution):
    """(summary, folder) of one grown terrain."""
    folder = os.path.join(tools.work, "kelley_1988", name)
    os.makedirs(os.path.dirname(folder), exist_ok=True)
    sets = [part for each in (*overrides, f"output.resolution={resolution}") for part in ("--set", each)]
    run([tools.thalweg, "grow", EXPERIMENT, "--out", folder, "--force", "--quiet", "--no-figures", *sets])
    with open(os.path.join(folder, "summary.json"), encoding="utf-8") as stream:
        return json.load(stream), folder


def picture_of(folder, name):
    """Beside the folder: only what thalweg wrote itself may lie in it."""
    return f"{folder}_{name}.png"


def rendered(tools, folder, name, *options):
    run([tools.thalweg, "render", os.path.join(folder, "elevation.tif"), "--out", picture_of(folder, name), "--force",
         "--quiet", "--azimuth", "195", "--elevation-angle", "32", "--vertical-exaggeration", "1.5",
         *(("--network", os.path.join(folder, "network.gpkg")) if "kelley" in options else ()), *options])


def heights(folder):
    """Rows from the north; NaN outside the basin."""
    source = gdal.Open(os.path.join(folder, "elevation.tif"))
    z = source.GetRasterBand(1).ReadAsArray().astype(float)
    nodata = source.GetRasterBand(1).GetNoDataValue()
    return z if nodata is None or np.isnan(nodata) else np.where(z == nodata, np.nan, z)


def lines_of(folder, layer):
    """(places, attributes) of every feature: of polygons the outer ring."""
    source = ogr.Open(os.path.join(folder, "network.gpkg"))
    found = []
    for feature in source.GetLayerByName(layer):
        shape = feature.GetGeometryRef()
        while shape.GetGeometryCount():
            shape = shape.GetGeometryRef(0)
        places = np.array(shape.GetPoints())[:, :2]
        found.append((places, json.loads(feature.ExportToJson())["properties"]))
    return found


def draw_plan(axes, folder, shaded=False):
    """Links, wider with magnitude, within the divides or on the shaded surface."""
    if shaded:
        source = gdal.Open(os.path.join(folder, "elevation.tif"))
        west, dx, _, north, _, dy = source.GetGeoTransform()
        z = heights(folder)
        y, x = np.gradient(z, dx)  # unknown beside the rim: no slope down to what lies outside
        shade = (1 + x - y) / np.sqrt(3) / np.sqrt(1 + x**2 + y**2)
        axes.imshow(np.where(np.isnan(z), np.nan, shade), cmap="gray", vmin=-0.2, vmax=1.1,
                    extent=(west, west + dx * z.shape[1], north + dy * z.shape[0], north))
    else:
        for places, _ in lines_of(folder, "divides"):
            axes.plot(*places.T, color=style.GRID, linewidth=0.5)
    for places, link in lines_of(folder, "links"):
        axes.plot(*places.T, color=style.RIVER, linewidth=0.3 + 0.15 * np.sqrt(magnitude_of(link)),
                  solid_capstyle="round")
    axes.set_aspect("equal")
    axes.set_axis_off()


def draw_polygons(axes, folder):
    for number, (places, _) in enumerate(lines_of(folder, "polygons")):
        axes.fill(*places.T, facecolor=("#e9eef2", "#d7e3d2")[number % 2], edgecolor=style.MUTED, linewidth=0.4)
    for places, link in lines_of(folder, "links"):
        axes.plot(*places.T, color=style.RIVER, linewidth=0.5 + 0.2 * np.sqrt(magnitude_of(link)))
    axes.set_aspect("equal")
    axes.set_axis_off()


def draw_frame(axes, path):
    """A picture that `output.frames` made: polygons, outline and divides, channels, in its own colours."""
    svg = "{http://www.w3.org/2000/svg}"
    for shape in ElementTree.parse(path).getroot():
        for polygon in shape.iter(svg + "polygon"):
            places = np.array([pair.split(",") for pair in polygon.get("points").split()], dtype=float)
            axes.fill(*places.T, facecolor=shape.get("fill"), edgecolor="none")
        for line in shape.iter(svg + "path"):
            for part in line.get("d").split("M")[1:]:
                places = np.array([pair.split() for pair in part.split("L")], dtype=float)
                axes.plot(*places.T, color=line.get("stroke"), linewidth=0.45 * float(line.get("stroke-width")))
    axes.invert_yaxis()
    axes.set_aspect("equal")
    axes.set_axis_off()


def magnitude_of(link):
    return link.get("shreve") or link.get("magnitude") or 1


def valley_side_bulge(folder):
    """Height above the straight line from channel to ridge, halfway, over the rise: the mean over all valley sides that are
    ten cells wide or wider, square to the middle of their link. Above 0: convex."""
    source = gdal.Open(os.path.join(folder, "elevation.tif"))
    west, dx, _, north, _, dy = source.GetGeoTransform()
    z = heights(folder)
    links = {link["id"]: places for places, link in lines_of(folder, "links")}
    bulges = []
    for ring, polygon in lines_of(folder, "polygons"):
        line = links[polygon["link"]]
        middle, along = (line[0] + line[-1]) / 2, (line[-1] - line[0]) / np.hypot(*(line[-1] - line[0]))
        outside = Path(ring)
        for away in (np.array([-along[1], along[0]]), np.array([along[1], -along[0]])):
            width = 0
            while outside.contains_point(middle + (width + dx / 2) * away):
                width += dx / 2
            if width < 10 * dx:
                continue
            low, half, high = (z[int((p[1] - north) / dy), int((p[0] - west) / dx)]
                               for p in (middle + share * width * away for share in (0, 0.5, 1)))
            if high > low:
                bulges.append((half - (low + high) / 2) / (high - low))
    return float(np.nanmean(bulges)), len(bulges)


def network_measures(folder):
    """What the dials move, from the links' places, slopes and sides."""
    links = lines_of(folder, "links")
    values = {link["id"]: link for _, link in links}
    junctions = [junction for _, junction in lines_of(folder, "junctions")]
    upper = _upper_ends(values)
    length = {}
    for link in values.values():
        length[link["stream"]] = length.get(link["stream"], 0) + link["length_m"]
    own_side = {values[junction["tributary"]]["stream"]: junction["side"] for junction in junctions}
    places, obtuse, opposite = [], [], []
    for stream, on_stream in _by_stream(values, junctions).items():
        on_stream.sort(key=lambda junction: upper[junction["downstream"]])
        below = []  # those that are older than all between them and here: what had grown when the next one was drawn
        for junction in on_stream:
            place = upper[junction["downstream"]] / length[stream]
            places.append(place)
            if place < 1 / 3 and stream in own_side:
                obtuse.append(junction["side"] == own_side[stream])
            area = values[junction["tributary"]]["area_m2"]
            while below and values[below[-1]["tributary"]]["area_m2"] < area:
                below.pop()
            if 1 / 3 <= place < 2 / 3 and below:
                opposite.append(junction["side"] != below[-1]["side"])
            below.append(junction)
    exterior = [link for link in values.values() if link["shreve"] == 1]
    large = [link for link in values.values() if link["shreve"] >= 10]
    return {"junction_place": float(np.mean(places)), "headward_reach": _headward_reach(folder, links),
            "exterior_gradient": _gradient(exterior), "trunk_gradient": _gradient(large),
            "lower_obtuse": _share(obtuse), "middle_opposite": _share(opposite)}


def _by_stream(values, junctions):
    found = {}
    for junction in junctions:
        found.setdefault(values[junction["downstream"]]["stream"], []).append(junction)
    return found


def _upper_ends(values):
    """Distance of each link's upper end from the mouth of its stream; links are numbered from the outlet up."""
    upper = {}
    for number, link in sorted(values.items()):
        below = values.get(link["downstream"])
        same = below is not None and below["stream"] == link["stream"]
        upper[number] = link["length_m"] + (upper[link["downstream"]] if same else 0)
    return upper


def _headward_reach(folder, links):
    """Mean of length over length and head, of the links that have a source."""
    heads = {}
    for places, line in lines_of(folder, "divides"):
        if line["kind"] == "head":
            for end in (places[0], places[-1]):
                heads[tuple(np.round(end, 3))] = line["length_m"]
    shares = []
    for places, link in links:
        head = next((heads[key] for key in (tuple(np.round(end, 3)) for end in (places[0], places[-1])) if key in heads), None)
        if link["shreve"] == 1 and head is not None:
            shares.append(link["length_m"] / (link["length_m"] + head))
    return float(np.mean(shares)) if shares else None


def _gradient(links):
    return sum(link["drop_m"] for link in links) / sum(link["length_m"] for link in links) if links else None


def _share(cases):
    return float(np.mean(cases)) if cases else None
