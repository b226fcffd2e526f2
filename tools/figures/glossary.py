# SPDX-License-Identifier: GPL-3.0-or-later
"""What each number of the report means, and who defined it."""

ENTRIES = (
    ("Drainage area <i>A</i> (m²)", "Ground that drains through a point, summed from the true areas of its cells.", ""),
    ("Slope <i>S</i> (m/m)", "Fall over length along the flow. On a grid it is measured over pieces of equal fall along a "
     "profile that was carved through false pits, never across a jump of <i>A</i>.", "after Wobus and others, 2006"),
    ("Concavity θ (–), steepness <i>k</i><sub>s</sub> (m<sup>2θ</sup>)",
     "Exponent and factor of <i>S</i> = <i>k</i><sub>s</sub> <i>A</i><sup>−θ</sup>. Half of the world’s "
     "rivers lie between 0.225 and 0.575.", "Flint, 1974; Gailleton and others, 2021"),
    ("Regression, fit", "Two lines through the same bins. The regression is plain least squares, made alike on every terrain: "
     "for comparing. The fit is robust (bins far from the line pull less) and knows <i>u</i> and <i>n</i>: for <i>k</i> and "
     "<i>m</i>. Their θ differ a little.", "Huber, 1964"),
    ("Relief (m)", "Highest minus lowest elevation.", ""),
    ("Receiver", "The lower neighbour that takes all the water of a node.", ""),
    ("Sweep", "One pass of the steady solver over all nodes: receivers are chosen anew, then every height is set so that "
     "erosion balances uplift. It is done when no receiver changes.", ""),
    ("dex", "A difference of decimal logarithms: 0.3 dex is a factor of two.", ""),
    ("Stream power <i>k</i>, <i>m</i>, <i>n</i>",
     "Rock is worn at the rate <i>k</i> <i>A</i><sup><i>m</i></sup> <i>S</i><sup><i>n</i></sup>. Where this balances uplift "
     "<i>u</i>, θ = <i>m</i>/<i>n</i> and <i>k</i><sub>s</sub> = (<i>u</i>/<i>k</i>)<sup>1/<i>n</i></sup>; so slopes and "
     "areas alone give neither <i>k</i> nor <i>m</i> without <i>u</i> and <i>n</i>.", "Whipple and Tucker, 1999"),
    ("Reference area <i>A</i><sub>0</sub> (m²)",
     "Area in the middle of the data. There the rate per unit slope, <i>k</i> <i>A</i><sub>0</sub><sup><i>m</i></sup>, is "
     "known best; <i>k</i> by itself is that value carried far outside the data, and its unit changes with <i>m</i>.", ""),
    ("Hypsometric curve and integral (–)", "Share of the area that lies above each relative height, and the area under that "
     "curve: (mean − min) / (max − min). A tilted plane has 0.5.", "Strahler, 1952"),
    ("Channel threshold (m²)", "Drainage area from which on a cell counts as river.", ""),
    ("Link, source, junction", "A link is the river between two junctions, or between a source (where a channel begins) or "
     "an outlet and the next junction.", "Shreve, 1966"),
    ("Strahler order (–)", "Links that begin at a source have order 1; where two or more of the same highest order meet, the "
     "order rises by one. A stream is a chain of links of one order.", "Strahler, 1957"),
    ("Shreve magnitude (–)", "Number of sources upstream.", "Shreve, 1966"),
    ("Bifurcation, length, area and slope ratio <i>R</i><sub>B</sub>, <i>R</i><sub>L</sub>, <i>R</i><sub>A</sub>, "
     "<i>R</i><sub>S</sub> (–)", "By what factor, from one order to the next, streams become fewer, longer, larger in "
     "area and gentler; here from the regression of the logarithm on order. Commonly 3–5, 1.5–3.5 and 3–6 for the first "
     "three.", "Horton, 1945; Schumm, 1956"),
    ("Drainage density (km/km²)", "Length of channels over the area they drain; its inverse is the ground that a unit "
     "length of channel needs (constant of channel maintenance).", "Horton, 1945; Schumm, 1956"),
    ("Complete catchment", "One whose whole upslope ground lies inside the data. Only these enter the statistics, since the "
     "areas of cut rivers are too small.", ""),
    ("95 % interval", "Would hold the true value in 95 of 100 repetitions if the law and the stated errors are right; it "
     "does not cover a wrong <i>u</i> or <i>n</i>.", ""),
    ("Distance, scale, verdict", "How far the two terrains lie apart in one aspect; how far realisations of the model lie "
     "apart from each other; whether the first is more than the second explains.", ""),
)


def html():
    items = (f"<dt>{term}</dt><dd>{text}" + (f' <span class="source">{source}.</span>' if source else "") + "</dd>"
             for term, text, source in ENTRIES)
    return '<dl class="glossary">' + "".join(items) + "</dl>"
