# SPDX-License-Identifier: GPL-3.0-or-later
"""Cost of one item as there are more of them: fits t ~ N^exponent to each series and draws it.

    ./run bench --benchmark_filter='worst_lakes|grow_network|chain_by_cells' --benchmark_format=json > scaling.json
    python3 bench/scaling.py scaling.json [FOLDER]

Prints the exponents; with a FOLDER writes NAME_scaling.png there for each case below of which the file holds runs.
"""
import json
import math
import sys
from pathlib import Path

# case: (benchmark, what N counts, the counter or argument that holds it, which clock, series by argument, title)
CASES = {
    "lake": ("drain_worst_lakes", "nodes", "cpu_time", "surface",
             {"0": "random surface", "1": "bowl of bowls", "2": "comb"}, "routing and draining all lakes"),
    "growth": ("grow_network", "links", "cpu_time", None, {None: "growing"}, "growing the network"),
    # one thread by its processor time, which others on the machine disturb less
    "chain": ("chain_by_cells", "cells", {"1": "cpu_time", "2": "real_time"}, "threads", {"1": "one thread", "2": "two threads"},
              "fill, flats, D8 and area"),
}
NANOSECONDS = {"ns": 1, "us": 1e3, "ms": 1e6, "s": 1e9}


def arguments(run):
    """What stands behind the slashes of a run's name as KEY:VALUE."""
    return dict(part.split(":", 1) for part in run["name"].split("/")[1:] if ":" in part)


def series_of(runs, benchmark, counted, clock, key, names):
    """Nanoseconds by number of items, for each series."""
    found = {}
    for run in runs:
        if run["name"].split("/")[0] != benchmark or run.get("run_type", "iteration") != "iteration":
            continue
        given = arguments(run)
        items = float(run[counted] if counted in run else given[counted])
        name = names[given[key] if key else None]
        time = run[clock[given[key]] if isinstance(clock, dict) else clock] * NANOSECONDS[run["time_unit"]]
        times = found.setdefault(name, {})
        times[items] = min(time, times.get(items, math.inf))  # the least of repetitions
    return found


def exponent(times):
    """Least squares on the logarithms."""
    x, y = [math.log(n) for n in times], [math.log(t) for t in times.values()]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)


def draw(series, counted, title, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
    for marker, (name, times) in zip("os^", series.items()):
        items = sorted(times)
        axes.loglog(items, [times[n] / n for n in items], marker + "-", label=f"{name}: N^{exponent(times):.2f}")
    least = min(t / n for times in series.values() for n, t in times.items())
    most = max(t / n for times in series.values() for n, t in times.items())
    axes.set_ylim(least / 2, most * 2)
    for formatter in (axes.yaxis.set_major_formatter, axes.yaxis.set_minor_formatter):
        formatter("{x:g}")
    axes.set_xlabel(counted)
    axes.set_ylabel(f"{title}, ns per {counted[:-1]}")
    axes.legend()
    figure.savefig(path, dpi=90, metadata={"Software": None})
    plt.close(figure)


def main():
    if not 2 <= len(sys.argv) <= 3:
        raise SystemExit(__doc__)
    text = Path(sys.argv[1]).read_text(encoding="utf-8")
    runs = json.loads(text[text.index("{"):])["benchmarks"]
    for case, (benchmark, counted, clock, key, names, title) in CASES.items():
        series = series_of(runs, benchmark, counted, clock, key, names)
        for name, times in series.items():
            per_item = ", ".join(f"{n:.3g}: {times[n] / n:.3g} ns" for n in sorted(times))
            print(f"{title}, {name}: t ~ N^{exponent(times):.3f}  ({per_item})")
        if series and len(sys.argv) == 3:
            draw(series, counted, title, Path(sys.argv[2]) / f"{case}_scaling.png")


if __name__ == "__main__":
    main()
