# SPDX-License-Identifier: GPL-3.0-or-later
"""Networks, surface and pictures: Kelley, Malin & Nielson (1988)."""
import os
import sys
import time

import numpy as np
from PIL import Image

import style
from harness import Case, number, select, verdict

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from grown import draw_frame, draw_plan, draw_polygons, grown, heights, lines_of, network_measures, picture_of, rendered, valley_side_bulge  # noqa: E402
from later import reshaped_compute, reshaped_draw, reshaped_judge, roughness_compute, roughness_draw, roughness_judge, roughness_text  # noqa: E402

TITLE = "Kelley, Malin & Nielson 1988: terrain simulation using a model of stream erosion"
LEAD = """
They grow a network of streams from an outline and a trunk by rules that geomorphologists had measured, hang a surface under
tension over it, and draw it. Their outline, trunk and most dials are not stated, so the figures here are counterparts, not
copies; what can be compared is what they claim: typical constants, sizes, times, and what each dial does. Where the rules as
printed do not end or do not fit together, ours stand in the header of `grow/grow.hpp`.
"""

MILE_M = 1609.344


def named(published, quantity):
    return next(row["published"] for row in published if row["quantity"] == quantity)


# ---- the network

STAGES = (("initial", 1800), ("halfway", 900), ("full-grown", 450))


def network_compute(tools, quick):
    rows, folders = [], []
    for stage, c in STAGES[:: 2 if quick else 1]:
        summary, folder = grown(tools, f"network_{c}", f"growth.channel_maintenance_m={c}", resolution=100)
        tree = summary["tree"]
        rows.append({"stage": stage, "channel_maintenance_m": c, "links": summary["links"],
                     "polygons": len(lines_of(folder, "polygons")),
                     "area_error": abs(summary["polygon_area_sum_m2"] / summary["basin_area_m2"] - 1),
                     "density_per_m": summary["drainage_density_per_m"],
                     "max_shreve": summary["max_shreve"], "flint_q": tree["flint"]["q"],
                     "bifurcation_ratio": tree["horton"]["RB"]["regression"]})
        folders.append(folder)
    return rows, folders


def network_judge(rows, published):
    full = rows[-1]
    miles = 1 / full["density_per_m"] / MILE_M
    low, high = named(published, "constant_of_channel_maintenance_least"), named(published, "constant_of_channel_maintenance_most")
    least, most = named(published, "flint_q_least"), named(published, "flint_q_most")
    return [verdict("constant of channel maintenance of resistant rock (miles)", f"{low} to {high}", f"{miles:.3f}",
                    "the grown network's own lies in the range", low <= miles <= high),
            verdict("gradients follow Flint's law along every stream", f"exponent {least} to {most}", f"{full['flint_q']:.3f}",
                    "fitted on the grown tree: within 0.01 of the dial of -0.6", abs(full["flint_q"] + 0.6) < 0.01),
            verdict("the drainage polygons cut up the basin: areas add up to it", "exactly",
                    f"off by {max(row['area_error'] for row in rows):.0e}", "relative error under 1e-9",
                    max(row["area_error"] for row in rows) < 1e-9),
            verdict("each link drains two polygons, a left and a right one", "2 per link",
                    f"{number(full['polygons'] / full['links'])} per link", "equal", full["polygons"] == 2 * full["links"]),
            verdict("magnitudes add: that of the outlet is the number of sources", "(links + 1)/2",
                    f"{number(full['max_shreve'])} of {number(full['links'])} links", "equal",
                    full["max_shreve"] == (full["links"] + 1) / 2)]


def network_draw(rows, _, folders):
    drawing = style.figure(2.2)
    panels = drawing.subplots(1, len(rows) + 1)
    for axes, row, folder in zip(panels, rows, folders):
        draw_plan(axes, folder)
        axes.set_title(f"{row['stage']}: {number(row['links'])} links")
    draw_polygons(panels[-1], folders[0])
    panels[-1].set_title("initial: polygons")
    return drawing


# ---- the network growing

def frames_compute(tools, quick):
    summary, folder = grown(tools, "frames", f"output.frames={4 if quick else 8}", resolution=100)
    rows = [{"frame": frame, "links": drawn["links"], "sources": drawn["sources"], "total_length_m": drawn["total_length_m"],
             "share_of_length": drawn["total_length_m"] / summary["total_length_m"], "file": drawn["file"]}
            for frame, drawn in enumerate(summary["frames"], 1)]
    return rows, [folder]


