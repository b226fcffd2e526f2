# SPDX-License-Identifier: GPL-3.0-or-later
"""report.html of a study: one file that opens anywhere, without network or scripts."""
import base64
import itertools
import math
import os
import re
from html import escape

import curves
import glossary
import growth
import maps
import style
import summary_text
from data import get, reason
from study import Study
from words import DASH, Footnotes, fixed, height_decimals, interval, number, plain, show, table

HERE = os.path.dirname(os.path.realpath(__file__))
REAL = '<span class="real">real</span>'
SYNTHETIC = '<span class="synthetic">synthetic</span>'
GROWN = '<span class="grown">grown</span>'


def page(folder):
    """The whole page as text."""
    study = Study(folder)
    with open(os.path.join(HERE, "report.css"), encoding="utf-8") as stream:
        css = stream.read()
    sections = sections_of(study)
    body = [f'<section id="{key}"><h2><span class="no">{i}</span>{title}</h2>{build(study)}</section>'
            for i, (key, title, build) in enumerate(sections, 1)]
    links = "".join(f'<a href="#{key}">{title}</a>' for key, title, _ in sections)
    return (f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
            f'<meta name="viewport" content="width=device-width, initial-scale=1">'
            f'<title>{escape(study.name())}: real and synthetic terrain</title><style>{css}</style></head>\n<body><main>'
            f'{header(study, links)}{numbered("".join(body))}</main></body></html>\n')


def numbered(body):
    """Figures are numbered as they come, for not every study has all of them. Figure 1 is always there, and referred to."""
    numbers = itertools.count(1)
    return re.sub(r"<b>Figure \d+\.</b>", lambda _: f"<b>Figure {next(numbers)}.</b>", body)


def sections_of(study):
    """What the study has: an erosion law fitted and simulated, a network grown, or both."""
    sections = [("terrain", "The two terrains", terrains), ("slopes", "Slope and drainage area", slopes),
                ("shape", "Hypsometry and network", shape), ("numbers", "Numbers side by side", numbers),
                ("fit", "The fit", fit), ("comparison", "How far apart", comparison),
                ("run", "The simulation", simulation), ("notes", "Notes and warnings", notes),
                ("glossary", "What the numbers mean", lambda _: glossary.html()),
                ("provenance", "Provenance", provenance)]
    if study.grown_alone:
        sections = [each for each in sections if each[0] not in ("fit", "run")]
    if study.growth_fit:
        place = next(i for i, each in enumerate(sections) if each[0] == "notes")
        sections.insert(place, ("growth", "The grown network", grown))
    return sections


def header(study, links):
    version = get(study.manifest, "version")
    program = "Thalweg" + (f" {escape(str(version))}" if version else "")
    return (f'<header><p class="kicker">{program} · study report</p>'
            f"<h1>{escape(study.name())}: a real terrain and its {_twins(study)}</h1>"
            f"<nav>{links}</nav></header>"
            f'<p class="lead">{summary_text.sentences(study)}</p>{summary_text.headline(study)}')


def _twins(study):
    if study.grown:
        return "stream-power and grown twins"
    return "grown twin" if study.grown_alone else "stream-power twin"


def picture(content, kind, alt, caption, css=""):
    """A figure with its image inside the page."""
    source = f"data:image/{kind};base64,{base64.b64encode(content).decode()}"
    return (f'<figure class="{css}"><img src="{source}" alt="{escape(alt, quote=True)}">'
            f"<figcaption>{caption}</figcaption></figure>")


