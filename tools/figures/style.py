# SPDX-License-Identifier: GPL-3.0-or-later
"""One look for every figure: fonts, sizes, colours, and how a figure becomes bytes.

Colours are from Okabe & Ito (2008), told apart with any colour vision; real and synthetic terrain also differ in marker
and line style, so that a grey print still works. Nothing written depends on the date, the machine or the user's
matplotlibrc.
"""
import io
import logging

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from PIL import Image

INK = "#26292e"
MUTED = "#6c737c"
GRID = "#dfe3e7"
REAL = "#0072B2"
SYNTHETIC = "#D55E00"
GROWN = "#009E73"
THEORY = "#26292e"
RIVER = "#124e96"
DIVIDE = "#3d3a36"

LOOK = {
    "real": {"color": REAL, "marker": "o", "linestyle": "-"},
    "synthetic": {"color": SYNTHETIC, "marker": "^", "linestyle": (0, (5, 1.6))},
    "grown": {"color": GROWN, "marker": "s", "linestyle": (0, (1.2, 1.2))},
}

#: Lightness rises with height, so that the tint also reads in grey; pale, so that the shading carries the relief.
TINT = LinearSegmentedColormap.from_list(
    "thalweg", ["#7d9a8c", "#a3b697", "#cccda8", "#ded4b6", "#e2cfb9", "#e6d8cc", "#f1ebe6"])

DPI = 150
WIDTH = 7.2  # inches: the text width of a two-column journal page

_SETTINGS = {
    "font.family": "DejaVu Sans", "font.size": 8, "axes.titlesize": 8.5, "axes.labelsize": 8,
    "xtick.labelsize": 7, "ytick.labelsize": 7, "legend.fontsize": 7, "mathtext.fontset": "dejavusans",
    "text.color": INK, "axes.labelcolor": INK, "axes.edgecolor": INK, "xtick.color": INK, "ytick.color": INK,
    "axes.linewidth": 0.6, "xtick.major.width": 0.6, "ytick.major.width": 0.6, "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4, "xtick.direction": "out", "ytick.direction": "out", "lines.linewidth": 1.4,
    "axes.titlelocation": "left", "axes.titleweight": "bold", "axes.grid": True, "grid.color": GRID,
    "grid.linewidth": 0.5, "axes.axisbelow": True, "axes.spines.top": False, "axes.spines.right": False,
    "legend.frameon": True, "legend.framealpha": 0.9, "legend.edgecolor": "none", "legend.borderpad": 0.3,
    "figure.dpi": DPI, "savefig.dpi": DPI, "svg.hashsalt": "thalweg", "svg.fonttype": "path",
}


def prepare():
    """Forgets any matplotlibrc found on the way and sets ours."""
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    matplotlib.rcdefaults()
    matplotlib.rcParams.update(_SETTINGS)


def figure(height, width=WIDTH):
    """An empty figure (inches) whose parts are laid out without overlaps."""
    drawing = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(drawing)
    return drawing


def png(drawing, dpi=DPI, palette=False):
    """The figure as PNG. A palette of 256 colours makes a map a third of the bytes, with no difference the eye can find."""
    drawing.set_dpi(dpi)
    drawing.draw_without_rendering()  # a map's shape is known after one layout, and its labels placed in the next
    drawing.canvas.draw()
    image = Image.fromarray(_pixels(drawing))
    if palette:
        image = image.quantize(256, method=Image.Quantize.MEDIANCUT)
    stream = io.BytesIO()
    image.save(stream, format="PNG", dpi=(dpi, dpi), optimize=False, compress_level=6)
    return stream.getvalue()


def svg(drawing):
    """The figure as SVG (what is marked as rasterized stays pixels), without date or creator."""
    stream = io.BytesIO()
    drawing.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    return stream.getvalue()


def _pixels(drawing):
    return np.ascontiguousarray(np.asarray(drawing.canvas.buffer_rgba())[:, :, :3])
