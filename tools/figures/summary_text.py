# SPDX-License-Identifier: GPL-3.0-or-later
"""What was done, in plain sentences with numbers, and the numbers to remember."""
from html import escape

from data import get
from words import number, plain, quantity


def sentences(study):
    """Three sentences: what was measured, what it was fitted with, how the synthetic terrain came out."""
    return " ".join(filter(None, (measured(study), fitted(study), compared(study))))


def measured(study):
    source = study.measure.get("input") or {}
    ground = ", ".join(filter(None, (
        _clause(source.get("area_m2"), lambda v: f"{number(v / 1e6, 4)} km² of ground"),
        _clause(source.get("elevation_min_m"), lambda v: f"{number(float(v), 4)} to "
                f"{quantity(source.get('elevation_max_m'), 'm', 4)} high"))))
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
            + (f" ± {number(fit['theta_se'], 2)}" if fit.get("theta_se") else ""))
    if fit.get("k") is None or fit.get("m") is None:
        return text + "; without an uplift rate this does not tell <i>k</i>."
    return (text + f"; with uplift of {plain((fit.get('uplift_m_per_yr') or 0) * 1000)} mm/yr and <i>n</i> = "
            f"{plain(fit.get('n'))} that means <i>k</i> = {number(fit['k'])} m<sup>1−2<i>m</i></sup>/yr and <i>m</i> = "
            f"{number(fit['m'], 3)}.")


def compared(study):
    nodes = study.simulate.get("nodes")
    text = "A stream-power landscape" + (f" of {number(nodes)} nodes" if nodes is not None else "") + " grown with these values"
    pairs = []
    for label, path, digits in (("a hypsometric integral of", "hypsometry.integral", 3),
                                ("a concavity of", "slope_area.theta", 3),
                                ("a bifurcation ratio of", "horton.RB.regression", 3)):
        real, synthetic = (study.value(which, path)[0] for which in (0, 1))
        if real is not None and synthetic is not None:
            pairs.append(f"{label} {number(synthetic, digits)} (real: {number(real, digits)})")
    if not pairs:
        return text + " stands beside it."
    return f"{text} has {', '.join(pairs[:-1])}{' and ' if len(pairs) > 1 else ''}{pairs[-1]}."


def headline(study):
    """The handful of numbers that a reader takes away."""
    cards = []
    for title, path, factor, digits in (("Concavity θ (–)", "slope_area.theta", 1, 3),
                                        ("Hypsometric integral (–)", "hypsometry.integral", 1, 3),
                                        ("Drainage density (km/km²)", "channels.drainage_density_per_m", 1e3, 3),
                                        ("Bifurcation ratio (–)", "horton.RB.regression", 1, 3)):
        both = [study.value(which, path)[0] for which in (0, 1)]
        shown = [number(None if value is None else float(value) * factor, digits) for value in both]
        cards.append(f'<div><b>{title}</b><span><i class="real" title="real"></i>{shown[0]}</span>'
                     f'<span><i class="synthetic" title="synthetic"></i>{shown[1]}</span></div>')
    return ('<div class="numbers">' + "".join(cards) + "</div><p class=\"footnotes\"><span class=\"real\">● real</span> "
            "&ensp;<span class=\"synthetic\">▲ synthetic</span> – the same colours and marks throughout.</p>")


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