def terrains(study):
    whole = (study.step("measure/filled.tif"), study.step("measure/network.gpkg"))
    real = (whole[0], study.step(f"{study.real_step}/network.gpkg"), "Real")
    synthetic = (study.synthetic_raster(), study.step(f"{study.synthetic_step}/network.gpkg"), "Synthetic")
    overview, lowest = maps.single(*whole, studied=real[1] if study.real_step == "basin" else None)
    both = maps.pair(real, synthetic)
    threshold = plain(get(study.measure, "channels.threshold_area_m2", 0) / 1e6)
    rivers = "all rivers" if lowest == 1 else f"rivers of Strahler order {lowest} and above"
    return (picture(style.png(both, palette=True), "png",
                    "Two shaded relief maps beside each other: the real terrain and the simulated one, with their rivers.",
                    "<b>Figure 1.</b> Real and synthetic terrain at one scale and one "
                    "range of colours, lit from the north-west. Blue: rivers, wider with Strahler order; dark lines: "
                    "outlines of the catchments. Ground outside the simulated outline is pale.")
            + picture(style.png(overview, palette=True), "png",
                      f"Shaded relief map of {study.name()} with {rivers} in blue and basin outlines in dark grey.",
                      f"<b>Figure 2.</b> The whole measured terrain with {rivers} (channels begin at {threshold} km²; wider "
                      "with order) and the outlines of its larger catchments"
                      + (", the studied one drawn bold." if study.real_step == "basin" else "."),
                      "medium"))


def slopes(study):
    fitted = curves.fitted_line(study.fit, study.fit_table)
    drawing = curves.slope_area_pair(study.sides(), ("Real", "Synthetic"), fitted, study.theory, study.no_theory)
    theta = [show(get(side.terrain, "slope_area.theta")) for side in study.sides()]
    return picture(style.svg(drawing), "svg+xml",
                   "Slope against drainage area on logarithmic axes; concavity by regression "
                   f"{theta[0]} real, {theta[1]} synthetic.", f"<b>Figure 3.</b> {_slope_words(study, fitted)}")


def _slope_words(study, fitted):
    sized = any(side.cloud[2] is not None for side in study.sides())
    words = ["Slope against drainage area: single pieces of river (dots"
             + (", larger for longer pieces" if sized else "") + ") and means over bins of a tenth of a decade with their "
             "standard errors. Longer pieces count more in the means"
             + (", about as the area of their dots" if sized else "") + ": steep pieces are short, so that most dots "
             "can lie above the means."]
    if fitted:
        words.append("Full line: the <b>fit</b> (robust: outlying bins pull less), with its 95 % band; it gives <i>k</i> and "
                     "<i>m</i>.")
    words.append("Dashed line: the <b>regression</b>, plain least squares, made alike on both sides so that they can be "
                 "compared.")
    if study.theory:
        words.append("Dotted line: the steady state that the simulation aims at.")
    if study.no_theory:
        words.append(f"There is {study.no_theory}.")
    return " ".join(words)


def shape(study):
    integrals = [show(get(side.terrain, "hypsometry.integral")) for side in study.sides()]
    return (picture(style.svg(curves.hypsometry(study.sides())), "svg+xml",
                    f"Hypsometric curves; integral {integrals[0]} real, {integrals[1]} synthetic.",
                    "<b>Figure 4.</b> Hypsometric curves: the share of the area above each relative height.", "narrow")
            + picture(style.svg(curves.horton(study.sides())), "svg+xml",
                      "Four plots of stream number, mean length, mean drainage area and mean slope against Strahler order.",
                      "<b>Figure 5.</b> Horton’s laws: streams of each Strahler order, their mean length, drainage area and "
                      f"slope. The ratios are those of the regression lines.{_few_orders(study)}", "medium"))


def _few_orders(study):
    few = [side.label for side in study.sides() if len(side.terrain.get("strahler") or []) == 2]
    return f" With two orders only ({' and '.join(few)}) a line merely joins two points." if few else ""


HEIGHT = "heights"  # in place of digits: as many decimals as suit the relief
RELIEF = "relief"   # in place of a path

