# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaded maps of a terrain with its rivers."""
import os
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.colors import Normalize
from matplotlib.cm import ScalarMappable
from matplotlib.patheffects import withStroke
from matplotlib.transforms import blended_transform_factory
from osgeo import gdal, ogr

import style
from data import Missing

gdal.UseExceptions()
ogr.UseExceptions()
gdal.PushErrorHandler("CPLQuietErrorHandler")

METRES_PER_DEGREE = 111320.0  # on a sphere of the equator's radius: for drawing only, measures come from the ellipsoid
SUN_ALTITUDE = np.radians(40)
LEVEL_GROUND = np.sin(SUN_ALTITUDE)  # its brightness
LONGEST_SIDE = 1100           # cells read at most: more would be thinner than a pixel
KEY_HEIGHT = 0.14             # inches, of the line under a map that explains its lines


@dataclass
class Terrain:
    """Elevations and where they lie. Map units are degrees (geographic) or kilometres."""
    elevation: np.ndarray     # m, NaN is no data
    extent: tuple             # left, right, bottom, top in map units
    geographic: bool
    referenced: bool          # has a coordinate system
    crs: str
    scale: object             # file units to map units: a number, or one each way
    middle: tuple = (0, 0)    # what of the file's units is 0 of the map's
    local: bool = False       # map units are kilometres from a middle of its own

    @property
    def latitude(self):
        return np.radians(0.5 * (self.extent[2] + self.extent[3])) if self.geographic else 0.0

    @property
    def km_per_unit(self):
        """East–west kilometres of one map unit at the middle."""
        return METRES_PER_DEGREE / 1000 * np.cos(self.latitude) if self.geographic else 1.0

    @property
    def aspect(self):
        return 1 / np.cos(self.latitude) if self.geographic else 1.0

    def on_map(self, points):
        """Points of the file as points of the map."""
        return (points - np.array(self.middle)) * self.scale

    def cell_metres(self):
        """East–west size per row (column vector) and north–south size of the cells as read."""
        rows, cols = self.elevation.shape
        left, right, bottom, top = self.extent
        dx, dy = (right - left) / cols, (top - bottom) / rows
        if not self.geographic:
            return np.full((rows, 1), dx * 1000), dy * 1000
        latitude = np.radians(top - (np.arange(rows) + 0.5) * dy)
        return (dx * METRES_PER_DEGREE * np.cos(latitude))[:, None], dy * METRES_PER_DEGREE


def read_terrain(path, window=None):
    """Opens a raster, thinned to what a page can show; `window`: left, right, bottom, top in map units."""
    if not os.path.exists(path):
        raise Missing(f"{path} does not exist")
    try:
        dataset = gdal.Open(path)
    except RuntimeError as error:
        raise Missing(f"{path} cannot be read: {str(error).splitlines()[0]}") from None
    reference = dataset.GetSpatialRef()
    geographic = reference is not None and bool(reference.IsGeographic())
    metres = reference.GetLinearUnits() if reference is not None and not geographic else 1.0
    scale = 1.0 if geographic else metres / 1000
    box = _cells_of(dataset, scale, window)
    elevation = _read(dataset.GetRasterBand(1), box)
    origin_x, dx, _, origin_y, _, dy = dataset.GetGeoTransform()
    column, row, columns, rows = box
    left, top = (origin_x + column * dx) * scale, (origin_y + row * dy) * scale
    extent = (left, left + columns * dx * scale, top + rows * dy * scale, top)
    crs = reference.GetName() if reference is not None else ""
    return Terrain(elevation, extent, geographic, reference is not None, crs, scale)


def _cells_of(dataset, scale, window):
    columns, rows = dataset.RasterXSize, dataset.RasterYSize
    if window is None:
        return 0, 0, columns, rows
    origin_x, dx, _, origin_y, _, dy = dataset.GetGeoTransform()
    left, right, bottom, top = (side / scale for side in window)
    first = np.clip(np.floor([(left - origin_x) / dx + 1e-6, (top - origin_y) / dy + 1e-6]), 0, [columns - 1, rows - 1])
    last = np.clip(np.ceil([(right - origin_x) / dx - 1e-6, (bottom - origin_y) / dy - 1e-6]), 1, [columns, rows])
    size = np.maximum(last - first, 1)
    return int(first[0]), int(first[1]), int(size[0]), int(size[1])