def frames_judge(rows, _):
    longer = all(after["total_length_m"] > before["total_length_m"] for before, after in zip(rows, rows[1:]))
    return [verdict("a film of the network growing (their section 7, future work then)", "to be done",
                    f"{rows[0]['links']:.0f} to {rows[-1]['links']:.0f} links in {len(rows)} frames",
                    "from the trunk alone to the whole, longer in every frame",
                    rows[0]["links"] == 1 and rows[-1]["share_of_length"] == 1 and longer)]


def frames_draw(rows, _, folders):
    drawing = style.figure(4.2)
    columns = (len(rows) + 1) // 2
    panels = drawing.subplots(2, columns).ravel()
    for axes, row in zip(panels, rows):
        draw_frame(axes, os.path.join(folders[0], row["file"]))
        axes.set_title(f"{number(row['links'])} link{'s' if row['links'] > 1 else ''}")
    for axes in panels[len(rows):]:
        axes.set_axis_off()
    return drawing


# ---- the wireframe

def wireframe_compute(tools, quick):
    rows, folders = [], []
    for tension in (5, 0):
        summary, folder = grown(tools, f"wireframe_{tension}", f"growth.tension_channel={tension}", resolution=50)
        z = heights(folder)
        bulge, sides = valley_side_bulge(grown(tools, f"sides_{tension}", f"growth.tension_channel={tension}", resolution=600)[1])
        rows.append({"tension_channel": tension, "bulge": bulge, "sides": sides, "rows": z.shape[0], "cols": z.shape[1], "evaluations": int(np.isfinite(z).sum()),
                     "outside": int(np.isnan(z).sum()), "elevation_mean_m": float(np.nanmean(z)),
                     "elevation_max_m": float(np.nanmax(z)), "links": summary["links"]})
        folders.append(folder)
    return rows, folders


def wireframe_judge(rows, published):
    wanted = named(published, "rows_and_columns")
    tight, loose = select(rows, tension_channel=5)[0], select(rows, tension_channel=0)[0]
    return [verdict("the surface on a grid of 50 × 50", number(wanted), f"{number(tight['rows'])} × {number(tight['cols'])}",
                    "the longer side has 50", max(tight["rows"], tight["cols"]) == wanted),
            verdict("outside the basin there is no terrain", "0 or no data", f"{number(tight['outside'])} cells without data",
                    "some, and others with", tight["outside"] > 0 and tight["evaluations"] > 0),
            verdict("tension 5 at channels and 0 at ridges makes valley sides convex", "convex",
                    f"halfway up {100 * tight['bulge']:.1f} % of the rise above the straight line, without tension "
                    f"{100 * loose['bulge']:.1f} % (mean of {number(tight['sides'])} sides)",
                    "above the line, and more than without tension", tight["bulge"] > max(0, loose["bulge"]))]


def wireframe_draw(rows, _, folders):
    z = heights(folders[0])[::-1]
    y, x = np.mgrid[0:z.shape[0], 0:z.shape[1]]
    drawing = style.figure(3.2, 6.0)
    drawing.set_layout_engine("none")
    axes = drawing.add_axes((0, -0.42, 1, 1.9), projection="3d", computed_zorder=False)  # beyond the page: it has wide margins
    axes.plot_surface(x, y, z, color="white", edgecolor=style.INK, linewidth=0.25, shade=False, rstride=1, cstride=1)
    axes.view_init(38, -68)
    axes.set_box_aspect((z.shape[1], z.shape[0], 14), zoom=1.15)
    axes.set_axis_off()
    return drawing


# ---- Shreve Valley

def valley_compute(tools, quick):
    wanted = 26671
    resolution = 60 if quick else 205
    summary, folder = grown(tools, "valley", resolution=resolution)
    z = heights(folder)
    seconds = summary["seconds"]
    cells = np.isfinite(z)
    squares = cells[:-1, :-1] & cells[1:, :-1] & cells[:-1, 1:] & cells[1:, 1:]
    rows = [{"resolution": resolution, "evaluations": int(cells.sum()), "grid_triangles": 2 * int(squares.sum()),
             "mesh_triangles": summary["triangles"], "links": summary["links"], "wanted": wanted,
             "seconds_grow": seconds["grow"], "seconds_gradients": seconds["gradients"],
             "seconds_evaluate": seconds["evaluate"], "seconds_total": seconds["total"]}]
    size = "200x125" if quick else "760x475"
    for picture, options in PICTURES:
        rendered(tools, folder, picture, "--size", size, *options)
    return rows, [folder]


