# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables and figures with numbers of Bell (2024)."""
import bell_authoring
import bell_cost
import bell_heights
import bell_pictures

TITLE = "Bell 2024: stream-power terrain on Delaunay meshes"
LEAD = """
A square of 32 768 m, m = 0.5, n = 1, k = 5.6e-7 /yr, u = 4e-4 m/yr, steps of 250 000 yr, on a laptop (2.8 GHz i7). His
uplift image, talus angle, initial surface and threshold of convergence are not stated: what is reproduced are trends and
exponents, and his numbers stand beside ours. `experiment.toml` says what we take instead. Where no number of his is known
to us, the criterion is theory's or the trend that his figure is about, and the column "published" says so.

**The talus angle of 30° was fitted to his heights** (below: talus angles): verdicts on heights are partly circular, and what
they would be at 25° and 35° stands under "What hangs on the talus angle".
"""
CASES = bell_heights.CASES + bell_pictures.CASES + bell_authoring.CASES + bell_cost.CASES