#: label, factor to the shown unit, unit, digits, paths (the first that exists counts)
ROWS = (
    ("Ground",),
    ("Area", 1e-6, "km²", 4, "input.area_m2", "domain_area_m2"),
    ("Lowest elevation", 1, "m", HEIGHT, "input.elevation_min_m"),
    ("Highest elevation", 1, "m", HEIGHT, "input.elevation_max_m", "elevation_max_m"),
    ("Mean elevation", 1, "m", HEIGHT, "input.elevation_mean_m", "elevation_mean_m"),
    ("Relief (highest − lowest)", 1, "m", HEIGHT, RELIEF),
    ("Hypsometric integral", 1, "", 3, "hypsometry.integral"),
    ("Skewness of the hypsometric curve", 1, "", 3, "hypsometry.skewness"),
    ("Kurtosis of the hypsometric curve", 1, "", 3, "hypsometry.kurtosis"),
    ("Slope and area",),
    ("Concavity θ, regression", 1, "", 4, "slope_area.theta"),
    ("Steepness <i>k</i><sub>s</sub>, regression", 1, "m<sup>2θ</sup>", 3, "slope_area.ks"),
    ("Goodness of the regression, <i>r</i>²", 1, "", 3, "slope_area.r2"),
    ("Channels",),
    ("Channel threshold", 1e-6, "km²", 3, "channels.threshold_area_m2"),
    ("Share of channels in complete catchments", 100, "%", 3, "channels.share_used"),
    ("Sources", 1, "", 3, "channels.sources"),
    ("Links", 1, "", 3, "channels.links"),
    ("Junctions", 1, "", 3, "channels.junctions"),
    ("Total length", 1e-3, "km", 4, "channels.total_length_m"),
    ("Drainage density", 1e3, "km/km²", 3, "channels.drainage_density_per_m"),
    ("Constant of channel maintenance", 1, "m", 3, "channels.constant_of_channel_maintenance_m"),
    ("Highest Strahler order", 1, "", 3, "channels.max_strahler"),
    ("Highest Shreve magnitude", 1, "", 3, "channels.max_shreve"),
    ("Horton’s ratios (regression)",),
    ("Bifurcation ratio <i>R</i><sub>B</sub>", 1, "", 3, "horton.RB.regression"),
    ("Length ratio <i>R</i><sub>L</sub>", 1, "", 3, "horton.RL.regression"),
    ("Area ratio <i>R</i><sub>A</sub>", 1, "", 3, "horton.RA.regression"),
    ("Slope ratio <i>R</i><sub>S</sub>", 1, "", 3, "horton.RS.regression"),
    ("More of the network",),
    ("Tokunaga <i>a</i>", 1, "", 3, "tokunaga.a"),
    ("Tokunaga <i>c</i>", 1, "", 3, "tokunaga.c"),
    ("Hack’s exponent", 1, "", 3, "hack.exponent"),
    ("Flint’s exponent <i>q</i>", 1, "", 3, "flint.q"),
    ("Exterior over interior link length", 1, "", 3, "links.exterior_interior_ratio"),
    ("Mean junction angle", 1, "°", 3, "junctions.mean_angle_deg"),
    ("Steepness <i>k</i><sub>sn</sub> (median)", 1, "m<sup>2θ</sup>", 3, "chi.ksn_median"),
)
OPTIONAL = ("More of the network",)  # shown only where measured


def numbers(study):
    footnotes, rows = Footnotes(), []
    optional = False
    which_sides = range(len(study.all_sides()))
    reliefs = [each[2] for each in map(study.relief, which_sides) if each]
    decimals = height_decimals(max(reliefs, default=0))
    for row in ROWS:
        if len(row) == 1:
            optional = row[0] in OPTIONAL
            rows.append(list(row))
            continue
        label, factor, unit, digits, *paths = row
        found = [_found(study, which, paths) for which in which_sides]
        if digits == HEIGHT:
            rows.append([label, *(DASH + footnotes.mark(why) if value is None else fixed(value, decimals)
                                  for value, why in found), unit])
            continue
        if optional and all(value is None for value, _ in found):
            continue
        rows.append([label, *(_cell(value, factor, digits, why, footnotes) for value, why in found), unit or DASH])
    rows = [row for i, row in enumerate(rows) if len(row) > 1 or (i + 1 < len(rows) and len(rows[i + 1]) > 1)]
    covers = f"<p>{'All' if study.grown else 'Both'} sides were measured by the same code. The real one covers {_coverage(study)}.</p>"
    names = [REAL, SYNTHETIC] + ([GROWN] if study.grown else [])
    return covers + table(["", *names, "unit"], rows, "numbers-table") + footnotes.html()