PICTURES = (("kelley", ("--color", "kelley")), ("elevation", ("--color", "elevation")),
            ("clay", ("--color", "clay")), ("polygons", ("--style", "polygons", "--color", "kelley", "--lines", "100")))


def valley_judge(rows, published):
    row, minutes = rows[0], named(published, "minutes")
    evaluations, triangles = named(published, "evaluations"), named(published, "triangles")
    made = row["seconds_grow"] + row["seconds_gradients"] + row["seconds_evaluate"]
    return [verdict("network and evaluation, in minutes", f"{number(minutes)} min for {number(evaluations, 5)} evaluations",
                    f"{made:.2g} s for {number(row['evaluations'], 5)}", "under a hundredth of theirs at their size or more",
                    made < 0.6 * minutes and row["evaluations"] >= evaluations, full_only=True),
            verdict("triangles of the picture", number(triangles, 5), f"{number(row['grid_triangles'], 5)} on the grid",
                    "as many or more", row["grid_triangles"] >= triangles, full_only=True)]


def valley_draw(rows, _, folders):
    drawing = style.figure(4.9)
    for axes, (picture, title) in zip(drawing.subplots(2, 2).flat,
                                      (("kelley", "by elevation, location and gradient"), ("elevation", "by elevation"),
                                       ("clay", "diffuse light on clay"), ("polygons", "polygons, 100 along the longer side"))):
        axes.imshow(np.asarray(Image.open(picture_of(folders[0], picture))))
        axes.set_title(title)
        axes.set_axis_off()
    return drawing


# ---- the rendering

def rendering_compute(tools, quick):
    _, folder = grown(tools, "rendering", resolution=60 if quick else 205)
    begin = time.monotonic()
    rendered(tools, folder, "picture", "--color", "kelley", "--size", "128x128" if quick else "512x512")
    seconds = time.monotonic() - begin
    width, height = Image.open(picture_of(folder, "picture")).size
    return [{"width": width, "height": height, "rays_per_pixel": 16, "seconds_render": seconds}], [folder]


def rendering_judge(rows, published):
    row, minutes, pixels = rows[0], named(published, "minutes"), named(published, "pixels")
    return [verdict("a picture of 512 × 512 pixels", f"{number(minutes)} min", f"{row['seconds_render']:.2g} s for "
                    f"{number(row['width'])} × {number(row['height'])}, reading the terrain included",
                    "under a tenth of theirs at their size",
                    row["seconds_render"] < 6 * minutes and row["width"] == row["height"] == pixels, full_only=True)]


def rendering_draw(_, __, folders):
    drawing = style.figure(3.2, 3.2)
    axes = drawing.add_subplot()
    axes.imshow(np.asarray(Image.open(picture_of(folders[0], "picture"))))
    axes.set_axis_off()
    return drawing


# ---- what each dial does

#: dial, low, high, what is read off the summary, words for it, whether that rises with the dial
DIALS = (
    ("channel_maintenance_m", 400, 800, "density_per_km", "drainage density", -1),
    ("mean_junction", 0.25, 0.75, "junction_place", "mean place of junctions", 1),
    ("mean_length", 0.4, 0.9, "headward_reach", "share of the way to the divide", 1),
    ("flint_q", -0.8, -0.4, "trunk_gradient", "gradient of the largest links", 1),
    ("flint_p", 0.08, 0.24, "exterior_gradient", "gradient of exterior links", 1),
    ("sidewall_angle_deg", 15, 35, "relief_m", "relief", 1),
    ("lower_bias", 0, 1, "lower_obtuse", "share on the obtuse side, lower thirds", 1),
    ("middle_bias", 0, 1, "middle_opposite", "share opposite the next older one downstream, middle thirds", 1),
)
SEEDS = 8


def dials_compute(tools, quick):
    rows, folders = [], []
    seeds = 1 if quick else SEEDS
    for dial, low, high, quantity, _, _ in DIALS:
        for value in (low, high):
            base = () if dial == "channel_maintenance_m" else ("growth.channel_maintenance_m=600",)
            for seed in range(1, seeds + 1):
                summary, folder = grown(tools, f"{dial}_{value}_{seed}", f"growth.{dial}={value}", f"seed={seed}", *base,
                                        resolution=100)
                rows.append({"dial": dial, "value": value, "seed": seed, "quantity": quantity,
                             "measured": measured(quantity, summary, folder), "links": summary["links"]})
                if seed == 1:
                    folders.append(folder)
    return rows, folders


