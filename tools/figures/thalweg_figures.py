#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures and report of the thalweg commands: thalweg_figures.py analyze|simulate|grow|fit|compare|report|study DIR

Reads what a command wrote into DIR and adds DIR/figures/*.png; for `report`, DIR/report.html from the folders of a whole
study; for `study`, that report and the figures of its main steps at once, on two processors. Bytes depend on the
files read alone. Exit code 1 and one line on stderr when something needed is not there.
"""
import multiprocessing
import os
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))


def figures_of_analyze(folder):
    import curves, maps, sides
    side = sides.from_folder(folder, "measured", "real")
    yield "map", maps.single(_file(folder, "filled.tif"), _file(folder, "network.gpkg"))[0]
    yield "hypsometry", curves.hypsometry([side])
    yield "slope_area", curves.slope_area(side, regression=curves.summary_line(side))
    yield "horton", curves.horton([side])


def figures_of_simulate(folder):
    import curves, maps, sides
    from data import read_csv
    side = sides.from_folder(folder, "simulated", "synthetic")
    yield "map", maps.single(_file(folder, "elevation.tif"), _file(folder, "network.gpkg"))[0]
    yield "hypsometry", curves.hypsometry([side])
    theory, remark = sides.theory(folder, side)
    yield "slope_area", curves.slope_area(side, theory=theory, remark=remark)
    yield "horton", curves.horton([side])
    history = read_csv(folder, "history.csv")
    if any(len(column) for column in history.values()):
        yield "history", curves.history(history)


def figures_of_grow(folder):
    import curves, maps, sides
    side = sides.from_folder(folder, "grown", "synthetic")
    yield "map", maps.single(_file(folder, "elevation.tif"), _file(folder, "network.gpkg"))[0]
    yield "hypsometry", curves.hypsometry([side])
    yield "slope_area", curves.slope_area(side, regression=curves.summary_line(side))
    yield "horton", curves.horton([side])


def figures_of_fit(folder):
    import curves, style
    from data import read_csv, require_json
    fit, table = require_json(folder, "fit.json"), read_csv(folder, "fit.csv")
    if fit.get("method") == "growth":
        import growth
        yield "growth", growth.check(fit)
        return
    side = curves.Side("target", style.LOOK["real"])
    side.bins = tuple(table.get(name, ()) for name in ("area_m2", "slope", "slope_se"))
    yield "slope_area", curves.slope_area(side, curves.fitted_line(fit, table))


def figures_of_compare(folder):
    import curves, sides
    from data import require_json
    comparison = require_json(folder, "comparison.json")
    pair = [sides.from_comparison(comparison, "a", folder, sides.name_of(comparison, "a"), "real"),
            sides.from_comparison(comparison, "b", folder, sides.name_of(comparison, "b"), "synthetic")]
    yield "slope_area", curves.slope_area_pair(pair, [side.label for side in pair])
    yield "hypsometry", curves.hypsometry(pair)
    yield "horton", curves.horton(pair)


FIGURES = {"analyze": figures_of_analyze, "simulate": figures_of_simulate, "grow": figures_of_grow, "fit": figures_of_fit,
           "compare": figures_of_compare}


def _file(folder, name):
    return os.path.join(folder, name)


def write(path, content):
    """Whole or not at all."""
    handle, temporary = tempfile.mkstemp(dir=os.path.dirname(path), prefix=".figure")
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except OSError:
        os.unlink(temporary)
        raise


#: What is drawn of a study, slowest first: the whole DEM and the synthetic raster are seen in the report alone.
STEPS = (("report", ""), ("simulate", "simulate"), ("analyze", "basin"), ("compare", "compare"), ("fit", "fit"),
         ("fit", "growth_fit"))


def run_study(folder):
    """All of a study's figures; what Python loads is loaded once, before the processes part."""
    import curves, maps, report, sides  # noqa: F401
    tasks = [(command, os.path.join(folder, step)) for command, step in STEPS if os.path.isdir(os.path.join(folder, step))]
    with multiprocessing.get_context("fork").Pool(min(2, os.cpu_count() or 1)) as pool:
        pool.starmap(run, tasks, chunksize=1)


def run(command, folder):
    import style
    style.prepare()
    if command == "study":
        run_study(folder)
        return
    if command == "report":
        import report
        write(os.path.join(folder, "report.html"), report.page(folder).encode())
        return
    target = os.path.join(folder, "figures")
    os.makedirs(target, exist_ok=True)
    for name, drawing in FIGURES[command](folder):
        write(os.path.join(target, name + ".png"), style.png(drawing, palette=name == "map"))


def main(arguments):
    commands = [*FIGURES, "report", "study"]
    if len(arguments) != 2 or arguments[0] not in commands:
        print(f"usage: thalweg_figures.py {'|'.join(commands)} DIR", file=sys.stderr)
        return 1
    if not os.path.isdir(arguments[1]):
        print(f"{arguments[1]} is not a folder", file=sys.stderr)
        return 1
    try:
        run(*arguments)
    except Exception as error:  # the caller shows one line, whatever it is
        print(f"{type(error).__name__}: {error}".replace("Missing: ", "").splitlines()[0], file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