def _found(study, which, paths):
    if RELIEF in paths:
        relief = study.relief(which)
        return (None, "") if relief is None else (relief[2], "")
    return study.value(which, *paths)


def _coverage(study):
    return ("the largest complete catchment of the DEM, the ground that was simulated" if study.real_step == "basin"
            else "the complete catchments of the DEM")


def _cell(value, factor, digits, why, footnotes):
    if value is None:
        return DASH + footnotes.mark(why)
    if isinstance(value, (int, float)) and not isinstance(value, bool) and factor != 1:
        value = float(value) * factor
    return show(value, digits)


FIT_ROWS = (
    ("Concavity θ = <i>m</i>/<i>n</i>, fit", "theta", "theta_se", "theta_ci95", "", 4),
    ("Area exponent <i>m</i>", "m", "m_se", "m_ci95", "", 4),
    ("<i>k</i> <i>A</i><sub>0</sub><sup><i>m</i></sup> at the reference area", "k_at_reference_area",
     "k_at_reference_area_se", "k_at_reference_area_ci95", "m/yr", 3),
    ("Erodibility <i>k</i>", "k", "k_se", "k_ci95", "m<sup>1−2<i>m</i></sup>/yr", 3),
    ("Steepness <i>k</i><sub>s</sub>, fit", "ks", "ks_se", "ks_ci95", "m<sup>2θ</sup>", 3),
    ("<i>k</i>/<i>u</i>", "k_over_uplift", "k_over_uplift_se", "k_over_uplift_ci95", "m<sup>−2<i>m</i></sup>", 3),
)


def fit(study):
    content = study.fit
    if not content:
        return "<p>No fit was made.</p>"
    footnotes, rows = Footnotes(), []
    for label, key, error, bounds, unit, digits in FIT_ROWS:
        if key not in content:
            continue
        value = content[key]
        why = footnotes.mark(reason(content, key)) if value is None else ""
        spread = interval(content.get(bounds), digits) or _two_errors(value, content.get(error), digits)
        rows.append([label, show(value, digits) + why, number(content.get(error), 2), spread or DASH, unit or DASH])
    return (_fit_words(content) + _two_thetas(study) + table(["", "value", "standard error", "95 % interval", "unit"], rows)
            + footnotes.html() + _caveats(content))


def _two_thetas(study):
    plain_theta, fitted_theta = get(study.real.terrain, "slope_area.theta"), study.fit.get("theta")
    if plain_theta is None or fitted_theta is None:
        return ""
    return (f"<p>The fit is robust (outlying bins pull less) and gives θ = {number(float(fitted_theta), 3)}; the plain "
            f"regression on the same catchment, which section 4 sets beside the synthetic one’s, gives "
            f"{number(float(plain_theta), 3)}.</p>")


def _two_errors(value, error, digits):
    """The interval of a quantity that cannot be negative: normal in its logarithm."""
    if not isinstance(value, (int, float)) or not isinstance(error, (int, float)):
        return ""
    if value <= 0:
        return interval([value - 1.96 * error, value + 1.96 * error], digits)
    factor = math.exp(1.96 * error / value)
    return interval([value / factor, value * factor], digits)


