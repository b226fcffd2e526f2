# SPDX-License-Identifier: GPL-3.0-or-later
"""Cost of lakes against the number of nodes: fits t ~ N^exponent to each surface and draws it.

    thalweg_bench --benchmark_filter=drain_worst_lakes --benchmark_format=csv > lakes.csv
    lake_scaling.py lakes.csv lakes.png
"""
import csv
import math
import sys

SURFACES = {0: "random surface", 1: "bowl of bowls", 2: "comb"}


def read(path):
    """Milliseconds by surface and number of nodes."""
    with open(path, newline="", encoding="utf-8") as file:
        lines = file.read().splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("name,"))
    times = {}
    for row in csv.DictReader(lines[start:]):
        fields = dict(part.split(":") for part in row["name"].split("/")[1:] if ":" in part)
        times.setdefault(int(fields["surface"]), {})[int(fields["nodes"])] = float(row["cpu_time"])
    return times


def exponent(of_nodes):
    """Least squares on the logarithms."""
    x = [math.log(nodes) for nodes in of_nodes]
    y = [math.log(time) for time in of_nodes.values()]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    spread = sum((a - mean_x) ** 2 for a in x)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / spread


def draw(times, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
    for surface, of_nodes in times.items():
        nodes = sorted(of_nodes)
        per_node = [of_nodes[n] * 1e6 / n for n in nodes]
        axes.loglog(nodes, per_node, "o-", label=f"{SURFACES[surface]}: exponent {exponent(of_nodes):.3f}")
    for formatter in (axes.yaxis.set_major_formatter, axes.yaxis.set_minor_formatter):
        formatter("{x:g}")
    axes.set_xlabel("nodes")
    axes.set_ylabel("routing and draining all lakes, ns per node")
    axes.legend()
    figure.savefig(path, dpi=100)


def main():
    times = read(sys.argv[1])
    for surface, of_nodes in times.items():
        print(f"{SURFACES[surface]}: t ~ N^{exponent(of_nodes):.3f}")
    if len(sys.argv) > 2:
        draw(times, sys.argv[2])


if __name__ == "__main__":
    main()
