# SPDX-License-Identifier: GPL-3.0-or-later
"""What was done, in plain sentences with numbers, and the numbers to remember."""
from html import escape

from data import get
from words import fixed, height_decimals, number, plain, quantity


def sentences(study):
    """What was measured, what it was fitted with, how the synthetic terrain came out, and how high both are."""
    return " ".join(filter(None, (measured(study), fitted(study), compared(study), grown(study), heights(study))))


def measured(study):
    source = study.measure.get("input") or {}
    low, high = source.get("elevation_min_m"), source.get("elevation_max_m")
    between = "" if low is None or high is None else f"{_span(low, high)} m high"
    ground = ", ".join(filter(None, (_clause(source.get("area_m2"), lambda v: f"{number(v / 1e6, 4)} km² of ground"),
                                     between)))
    words = f"The terrain in <i>{escape(study.name())}</i>" + (f" ({ground})" if ground else "") + " was measured"
    channels = study.real.terrain.get("channels") or {}
    rivers = _clause(channels.get("links"), lambda v: f" with {number(v)} river links from "
                     f"{plain((channels.get('threshold_area_m2') or 0) / 1e6)} km² of drainage area on")
    if study.real_step != "basin":
        return words + rivers + "."
    area = study.value(0, "input.area_m2")[0]
    return f"{words}, and its largest complete catchment ({_clause(area, lambda v: f'{number(v / 1e6)} km²')}) studied{rivers}."


def fitted(study):
    fit = study.fit
    if fit.get("theta") is None:
        return ""
    text = (f"Slopes fall with drainage area to the power −{number(fit['theta'], 3)}"
            + (f" ± {number(fit['theta_se'], 2)}" if fit.get("theta_se") else "") + " (the fit’s θ)")
    if fit.get("k") is None or fit.get("m") is None:
        return text + "; without an uplift rate this does not tell <i>k</i>."
    given = f"; with uplift of {plain((fit.get('uplift_m_per_yr') or 0) * 1000)} mm/yr and <i>n</i> = {plain(fit.get('n'))}"
    exponent = f"<i>m</i> = {number(fit['m'], 3)}{_between(fit.get('m_ci95'))}"
    alone = f"<i>k</i> = {number(fit['k'])} m<sup>1−2<i>m</i></sup>/yr{_between(fit.get('k_ci95'))}"
    area, there = fit.get("reference_area_m2"), fit.get("k_at_reference_area")
    if area is None or there is None:
        return f"{text}{given} that means {alone} and {exponent}."
    return (f"{text}{given} that means erosion at <i>k</i> <i>A</i><sub>0</sub><sup><i>m</i></sup> = {number(there)} m/yr"
            f"{_between(fit.get('k_at_reference_area_ci95'))} per unit of slope where <i>A</i><sub>0</sub> = "
            f"{number(area / 1e6)} km² drain through, and {exponent}. Carried from there down to 1 m² it is {alone}.")


def _between(pair):
    """A 95 % interval in words, or nothing."""
    if not isinstance(pair, (list, tuple)) or len(pair) != 2 or None in pair:
        return ""
    return f" (95 %: {number(float(pair[0]))} to {number(float(pair[1]))})"


def _span(low, high):
    decimals = height_decimals(high - low)
    return f"{fixed(low, decimals)} to {fixed(high, decimals)}"


def compared(study):
    nodes = study.simulate.get("nodes")
    text = "A stream-power landscape" + (f" of {number(nodes)} nodes" if nodes is not None else "") + " simulated with these values"
    if study.grown_alone:
        text = f"A network of {number(study.grow.get('links'))} links grown there with measured dials, and the surface over it,"
    return f"{text} {_measures(study, 1)}."


def grown(study):
    """The network that was grown beside the simulation."""
    if not study.grown:
        return ""
    return (f"A network of {number(study.grow.get('links'))} links grown there by empirical rules, with a surface over it, "
            f"{_measures(study, 2)}.")


def _measures(study, which):
    """What one of the synthetic terrains has, and what the real one."""
    pairs = []
    for label, path, digits in (("a hypsometric integral of", "hypsometry.integral", 3),
                                ("a concavity θ by regression of", "slope_area.theta", 3),
                                ("a bifurcation ratio of", "horton.RB.regression", 3)):
        real, synthetic = (study.value(each, path)[0] for each in (0, which))
        if real is not None and synthetic is not None:
            pairs.append(f"{label} {number(synthetic, digits)} (real: {number(real, digits)})")
    if not pairs:
        return "stands beside it"
    return f"has {', '.join(pairs[:-1])}{' and ' if len(pairs) > 1 else ''}{pairs[-1]}"