def _fit_words(content):
    method = escape(str(content.get("method") or "slope-area"))
    low, high = content.get("area_range_m2") or [None, None]
    area = "" if low is None or high is None else f" between {number(low / 1e6)} and {number(high / 1e6)} km²"
    given = f"<i>n</i> = {plain(content.get('n'))}"
    uplift = content.get("uplift_m_per_yr")
    if uplift is not None:
        given += f" and an uplift of {plain(uplift * 1000)} mm/yr"
    state = "converged" if content.get("converged") else "did not converge"
    message = f" ({escape(str(content['message']))})" if content.get("message") else ""
    message = "" if content.get("converged") else message
    ground = f" of {escape(content['covers'])}" if content.get("covers") else ""
    return (f"<p>Method <i>{method}</i> on drainage areas{area}{ground}, given {given}. It {state} in "
            f"{show(content.get('iterations'))} iterations{message}; reduced χ² {show(content.get('reduced_chi2'))}.</p>")


def _caveats(content):
    points = []
    if content.get("uplift_m_per_yr") is None:
        points.append("No uplift rate was given: slope and area alone tell θ and the ratio of uplift to erodibility, not "
                      "<i>k</i> itself.")
    else:
        points.append("<i>k</i> is as good as the uplift rate it was given: twice the uplift would make twice the "
                      "<i>k</i>, with the same slopes. Another <i>n</i> would change <i>k</i> and <i>m</i> both.")
    area = content.get("reference_area_m2")
    if area is not None:
        points.append(f"Compare with other fits <i>k</i> <i>A</i><sup><i>m</i></sup> at one area, near the reference area "
                      f"<i>A</i><sub>0</sub> = {number(area / 1e6)} km², rather than <i>k</i>: log <i>k</i> and <i>m</i> are "
                      f"correlated at {show(content.get('correlation_log_k_m'))}.")
    bend, error = get(content, "steady_check.curvature"), get(content, "steady_check.curvature_se")
    if bend is not None and error is not None:
        straight = "as far as the data tell the line is straight" if abs(bend) < 2 * error else (
            "the line is bent, so one <i>k</i> and <i>m</i> do not describe all of it")
        points.append(f"A steady network on one rock gives a straight line. A square term in it comes out as {show(bend)} ± "
                      f"{number(error, 2)}: {straight}.")
    points.append("The law assumes that incision balances uplift everywhere along these rivers, on one rock and under one "
                  "climate; where it does not, the numbers are averages that fit, not properties of the rock.")
    return "<ul>" + "".join(f"<li>{point}</li>" for point in points) + "</ul>"


def comparison(study):
    aspects = study.comparison.get("aspects") or []
    if not aspects:
        return "<p>The two terrains were not compared.</p>"
    footnotes, rows = Footnotes(), []
    for aspect in aspects:
        name = str(aspect.get("name", ""))
        title = ASPECTS.get(name, name.replace("_", " ").capitalize())
        quantity = QUANTITIES.get(aspect.get("quantity"), escape(str(aspect.get("quantity") or "")))
        cells = [_aspect_cell(study, aspect, key, footnotes) for key in ("a", "b", "distance", "scale", "verdict")]
        cells[2] += footnotes.mark(_sides_named(aspect.get("distance_definition") or ""))
        rows.append([escape(title) + (f" ({quantity})" if quantity else ""), *cells])
    head = ["aspect", REAL, SYNTHETIC, "distance", "scale (model’s own spread)", "verdict"]
    return table(head, rows) + _scale_words(study.comparison) + footnotes.html()


def _scale_words(content):
    """How verdicts come about; nothing where none are given."""
    count = content.get("realisations")
    if not count:
        return ""
    return (f"<p>The model was run with {count} other seeds. The scale is the median distance between two of these terrains; a "
            "difference is beyond the model’s own scatter where fewer than one in twenty of their pairs differ as much. "
            "With so many aspects, one may well be so by chance.</p>")


def _sides_named(definition):
    """The comparison says a and b; the table over the footnotes says real and synthetic."""
    definition = re.sub(r"\b([Oo]f|in|for) a(?=\s*(?:[/,;)−–-]|$))", r"\1 real", definition)
    return re.sub(r"\b([Oo]f|in|for|over) b\b", r"\1 synthetic", definition)


