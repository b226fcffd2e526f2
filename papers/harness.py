# SPDX-License-Identifier: GPL-3.0-or-later
"""What every paper case needs: runs of the thalweg program, tables of results, verdicts and the README made from them.

A paper is a folder with `experiment.toml` (its setting), `published.csv` (what its authors report) and `cases.py`. A case
lists runs (the setting and overrides), measures each, judges the rows against what was published, and draws them. Ours
stands in `results/CASE.csv`; nothing that others published stands there.
"""
import csv
import io
import itertools
import json
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Callable

REPRODUCED, EXPLAINED, OPEN = "reproduced", "differs, explained", "differs, open"


class Failure(Exception):
    """Something the reader can mend, in one sentence."""


@dataclass(frozen=True)
class Run:
    """One simulation: labels that become the first columns of its row, and `section.key=value` overrides."""
    labels: dict
    overrides: tuple = ()
    keep: bool = False                   # its folder is left for drawing
    experiment: str = "experiment.toml"


@dataclass(frozen=True)
class Verdict:
    claim: str
    published: str
    ours: str
    criterion: str
    word: str
    full_only: bool = False              # too few nodes or values in the quick version to tell


@dataclass(frozen=True)
class Case:
    name: str
    title: str
    runs: Callable                       # (quick) -> list of Run
    judge: Callable                      # (rows, published) -> list of Verdict
    draw: Callable                       # (rows, published, folders) -> matplotlib Figure
    text: Callable = None                # (rows, published) -> markdown with the numbers of this case
    caption: str = ""
    measure: Callable = None             # (run, summary, folder) -> further columns, or a list of rows
    columns: tuple = ()                  # of the table in the README; all others stand in the CSV only
    also_published: tuple = ()           # names of cases whose published rows it is judged by, too
    timed: bool = False                  # one run at a time, all threads
    palette: bool = False                # the figure is a map
    compute: Callable = None             # (tools, quick) -> (rows, folders), where one command per row is not enough


@dataclass
class Paper:
    folder: str
    title: str
    lead: str                            # first paragraphs of its README
    cases: list
    published: list = field(default_factory=list)

    @property
    def name(self):
        return os.path.basename(self.folder)


@dataclass(frozen=True)
class Tools:
    """Where the programs are and where results may be written."""
    thalweg: str
    work: str
    programs: str                        # folder of the other programs that the build made


def verdict(claim, published, ours, criterion, met, explained=False, full_only=False):
    """`explained`: whether our own runs show why, by a test of its own."""
    return Verdict(claim, published, ours, criterion, REPRODUCED if met else EXPLAINED if explained else OPEN, full_only)


# ---- running

def run_case(paper, case, tools, quick):
    """(rows, kept folders by position)."""
    if case.compute:
        return case.compute(tools, quick)
    runs = case.runs(quick)
    workers = 1 if case.timed else max(1, os.cpu_count() or 1)
    with ThreadPoolExecutor(workers) as pool:
        done = list(pool.map(lambda numbered: _run(paper, case, tools, *numbered, threads=0 if case.timed else 1),
                             enumerate(runs)))
    rows = list(itertools.chain.from_iterable(rows for rows, _ in done))
    return rows, [folder for _, folder in done]


def _run(paper, case, tools, number, run, threads):
    folder = os.path.join(tools.work, paper.name, case.name, f"{number:03}")
    os.makedirs(os.path.dirname(folder), exist_ok=True)
    command = [tools.thalweg, "simulate", os.path.join(paper.folder, run.experiment), "--out", folder, "--force", "--quiet",
               "--no-figures", "--threads", str(threads), *itertools.chain(*(("--set", each) for each in run.overrides))]
    peak_mib = _execute(command)
    with open(os.path.join(folder, "summary.json"), encoding="utf-8") as stream:
        summary = json.load(stream)
    common = {**run.labels, **_columns(summary), "peak_mib": peak_mib}
    further = case.measure(run, summary, folder) if case.measure else {}
    rows = [{**common, **each} for each in further] if isinstance(further, list) else [{**common, **further}]
    if not run.keep:
        shutil.rmtree(folder)
    return rows, folder if run.keep else None


#: Starts a command from a small process: Linux counts the memory of whoever starts a program as the program's, too.
_LAUNCH = """
import os, sys
pid = os.fork()
if not pid:
    os.execv(sys.argv[1], sys.argv[1:])
_, status, usage = os.wait4(pid, 0)
print(usage.ru_maxrss)
code = os.waitstatus_to_exitcode(status)
sys.exit(code if code >= 0 else 128 - code)
"""


def _execute(command):
    """Runs it; returns its largest resident memory (MiB)."""
    if not os.path.exists(command[0]):
        raise Failure(f"{command[0]} does not exist: ./run papers builds it, --thalweg names another")
    done = subprocess.run([sys.executable, "-I", "-S", "-c", _LAUNCH, *command], capture_output=True, text=True, check=False)
    if done.returncode:
        raise Failure(f"{' '.join(command)}: {done.stderr.strip() or done.returncode}")
    return float(done.stdout.split()[-1]) / 1024


def _columns(summary):
    """What every row holds of a run's summary.json."""
    mass, seconds = summary["mass_balance"], summary["seconds"]
    return {"nodes": summary["nodes"], "steps": summary["steps"], "converged": int(summary["converged"]),
            "frozen_receivers": summary["frozen_receivers"], "lakes_final": summary["lakes_final"],
            "elevation_max_m": summary["elevation_max_m"], "elevation_mean_m": summary["elevation_mean_m"],
            "talus_share": mass["talus_m3"] / mass["uplifted_m3"] if mass["uplifted_m3"] else None,
            "seconds_mesh": seconds["mesh"], "seconds_simulate": seconds["simulate"], "seconds_total": seconds["total"]}