def heights(study):
    """How high both terrains rise, and where they differ much, why."""
    real, synthetic = study.relief(0), study.relief(1)
    if real is None or synthetic is None:
        return ""
    decimals = height_decimals(max(real[2], synthetic[2]))
    words = (f"The real ground rises {fixed(real[2], decimals)} m from its lowest to its highest point, the synthetic one "
             f"{fixed(synthetic[2], decimals)} m")
    third = study.relief(2) if study.grown else None
    if third is not None:
        words = words.replace("synthetic one", "stream-power one") + f" and the grown one {fixed(third[2], decimals)} m"
    if min(real[2], synthetic[2]) <= 0:
        return words + "."
    ratio = synthetic[2] / real[2]
    if 1 / FAR_OFF <= ratio <= FAR_OFF:
        return words + "."
    if third is not None:
        words += "; the stream-power one"
    return f"{words}, {number(ratio, 2)} times as much. {_why_relief_differs(study)}"


FAR_OFF = 1.3  # ratio of reliefs that asks for an explanation


def _why_relief_differs(study):
    """What the fit leaves open: it holds slopes against areas on channels, not the ways of the water nor the hillslopes."""
    talus = get(study.experiment, "hillslope.talus_angle_deg")
    slopes = "hillslopes follow the law of rivers" + (f" or stand at the talus limit of {plain(talus)}°" if talus else "")
    length = [study.value(which, "channels.total_length_m")[0] for which in (0, 1)]
    ways = "other ways"
    if None not in length and length[0] > 0:
        ways += f", in all {number(length[1] / length[0], 2)} times as long as the real ones"
    return (f"The fitted law holds on channels only: the synthetic rivers take {ways}, and the synthetic {slopes}, which real "
            "ones need not.")


def headline(study):
    """The handful of numbers that a reader takes away."""
    cards = [_relief_card(study)]
    for title, path, factor, digits in (("Concavity θ, regression (–)", "slope_area.theta", 1, 3),
                                        ("Hypsometric integral (–)", "hypsometry.integral", 1, 3),
                                        ("Drainage density (km/km²)", "channels.drainage_density_per_m", 1e3, 3),
                                        ("Bifurcation ratio (–)", "horton.RB.regression", 1, 3)):
        all_sides = [study.value(which, path)[0] for which in range(len(study.all_sides()))]
        cards.append(_card(title, [number(None if value is None else float(value) * factor, digits) for value in all_sides]))
    third = "&ensp;<span class=\"grown\">■ grown</span> " if study.grown else ""
    return ('<div class="numbers">' + "".join(cards) + "</div><p class=\"footnotes\"><span class=\"real\">● real</span> "
            f"&ensp;<span class=\"synthetic\">▲ synthetic</span> {third}– the same colours and marks throughout.</p>")


def _card(title, shown):
    values = "".join(f'<span><i class="{side}" title="{side}"></i>{value}</span>'
                     for side, value in zip(("real", "synthetic", "grown"), shown))
    return f"<div><b>{title}</b>{values}</div>"


def _relief_card(study):
    reliefs = [study.relief(which) for which in range(len(study.all_sides()))]
    decimals = height_decimals(max((each[2] for each in reliefs if each), default=0))
    return _card("Relief (m)", [fixed(each and each[2], decimals) for each in reliefs])


def run_sentence(run, solver):
    """How the simulation went."""
    nodes = _clause(run.get("nodes"), lambda v: f"{number(v)} nodes, ")
    steps = _clause(run.get("steps"), lambda v: f"{number(v)} {'sweeps of the steady solver' if solver == 'steady' else 'steps'}")
    time = _clause(run.get("time_yr"), lambda v: f" ({quantity(v / 1e6, 'Myr')})" if v else "")
    why = _clause(run.get("stop_reason"), lambda v: f": {escape(str(v))}")
    state = {True: "converged", False: "did not converge"}.get(run.get("converged"), "ended")
    residual = _clause(get(run, "mass_balance.relative_residual"),
                       lambda v: f" Its mass balance closes to {number(v, 2)} of the uplifted volume.")
    return f"<p>{nodes}{steps}{time}; the run {state}{why}.{residual}</p>"


def _clause(value, words):
    return "" if value is None else words(value)