ASPECTS = {"slope_area": "Slope–area", "horton": "Horton’s ratios"}
QUANTITIES = {"theta": "θ, regression", "relief_m": "m", "RB": "<i>R</i><sub>B</sub>", "q": "<i>q</i>", "c": "<i>c</i>",
              "mean length of all links (m)": "mean of all, m", "mean angle (deg)": "mean, °",
              "area exceedance exponent": "exponent of the areas’ exceedance",
              "mean distance of the channels from the mouth over the greatest": "mean distance from the mouth over the greatest"}


def _aspect_cell(study, aspect, key, footnotes):
    value = aspect.get(key)
    why = reason(study.comparison, f"{aspect.get('name')}.{key}") if value is None else ""
    return show(value) + footnotes.mark(why)


def simulation(study):
    run = study.simulate
    words = summary_text.run_sentence(run, get(study.experiment, "time.solver"))
    if not study.history:
        return words
    return words + picture(style.svg(curves.history(study.history)), "svg+xml",
                           "Highest and mean elevation, and the largest rate of change, against time.",
                           "<b>Figure 6.</b> The simulated terrain on its way: elevation, and how fast it still changes.")


def grown(study):
    """What a network grown by empirical rules has in common with the real one."""
    words = (f"<p>A network was grown in the basin by the rules of Kelley, Malin &amp; Nielson (1988): "
             f"{show(study.grow.get('links'))} links, with dials found by growing networks until they measure like the real "
             "one; the surface under tension over it was measured like any DEM.</p>")
    pictures = _grown_pictures(study) if study.grown else ""
    check = picture(style.svg(growth.check(study.growth_fit)), "svg+xml",
                    "Measures of grown networks over those of the real one, with their spread.",
                    f"<b>Figure {10 if study.grown else 6}.</b> What networks grown with these dials measure, over what the real one measures. Where a "
                    "bar misses the line, the rules of growth do not make such networks, whatever the dials.", "medium")
    return words + pictures + check + _dials(study) + _grown_comparison(study)


def _grown_pictures(study):
    real = (study.step(f"{study.real_step}/filled.tif"), study.step(f"{study.real_step}/network.gpkg"), "Real")
    beside = (study.step("grow/elevation.tif"), study.step("grown/network.gpkg"), "Grown")
    names = "real, stream-power and grown"
    return (picture(style.png(maps.pair(real, beside), palette=True), "png",
                    "Shaded relief maps of the real and of the grown terrain, with their rivers.",
                    "<b>Figure 7.</b> The studied catchment and the grown terrain, at one scale and one range of colours; as "
                    "in Figure 1, blue lines are rivers, wider with Strahler order.")
            + picture(style.svg(curves.hypsometry(study.all_sides())), "svg+xml", f"Hypsometric curves: {names}.",
                      f"<b>Figure 8.</b> Hypsometric curves: {names}.", "narrow")
            + picture(style.svg(curves.horton(study.all_sides())), "svg+xml", f"Horton plots: {names}.",
                      f"<b>Figure 9.</b> Horton’s laws: {names}.", "medium"))


def _dials(study):
    rows = []
    for name, dial in (study.growth_fit.get("growth") or {}).items():
        open_words = "" if dial.get("identified") else " (left open by the network)"
        words, unit = growth.DIALS.get(name, ("", DASH))
        rows.append([f"<code>{escape(name)}</code> {words}{open_words}", show(dial.get("estimate"), 4),
                     number(dial.get("standard_error"), 2), interval(dial.get("ci95"), 3) or DASH, unit,
                     show(dial.get("count"))])
    return ("<p>The dials, with which <code>thalweg grow growth_fit/growth.toml</code> grows another network of the kind:</p>"
            + table(["dial", "value", "standard error", "95 % interval", "unit", "places it was measured at"], rows))