def printed_rows(tools, program, *arguments):
    """Rows that a program of the papers' own prints as CSV."""
    command = [os.path.join(tools.programs, program), *map(str, arguments)]
    if not os.path.exists(command[0]):
        raise Failure(f"{command[0]} does not exist: ./run papers builds it")
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise Failure(f"{' '.join(command)}: {done.stderr.strip() or done.returncode}")
    return [{key: _value(text) for key, text in row.items()} for row in csv.DictReader(io.StringIO(done.stdout))]


def history(folder, *columns):
    """Columns of a run's history.csv, each a list of numbers."""
    with open(os.path.join(folder, "history.csv"), encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    return [[float(row[column]) for row in rows] for column in columns]


# ---- tables

def write_rows(path, rows):
    columns = list(dict.fromkeys(itertools.chain.from_iterable(rows)))
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows({key: _written(value) for key, value in row.items()} for row in rows)


def read_rows(path):
    """Numbers become numbers, empty fields None."""
    if not os.path.exists(path):
        raise Failure(f"{path} does not exist: ./run papers --record writes it")
    with open(path, encoding="utf-8", newline="") as stream:
        return [{key: _value(text) for key, text in row.items()} for row in csv.DictReader(stream)]


def _written(value):
    return "" if value is None else f"{value:.7g}" if isinstance(value, float) else value


def _value(text):
    try:
        return float(text)
    except ValueError:
        return text or None


def as_written(rows):
    """The rows as they will be read back, so that a judgement is the same before and after."""
    return [{key: _value(str(_written(value))) for key, value in row.items()} for row in rows]


def select(rows, **wanted):
    return [row for row in rows if all(row.get(key) == value for key, value in wanted.items())]


def column(rows, name):
    return [row[name] for row in rows]


def published_of(paper, case):
    return [row for row in paper.published if row["case"] in (case.name, *case.also_published)]


# ---- text

def number(value, digits=3):
    """Three significant digits, thousands apart, no exponent where a reader does not need one."""
    if value is None or isinstance(value, str):
        return value or "–"
    rounded = float(f"{value:.{digits - 1}e}")
    if rounded and (abs(rounded) < 1e-3 or abs(rounded) >= 1e8):
        text = f"{rounded:.{digits - 1}e}".replace("e-0", "e-").replace("e+0", "e")
        return text if "." not in text else "e".join([text.split("e")[0].rstrip("0").rstrip("."), text.split("e")[1]])
    if abs(value) >= 10**(digits - 1):
        return f"{value:,.0f}".replace(",", " ")
    return f"{rounded:.{digits}g}"


def markdown_table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows])


def verdict_table(verdicts):
    return markdown_table(["claim", "published", "ours", "criterion", "verdict"],
                          [[v.claim, v.published, v.ours, v.criterion, f"*{v.word}*"] for v in verdicts])


def section(case, rows, published, verdicts):
    parts = [f"## {case.title}"]
    if case.text:
        parts.append(case.text(rows, published).strip())
    if verdicts:
        parts.append(verdict_table(verdicts))
    if case.columns:
        parts.append(markdown_table([name.replace("_", " ") for name in case.columns],
                                    [[number(row.get(name)) for name in case.columns] for row in rows]))
    parts.append(f"![{case.caption or case.title}](figures/{case.name}.png)")
    if case.caption:
        parts.append(f"*{case.caption}*")
    return "\n\n".join(parts)


def judged(paper, results):
    """(case, rows, published, verdicts) for each case of a paper; `results`: rows by case name."""
    for case in paper.cases:
        published, rows = published_of(paper, case), results[case.name]
        yield case, rows, published, case.judge(rows, published)


def readme(paper, results):
    """Text of the paper's README.md."""
    parts = [f"# {paper.title}", paper.lead.strip()]
    parts += [section(*each) for each in judged(paper, results)]
    parts.append("Made by `./run papers --record` from `published.csv`, `results/` and `cases.py`. Columns named `seconds…` "
                 "are wall times and `peak_mib` is memory, on the machine in `machine.csv` and with the load that stands there "
                 "(processes that wanted a processor, ours among them): they differ from run to run.")
    return "\n\n".join(parts) + "\n"


OVERVIEW = """# Papers

Does Thalweg say what others published? One folder per paper: `README.md`, the setting (`experiment.toml`), what was
published (`published.csv`), our runs (`cases.py`), what came out of them (`results/`, `figures/`). Published numbers and
ours stand in different files.

`./run papers` runs everything at full size, compares the verdicts with the recorded ones and writes into `build/papers`;
`./run papers --quick` runs small versions, as every commit does; `./run papers bell_2024/uplift` one case;
`./run papers --record` renews results, figures and these pages. A verdict is *reproduced*, *differs, explained* (by runs of
ours that show why) or *differs, open*; its criterion stands beside it."""


def overview(papers, results):
    """Text of papers/README.md: the verdicts of all papers."""
    parts = [OVERVIEW]
    for paper in papers:
        verdicts = [(case, v) for case, _, _, found in judged(paper, results[paper.name]) for v in found]
        counts = ", ".join(f"{sum(v.word == word for _, v in verdicts)} {word}" for word in (REPRODUCED, EXPLAINED, OPEN))
        parts.append(f"## [{paper.title}]({paper.name}/README.md)\n\n{counts}.")
        parts.append(markdown_table(["case", "claim", "verdict"], [[c.title, v.claim, f"*{v.word}*"] for c, v in verdicts]))
    return "\n\n".join(parts) + "\n"
