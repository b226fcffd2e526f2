#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the paper cases: papers.py [--quick] [--record] [--check] [--thalweg PROGRAM] [--out DIR] [PAPER[/CASE] …]

Each case is run and judged; its rows and figure go to DIR. A verdict other than the recorded one is an error (exit code 1).
  --quick    small versions (under a minute), in which only the verdicts are of interest: what every commit runs
  --record   writes results, figures and README.md into papers/ itself
  --check    runs nothing: is each README.md what the recorded results say?
"""
import argparse
import importlib.util
import os
import platform
import sys
import time

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.realpath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "tools", "figures")]
import harness  # noqa: E402
import style  # noqa: E402

PAPERS = ("bell_2024", "braun_willett_2013", "cordonnier_2016", "kelley_1988")


def load(name, root=HERE):
    """The paper of that folder, with what was published."""
    folder = os.path.join(root, name)
    sys.path.insert(0, folder)
    spec = importlib.util.spec_from_file_location(f"cases_of_{name}", os.path.join(folder, "cases.py"))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    published = harness.read_rows(os.path.join(folder, "published.csv"))
    return harness.Paper(folder, module.TITLE, module.LEAD, module.CASES, published)


def recorded(paper):
    """Rows by case name."""
    return {case.name: harness.read_rows(_results_path(paper.folder, case)) for case in paper.cases}


def _results_path(folder, case):
    return os.path.join(folder, "results", f"{case.name}.csv")


def pages(papers):
    """Text of each README.md by path, from the recorded results."""
    results = {paper.name: recorded(paper) for paper in papers}
    texts = {os.path.join(paper.folder, "README.md"): harness.readme(paper, results[paper.name]) for paper in papers}
    return {**texts, os.path.join(HERE, "README.md"): harness.overview(papers, results)}


def check(papers):
    """Paths of the pages that are not what the recorded results say."""
    return [path for path, text in pages(papers).items() if _read(path) != text]


def _read(path):
    if not os.path.exists(path):
        return None
    with open(path, encoding="utf-8") as stream:
        return stream.read()


def run_and_judge(paper, case, tools, options):
    """Runs a case, writes its rows and its figure; returns its verdicts."""
    published = harness.published_of(paper, case)
    rows, folders = harness.run_case(paper, case, tools, options.quick)
    rows = harness.as_written(rows)
    target = paper.folder if options.record else os.path.join(options.out, paper.name)
    harness.write_rows(_results_path(target, case), rows)
    figures = os.path.join(target, "figures")
    os.makedirs(figures, exist_ok=True)
    with open(os.path.join(figures, f"{case.name}.png"), "wb") as stream:
        stream.write(style.png(case.draw(rows, published, folders), palette=case.palette))
    return case.judge(rows, published)


def changed_verdicts(paper, case, verdicts):
    """Sentences on the verdicts that are not the recorded ones."""
    path = _results_path(paper.folder, case)
    if not os.path.exists(path):
        return [f"{paper.name}/{case.name}: no recorded result ({path})"]
    before = case.judge(harness.read_rows(path), harness.published_of(paper, case))
    pairs = {v.claim: v.word for v in before}
    return [f"{paper.name}/{case.name}: {v.claim}: {v.word} ({v.ours}), recorded: {pairs.get(v.claim, 'nothing')}"
            for v in verdicts if pairs.get(v.claim) != v.word]


def record_pages(papers):
    """Writes all pages, once every case has a result."""
    lacking = [f"{paper.name}/{case.name}" for paper in papers for case in paper.cases
               if not os.path.exists(_results_path(paper.folder, case))]
    if lacking:
        raise harness.Failure(f"recorded; no page is written before these have results too: {', '.join(lacking)}")
    for path, text in pages(papers).items():
        with open(path, "w", encoding="utf-8") as stream:
            stream.write(text)


def record_machine(paper):
    with open("/proc/cpuinfo", encoding="utf-8") as stream:
        model = next((line.split(":")[1].strip() for line in stream if line.startswith("model name")), platform.machine())
    harness.write_rows(os.path.join(paper.folder, "machine.csv"),
                       [{"processor": model, "threads": os.cpu_count(), "load_average": os.getloadavg()[0]}])


def wanted(papers, names):
    """(paper, case) pairs that the names on the command line choose; all if there are none."""
    every = [(paper, case) for paper in papers for case in paper.cases]
    if not names:
        return every
    chosen = [pair for pair in every if {pair[0].name, f"{pair[0].name}/{pair[1].name}"} & set(names)]
    known = {paper.name for paper in papers} | {f"{paper.name}/{case.name}" for paper, case in every}
    for name in names:
        if name not in known:
            raise harness.Failure(f"no paper or case '{name}'; there are: {', '.join(sorted(known))}")
    return chosen


def options_of(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="PAPER[/CASE]")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--record", action="store_true")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--thalweg", default=os.path.join(HERE, "..", "build", "release", "bin", "thalweg"))
    parser.add_argument("--out", default=os.path.join(HERE, "..", "build", "papers"))
    options = parser.parse_args(arguments)
    options.out = os.path.abspath(options.out)  # experiments name files beside them by their own place
    if options.quick and options.record:
        raise harness.Failure("--quick and --record exclude each other: only full runs are recorded")
    return options


def run(papers, options):
    tools = harness.Tools(options.thalweg, os.path.join(options.out, "work"), os.path.dirname(options.thalweg))
    complaints = []
    for paper, case in wanted(papers, options.names):
        begin = time.monotonic()
        verdicts = run_and_judge(paper, case, tools, options)
        took = time.monotonic() - begin
        for v in verdicts:
            print(f"{paper.name}/{case.name} ({took:.1f} s): {v.claim}: {v.word} (published {v.published}, ours {v.ours})",
                  flush=True)
        if options.record:
            record_machine(paper)
        else:
            complaints += changed_verdicts(paper, case, [v for v in verdicts if not (options.quick and v.full_only)])
    if options.record:
        record_pages(papers)
    return complaints


def main(arguments):
    try:
        options = options_of(arguments)
        style.prepare()
        papers = [load(name) for name in PAPERS if os.path.exists(os.path.join(HERE, name, "cases.py"))]
        if options.check:
            complaints = [f"{path} is not what the results say: ./run papers --record" for path in check(papers)]
        else:
            complaints = run(papers, options)
    except harness.Failure as error:
        print(f"papers: error: {error}", file=sys.stderr)
        return 2
    for complaint in complaints:
        print(f"papers: {complaint}", file=sys.stderr)
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