def _grown_comparison(study):
    """Both models' distances from the real terrain; where growth stands alone, section "How far apart" has them."""
    if not study.grown:
        return ""
    eroded = {aspect["name"]: aspect for aspect in study.comparison.get("aspects") or []}
    judged = bool(study.grown_comparison.get("realisations"))
    keys = ("distance", "scale") if judged else ("distance",)
    rows = [[escape(ASPECTS.get(aspect["name"], aspect["name"].replace("_", " ").capitalize())),
             *(show(side.get(key)) for side in (eroded.get(aspect["name"], {}), aspect) for key in keys),
             *([escape(aspect.get("verdict") or DASH)] if judged else [])]
            for aspect in study.grown_comparison.get("aspects") or []]
    head = [SYNTHETIC, "its scale", GROWN, "its scale", "verdict on the grown one"] if judged else [SYNTHETIC, GROWN]
    return ("<p>Distances from the real terrain, defined as in the section <i>How far apart</i>; smaller is closer.</p>"
            + table(["aspect", *head], rows))


def notes(study):
    found = study.notes()
    if not found:
        return "<p>Nothing was noted.</p>"
    lines = [(quiet, f"<li><b>{step}</b>{' · ' + escape(key) if key else ''}: {escape(text)}</li>")
             for step, key, text, quiet in found]
    warnings, reasons = ("".join(line for quiet, line in lines if quiet == wanted) for wanted in (False, True))
    return ((f"<ul>{warnings}</ul>" if warnings else "<p>No warnings.</p>")
            + (f"<details><summary>Why some values are empty</summary><ul>{reasons}</ul></details>" if reasons else ""))


#: Left out: what changes from run to run, and lists that are better read in the manifest itself.
UNSHOWN = ("seconds", "timing", "date", "time", "threads", "input", "outputs", "files", "notes", "warnings",
           "experiment", "parameters", "program")


def provenance(study):
    rows = [[label, show(get(study.measure, path))] for label, path in
            (("DEM", "input.file"), ("SHA-256", "input.sha256"), ("Coordinate system", "input.crs"))]
    rows += [[label, show(found)] for label, found in
             ((label, get(study.measure, f"input.provenance.{key}")) for label, key in
              (("Data", "title"), ("Obtained from", "obtained_from"), ("Heights", "vertical"), ("Licence", "licence"),
               ("Please cite", "citation"))) if found]
    grid = [get(study.measure, f"input.{key}") for key in ("rows", "cols", "dx_m", "dy_m")]
    if None not in grid:
        rows.append(["Grid", f"{grid[0]} rows × {grid[1]} columns, cells of {number(grid[3], 4)} m north–south × "
                             f"{number(grid[2], 4)} m east–west"])
    rows += [[escape(key.replace("_", " ").capitalize()), _value(key, value)] for key, value in study.manifest.items()
             if not key.lower().startswith(UNSHOWN)]
    resolved = "".join(f"<details><summary>The experiment{of}, every value resolved</summary><pre>{text}</pre></details>"
                       for of, text in _experiments(study))
    return (table(["", ""], rows, "text") + "<p>Every file and its checksum stand in <code>manifest.json</code>.</p>" + resolved)


def _value(key, value):
    if key in ("command", "argv") and isinstance(value, list):
        return f"<code>{escape(' '.join(map(str, value)))}</code>"
    if isinstance(value, list):
        separator = "<br>" if any(isinstance(each, dict) for each in value) else ", "
        return separator.join(show(each) for each in value)
    return show(value, 8)


def _experiments(study):
    """What each model was run with, the values found among it; where there is none of it, what the study was asked for."""
    found = []
    for of, folder in ((" that was simulated", "simulate"), (" that was grown", "grow"), ("", "")):
        path = study.step(os.path.join(folder, "experiment.toml"))
        if os.path.exists(path) and (folder or not found):
            with open(path, encoding="utf-8") as stream:
                found.append((of, escape(stream.read())))
    return found