def _read(band, box):
    column, row, columns, rows = box
    shrink = max(1.0, max(columns, rows) / LONGEST_SIDE)
    values = band.ReadAsArray(column, row, columns, rows, buf_xsize=max(1, round(columns / shrink)),
                              buf_ysize=max(1, round(rows / shrink)), buf_type=gdal.GDT_Float32,
                              resample_alg=gdal.GRIORA_Average if shrink > 1 else gdal.GRIORA_NearestNeighbour)
    nodata = band.GetNoDataValue()
    if nodata is not None and np.isfinite(nodata):
        values[values == np.float32(nodata)] = np.nan
    return values


def height_range(*terrains):
    """Colour limits that suit all: the 0.5 and 99.5 percentiles of their heights (outliers would flatten the tint)."""
    values = np.concatenate([t.elevation[np.isfinite(t.elevation)].ravel() for t in terrains])
    if values.size == 0:
        return 0.0, 1.0
    low, high = np.percentile(values, [0.5, 99.5])
    return float(low), float(max(high, low + 1e-6))


def shading(terrain):
    """Brightness 0–1 lit from west, north-west, north and (fainter) south-west, so that no ridge line is lost; gentle
    land is exaggerated until its steeper tenth stands at 30 degrees."""
    z = np.asarray(terrain.elevation, dtype=float)
    valid = np.isfinite(z)
    east, north = _gradient(np.where(valid, z, _fill_value(z, valid)), terrain)
    steepness = np.hypot(east, north)[valid]
    steep = np.percentile(steepness, 90) if steepness.size else 0.0
    lift = np.clip(np.tan(np.radians(30)) / steep, 0.5, 12) if steep > 0 else 1.0
    east, north = east * lift, north * lift
    light = np.zeros_like(z)
    for azimuth, weight in ((225, 0.15), (270, 0.25), (315, 0.4), (360, 0.2)):
        light += weight * _lambert(east, north, np.radians(azimuth))
    return np.where(valid, light, 1.0)


def _fill_value(z, valid):
    return float(np.mean(z[valid])) if valid.any() else 0.0


def _gradient(z, terrain):
    """Rise per metre to the east and north; none across the edge of the data, where it would draw a false cliff."""
    dx, dy = terrain.cell_metres()
    valid = np.isfinite(terrain.elevation)
    rows, cols = z.shape
    east, north = np.zeros_like(z), np.zeros_like(z)
    if cols > 2:
        east[:, 1:-1] = np.where(valid[:, 2:] & valid[:, :-2], (z[:, 2:] - z[:, :-2]), 0)
        east[:, 0], east[:, -1] = east[:, 1], east[:, -2]
    if rows > 2:
        north[1:-1] = np.where(valid[:-2] & valid[2:], (z[:-2] - z[2:]), 0)
        north[0], north[-1] = north[1], north[-2]
    return east / (2 * dx), north / (2 * dy)


def _lambert(east, north, azimuth):
    facing = -(east * np.sin(azimuth) + north * np.cos(azimuth)) * np.cos(SUN_ALTITUDE) + LEVEL_GROUND
    return np.clip(facing / np.sqrt(1 + east**2 + north**2), 0, 1)


def picture(terrain, limits, faded=None):
    """The map's pixels (red, green, blue, opacity): tint times shading; `faded` cells step back."""
    tint = style.TINT(Normalize(*limits, clip=True)(np.nan_to_num(terrain.elevation, nan=limits[0])))
    light = np.interp(shading(terrain), [0, LEVEL_GROUND, 1], [0.33, 0.97, 1.13])[..., None]
    pixels = tint.copy()
    pixels[..., :3] = np.clip(tint[..., :3] * light, 0, 1)
    if faded is not None:
        pixels[faded, :3] = 0.30 * pixels[faded, :3] + 0.70 * 0.97
    pixels[..., 3] = np.isfinite(terrain.elevation)
    pixels[~np.isfinite(terrain.elevation), :3] = 1
    return pixels


def read_lines(path, layer_name, where=None, limit=4000):
    """Parts of the lines or rings of a layer as (points, fields), longest rivers first; [] when there is no such layer."""
    layer, source = _layer(path, layer_name)
    if layer is None:
        return []
    layer.SetAttributeFilter(where)
    found = []
    for count, feature in enumerate(layer):
        if count >= limit:
            break
        fields = feature.items()
        for part in _parts(feature.GetGeometryRef()):
            found.append((part, fields))
    del layer, source
    return found


def _layer(path, name):
    if not os.path.exists(path):
        return None, None
    try:
        source = gdal.OpenEx(path, gdal.OF_VECTOR | gdal.OF_READONLY)
        return source.GetLayerByName(name), source
    except RuntimeError as error:
        raise Missing(f"{path} cannot be read: {str(error).splitlines()[0]}") from None


