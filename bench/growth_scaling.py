# SPDX-License-Identifier: GPL-3.0-or-later
"""Cost of growing a network against its links: fits t ~ N^exponent and draws it beside N log N.

    thalweg_bench --benchmark_filter=grow_network --benchmark_format=json > growth.json
    growth_scaling.py growth.json growth.png
"""
import json
import math
import sys


def read(path):
    """Milliseconds by number of links."""
    with open(path, encoding="utf-8") as file:
        runs = json.load(file)["benchmarks"]
    return {run["links"]: run["cpu_time"] for run in runs if run["name"].startswith("grow_network")}


def exponent(times):
    """Least squares on the logarithms."""
    x, y = [math.log(n) for n in times], [math.log(t) for t in times.values()]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)


def draw(times, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
    links = sorted(times)
    first = times[links[0]] / (links[0] * math.log(links[0]))
    axes.loglog(links, [times[n] for n in links], "o-", label=f"measured: N^{exponent(times):.2f}")
    axes.loglog(links, [first * n * math.log(n) for n in links], "--", label="N log N")
    axes.set_xlabel("links")
    axes.set_ylabel("growing the network, ms")
    axes.legend()
    figure.savefig(path, dpi=80)


def main():
    times = read(sys.argv[1])
    print(f"t ~ N^{exponent(times):.3f}")
    if len(sys.argv) > 2:
        draw(times, sys.argv[2])


if __name__ == "__main__":
    main()