def measured(quantity, summary, folder):
    """One number of a grown network, from its links' places and magnitudes."""
    if quantity == "density_per_km":
        return 1000 * summary["drainage_density_per_m"]
    if quantity == "relief_m":
        z = heights(folder)
        return float(np.nanmax(z) - np.nanmin(z))
    return network_measures(folder)[quantity]


def dials_judge(rows, published):
    verdicts = []
    for dial, low, high, quantity, words, sign in DIALS:
        at_low, at_high = (np.array([row["measured"] for row in select(rows, dial=dial, value=value)], dtype=float)
                           for value in (low, high))
        gain = sign * (np.nanmean(at_high) - np.nanmean(at_low))
        error = np.hypot(np.nanstd(at_high), np.nanstd(at_low)) / np.sqrt(max(len(at_high), 1))
        verdicts.append(verdict(f"`{dial}` moves the {words}", "rises" if sign > 0 else "falls",
                                f"{number(np.nanmean(at_low))} at {low}, {number(np.nanmean(at_high))} at {high}",
                                f"by more than two standard errors, {SEEDS} networks each", bool(gain > 2 * error),
                                full_only=True))
    return verdicts


def dials_text(rows, published):
    return """
They give no numbers for this: that a measure rises or falls with its dial is what their rules say. Each row of the table is a
mean over eight networks in the same basin. What is measured is not the dial: what grows later hides how it grew (see `thalweg
fit --method growth`, which finds dials on real networks)."""


def dials_draw(rows, _, folders):
    drawing = style.figure(8.0, 6.6)
    panels = drawing.subplots(4, 4)
    for number_of, (dial, low, high, *_rest) in enumerate(DIALS):
        for end, value in enumerate((low, high)):
            axes = panels[2 * (number_of // 4) + end, number_of % 4]
            draw_plan(axes, folders[2 * number_of + end], shaded=True)
            axes.set_title(f"{dial} = {value}", fontsize=6, fontweight="normal", loc="center")
    return drawing


CASES = [
    Case("network", "Initial drainage system, polygons, network", None, network_judge, network_draw, compute=network_compute,
         columns=("stage", "channel_maintenance_m", "links", "max_shreve", "flint_q", "bifurcation_ratio"), palette=True,
         caption="The network at three constants of channel maintenance from the same outline and trunk, and the polygons of the "
                 "first, left and right of each link."),
    Case("frames", "The network growing", None, frames_judge, frames_draw, compute=frames_compute, palette=True,
         columns=("frame", "links", "sources", "total_length_m", "share_of_length"),
         caption="Frames of the full-grown network as `output.frames` draws them, in red the streams that are new since the one "
                 "before."),
    Case("wireframe", "Wireframe of 50 × 50", None, wireframe_judge, wireframe_draw, compute=wireframe_compute, palette=True,
         columns=("tension_channel", "bulge", "rows", "cols", "evaluations", "elevation_mean_m", "elevation_max_m"),
         caption="The surface under tension on cells of which 50 lie along the longer side, heights about three times too large."),
    Case("valley", "Shreve Valley", None, valley_judge, valley_draw, compute=valley_compute, palette=True, timed=True,
         columns=("evaluations", "grid_triangles", "mesh_triangles", "links", "seconds_grow", "seconds_gradients",
                  "seconds_evaluate"),
         caption="The grown terrain drawn by `thalweg render`, coloured as in their section 5 and three other ways."),
    Case("rendering", "The rendering's time", None, rendering_judge, rendering_draw, compute=rendering_compute, palette=True,
         timed=True, columns=("width", "height", "rays_per_pixel", "seconds_render")),
    Case("dials", "What each dial does", None, dials_judge, dials_draw, dials_text, compute=dials_compute, palette=True,
         caption="Each dial low and, below, high, all others as they were, the same seed. Widths by magnitude."),
    Case("reshaped", "Rivers and diffusion reshape it (section 7)", None, reshaped_judge, reshaped_draw, compute=reshaped_compute,
         palette=True, columns=("years", "elevation_mean_m", "elevation_max_m", "ridge_curvature_per_km", "theta"),
         caption="The grown terrain, and what rivers (k = 2e-6, m = 0.5) and creep (0.02 m²/yr) make of it without uplift, the "
                 "rim held."),
    Case("roughness", "Roughness by subdivision (section 7)", None, roughness_judge, roughness_draw, roughness_text, compute=roughness_compute,
         palette=True, columns=("hurst", "exponent", "exponent_wide", "roughness_sd_m", "junctions_recovered"),
         caption="The surface under tension as it is, and roughened by recursive subdivision below the scale of its triangles, "
                 "12 m over half the constant of channel maintenance, with two Hurst exponents."),
]