def _parts(geometry):
    pending, parts = [geometry], []
    while pending:
        shape = pending.pop()
        if shape is None:
            continue
        if shape.GetGeometryCount():
            pending.extend(shape.GetGeometryRef(i) for i in range(shape.GetGeometryCount()))
        elif shape.GetPointCount() > 1:
            parts.append(np.array(shape.GetPoints(), dtype=float)[:, :2])
    return parts


def river_lengths(path):
    """Total length of the rivers (m) by Strahler order."""
    layer, source = _layer(path, "links")
    if layer is None:
        return {}
    lengths = {}
    for feature in source.ExecuteSQL("SELECT strahler, SUM(length_m) AS total FROM links GROUP BY strahler"):
        lengths[int(feature.GetField(0) or 1)] = float(feature.GetField(1) or 0)
    del layer, source
    return lengths


def legible_order(lengths, terrain, width_in):
    """The lowest Strahler order at which rivers lie at least 0.05 inches apart on the map, on average."""
    dx, dy = terrain.cell_metres()
    area = float(np.sum(np.isfinite(terrain.elevation) * dx) * dy)
    metres_per_inch = (terrain.extent[1] - terrain.extent[0]) * terrain.km_per_unit * 1000 / width_in
    for order in sorted(lengths):
        total = sum(length for each, length in lengths.items() if each >= order)
        if total == 0 or area / total / metres_per_inch > 0.05:
            return order
    return max(lengths, default=1)


def river_width(order, lowest):
    """Line width in points."""
    return 0.45 + 0.36 * (order - lowest)


def draw_rivers(axes, path, terrain, lowest):
    """Blue lines from the lowest Strahler order on, wider with it."""
    rivers = read_lines(path, "links", f"strahler >= {lowest}")
    rivers.sort(key=lambda river: river[1].get("strahler") or 1)
    widths = [river_width(fields.get("strahler") or 1, lowest) for _, fields in rivers]
    axes.add_collection(LineCollection([terrain.on_map(line) for line, _ in rivers], linewidths=widths,
                                       colors=style.RIVER, capstyle="round", joinstyle="round", zorder=3))


def draw_key(axes, lowest, highest, outlines):
    """What the widths of the rivers and the outlines mean, in axes of its own; `outlines`: (words, line width). One line
    in the middle of the figure and as wide as that at most: of many orders only every second or third one has room, and
    the highest."""
    axes.set_axis_off()
    figure = axes.get_figure()
    across = blended_transform_factory(figure.transFigure, axes.transAxes)
    for step in range(1, max(2, highest - lowest + 2)):
        orders = sorted({*range(lowest, highest + 1, step), *([highest] if highest >= lowest else [])})
        handles = [Line2D([], [], color=style.RIVER, linewidth=river_width(order, lowest), label=f"order {order}")
                   for order in orders]
        if handles:
            handles[0].set_label(f"river of Strahler order {lowest}")
        handles += [Line2D([], [], color=style.DIVIDE, linewidth=width, label=words) for words, width in outlines]
        if not handles:
            return
        key = axes.legend(handles=handles, loc="center", ncol=len(handles), frameon=False, handlelength=1.8,
                          columnspacing=1.4, bbox_to_anchor=(0.5, 0.5), bbox_transform=across)
        key.set_in_layout(False)
        if key.get_window_extent(figure.canvas.get_renderer()).width <= 0.94 * figure.bbox.width:
            return


def draw_basins(axes, path, terrain, width=0.5):
    """Outlines of the basins that are large enough to be seen (a three-hundredth of the map); True where there are any."""
    dx, dy = terrain.cell_metres()
    smallest = float(np.sum(dx) * terrain.elevation.shape[1] * dy) / 300
    rings = read_lines(path, "basins", f"area_m2 >= {smallest:.6g}", limit=300)
    axes.add_collection(LineCollection([terrain.on_map(ring) for ring, _ in rings], linewidths=width,
                                       colors=style.DIVIDE, zorder=4))
    return bool(rings)


def draw_terrain(axes, terrain, limits, faded=None):
    """Paints the terrain and labels the axes."""
    axes.imshow(picture(terrain, limits, faded), extent=terrain.extent, origin="upper", interpolation="bicubic"
                if max(terrain.elevation.shape) < 700 else "antialiased", aspect=terrain.aspect, zorder=1)
    axes.set(xlim=terrain.extent[:2], ylim=terrain.extent[2:])
    axes.grid(False)
    for spine in axes.spines.values():
        spine.set_visible(True)
    if terrain.local:
        axes.set(xlabel="East of the middle (km)", ylabel="North of the middle (km)")
    elif terrain.geographic:
        axes.set(xlabel="Longitude (°)", ylabel="Latitude (°)")
    elif terrain.referenced:
        axes.set(xlabel="Easting (km)", ylabel="Northing (km)")
    else:
        axes.set(xlabel="x (km)", ylabel="y (km)")
    axes.ticklabel_format(useOffset=False, style="plain")
    axes.locator_params(nbins=5)


def draw_scale_bar(axes, terrain):
    """A bar of 1, 2 or 5 times a power of ten kilometres, near a fifth of the map, in the lower left corner."""
    left, right = axes.get_xlim()
    bottom, top = axes.get_ylim()
    wanted = 0.22 * (right - left) * terrain.km_per_unit
    power = 10.0 ** np.floor(np.log10(wanted))
    length = power * max(step for step in (1, 2, 5) if step * power <= wanted)
    x, y = left + 0.04 * (right - left), bottom + 0.045 * (top - bottom)
    halo = [withStroke(linewidth=3, foreground="white", alpha=0.85)]
    axes.plot([x, x + length / terrain.km_per_unit], [y, y], color=style.INK, linewidth=2, solid_capstyle="butt",
              zorder=6, path_effects=halo)
    label = f"{length:g} km" if length >= 1 else f"{length * 1000:g} m"
    axes.text(x, y + 0.015 * (top - bottom), label, fontsize=7, ha="left", va="bottom", zorder=6, path_effects=halo)


def draw_colours(drawing, axes, limits, terrains):
    """The tint's key; its ends are pointed where heights go beyond it."""
    heights = [t.elevation[np.isfinite(t.elevation)] for t in terrains]
    below = any(h.size and h.min() < limits[0] for h in heights)
    above = any(h.size and h.max() > limits[1] for h in heights)
    extend = {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}[int(below), int(above)]
    bar = drawing.colorbar(ScalarMappable(Normalize(*limits), style.TINT), ax=axes, label="Elevation (m)",
                           shrink=0.75, aspect=32, pad=0.015, extend=extend)
    bar.outline.set_linewidth(0.4)


def single(raster, network, studied=None):
    """One map. Returns the figure and the lowest Strahler order drawn; `studied`: a network whose basins stand out."""
    terrain = read_terrain(raster)
    left, right, bottom, top = terrain.extent
    ratio = (top - bottom) / (right - left) * terrain.aspect
    panel = min(5.3, 5.9 / ratio)
    drawing = style.figure(max(2.4, panel * ratio + 0.75), panel + 1.3)
    drawing.get_layout_engine().set(w_pad=0.1)  # inches: a map keeps its shape, which the layout takes from the margin
    grid = drawing.add_gridspec(2, 1, height_ratios=(panel * ratio, KEY_HEIGHT))
    axes = drawing.add_subplot(grid[0])
    limits = height_range(terrain)
    lengths = river_lengths(network)
    lowest = legible_order(lengths, terrain, panel)
    draw_terrain(axes, terrain, limits)
    draw_rivers(axes, network, terrain, lowest)
    outlines = [("catchment", 0.5)] if draw_basins(axes, network, terrain) else []
    if studied and draw_basins(axes, studied, terrain, 1.4):
        outlines.append(("the studied one", 1.4))
    draw_scale_bar(axes, terrain)
    draw_colours(drawing, axes, limits, [terrain])
    draw_key(drawing.add_subplot(grid[1]), lowest, max(lengths, default=0), outlines)
    return drawing, lowest


def pair(real, synthetic):
    """Two maps at one scale and one range of colours; each argument is (raster, network, title). The real terrain is cut
    to the synthetic one's window when both share coordinates, and steps back where nothing was simulated; without common
    coordinates both are drawn in kilometres from their middles."""
    second = _with_margin(read_terrain(synthetic[0]))
    first = read_terrain(real[0])
    faded = None
    if _overlap(first, second):
        first = read_terrain(real[0], second.extent)
        first, second, faded = _aligned(first, second)
    else:
        first, second = _in_kilometres(_with_margin(first)), _in_kilometres(second)
    shown = first if faded is None else replace(first, elevation=np.where(faded, np.nan, first.elevation))
    limits = height_range(shown, second)
    span = [max(_span_km(t)[i] for t in (first, second)) for i in (0, 1)]
    panel = min(4.1, 5.2 * span[0] / span[1])
    drawing = style.figure(panel * span[1] / span[0] + 0.85, 2 * panel + 1.9)
    grid = drawing.add_gridspec(2, 2, height_ratios=(panel * span[1] / span[0], KEY_HEIGHT))
    axes = [drawing.add_subplot(grid[0, i]) for i in (0, 1)]
    lengths = [river_lengths(network) for _, network, _ in (real, synthetic)]
    lowest = max(legible_order(each, terrain, panel * _span_km(terrain)[0] / span[0])
                 for each, terrain in zip(lengths, (first, second)))
    outlined = False
    for axis, terrain, (_, network, title), fade in zip(axes, (first, second), (real, synthetic), (faded, None)):
        draw_terrain(axis, terrain, limits, fade)
        _centre(axis, terrain, span)
        draw_rivers(axis, network, terrain, lowest)
        outlined |= draw_basins(axis, network, terrain, 0.7)
        draw_scale_bar(axis, terrain)
        axis.set_title(title)
    axes[1].set_ylabel("")
    draw_colours(drawing, axes, limits, [shown, second])
    highest = max((order for each in lengths for order in each), default=0)
    draw_key(drawing.add_subplot(grid[1, :]), lowest, highest, [("catchment", 0.7)] if outlined else [])
    return drawing


def _with_margin(terrain, share=0.03):
    """Three per cent of no data around, so that an outline does not touch the frame."""
    rows, cols = terrain.elevation.shape
    pad = max(1, round(share * max(rows, cols)))
    left, right, bottom, top = terrain.extent
    dx, dy = (right - left) / cols, (top - bottom) / rows
    extent = (left - pad * dx, right + pad * dx, bottom - pad * dy, top + pad * dy)
    return replace(terrain, elevation=np.pad(terrain.elevation, pad, constant_values=np.nan), extent=extent)


def _in_kilometres(terrain):
    """The same terrain on a map of kilometres from the middle of its data."""
    left, right, bottom, top = terrain.extent
    scale = np.array([terrain.km_per_unit, terrain.km_per_unit * terrain.aspect])
    valid = np.isfinite(terrain.elevation)
    rows, cols = (np.flatnonzero(valid.any(axis=axis)) for axis in (1, 0))
    dx, dy = (right - left) / valid.shape[1], (top - bottom) / valid.shape[0]
    middle = np.array([left, top])
    if rows.size:
        middle += [0.5 * dx * (cols[0] + cols[-1] + 1), -0.5 * dy * (rows[0] + rows[-1] + 1)]
    x, y = ((np.array(terrain.extent).reshape(2, 2) - middle[:, None]) * scale[:, None]).tolist()
    return replace(terrain, extent=(*x, *y), geographic=False, scale=scale * terrain.scale,
                   middle=tuple(middle / terrain.scale), local=True)


def _overlap(first, second):
    if not (first.referenced and second.referenced) or (first.crs, first.geographic) != (second.crs, second.geographic):
        return False
    a, b = first.extent, second.extent
    middle_x, middle_y = 0.5 * (b[0] + b[1]), 0.5 * (b[2] + b[3])
    return a[0] <= middle_x <= a[1] and a[2] <= middle_y <= a[3]


def _aligned(first, second):
    """Puts the synthetic terrain on the real one's window and cells; True where only the real one has ground."""
    rows, cols = first.elevation.shape
    left, right, bottom, top = first.extent
    x = left + (np.arange(cols) + 0.5) * (right - left) / cols
    y = top - (np.arange(rows) + 0.5) * (top - bottom) / rows
    left, right, bottom, top = second.extent
    column = np.floor((x - left) / (right - left) * second.elevation.shape[1]).astype(int)
    row = np.floor((top - y) / (top - bottom) * second.elevation.shape[0]).astype(int)
    inside = ((row >= 0) & (row < second.elevation.shape[0]))[:, None] & ((column >= 0)
                                                                          & (column < second.elevation.shape[1]))
    sampled = second.elevation[np.clip(row, 0, second.elevation.shape[0] - 1)][
        :, np.clip(column, 0, second.elevation.shape[1] - 1)]
    covered = inside & np.isfinite(sampled)
    clipped = replace(second, elevation=np.where(inside, sampled, np.nan), extent=first.extent)
    return first, clipped, ~covered & np.isfinite(first.elevation)


def _span_km(terrain):
    left, right, bottom, top = terrain.extent
    return (right - left) * terrain.km_per_unit, (top - bottom) * terrain.km_per_unit * terrain.aspect


def _centre(axis, terrain, span):
    """Widens the view to `span` kilometres around the terrain's middle."""
    left, right, bottom, top = terrain.extent
    half_x = 0.5 * span[0] / terrain.km_per_unit
    half_y = 0.5 * span[1] / (terrain.km_per_unit * terrain.aspect)
    middle_x, middle_y = 0.5 * (left + right), 0.5 * (bottom + top)
    axis.set(xlim=(middle_x - half_x, middle_x + half_x), ylim=(middle_y - half_y, middle_y + half_y))
