#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every command that the README shows works as it stands there: readme_test.py THALWEG SOURCE_FOLDER

Runs them in their order, with the experiment that the README shows, in a folder that has the repository's data; not what needs
a network (`fetch`) or builds (`./run`). Figures are left out; they have tests of their own.
"""
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

THALWEG, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
DRAWS_NO_FIGURES = ("render", "fetch")


def blocks(text, language):
    return re.findall(rf"```{language}\n(.*?)```", text, re.S)


def commands(text):
    lines = [line for block in blocks(text, "sh") for line in block.splitlines()]
    return [shlex.split(line, comments=True) for line in lines if line.startswith("thalweg ")]


def run(command, folder):
    """Why a line of the README does not do what it should; nothing where it does."""
    extra = [] if command[1] in DRAWS_NO_FIGURES else ["--no-figures"]
    done = subprocess.run([THALWEG, *command[1:], *extra], cwd=folder, capture_output=True, text=True, check=False)
    out = folder / command[command.index("--out") + 1]
    if done.returncode == 0 and out.exists():
        return []
    return [f"'{shlex.join(command)}' ended with {done.returncode}: {done.stderr.strip()}"]


def at_a_square_kilometre(fit):
    """k·A^m in mm/yr."""
    return 1000 * fit["k_at_reference_area"] * (1e6 / fit["reference_area_m2"]) ** fit["m"]


def wrong_numbers(text, folder):
    """Numbers that the README says and its own commands do not give."""
    alone, of_study = (json.loads((folder / name / "fit.json").read_text()) for name in ("fitted", "study/fit"))
    short = f"{alone['k']:.1e}".replace("e-0", "e-")
    promised = (f"k = {short} m = {alone['m']:.3f}",
                f"k is {of_study['k']:.1e} instead of {short}".replace("e-0", "e-"),
                f"is {at_a_square_kilometre(of_study):.2f} instead of {at_a_square_kilometre(alone):.2f} mm/yr")
    return [f"the README should say '{words}'" for words in promised if words not in " ".join(text.split())]


def main():
    text = (SOURCE / "README.md").read_text(encoding="utf-8")
    shown = commands(text)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for part in ("validation", "docs"):
            os.symlink(SOURCE / part, folder / part)
        (folder / "experiment.toml").write_text(blocks(text, "toml")[0], encoding="utf-8")
        problems = [problem for command in shown if command[1] != "fetch" for problem in run(command, folder)]
        problems = problems or wrong_numbers(text, folder)
    for problem in problems:
        print(problem)
    print(f"{len(shown)} commands of the README, {len(problems)} problems")
    return 1 if problems or len(shown) < 10 else 0


if __name__ == "__main__":
    sys.exit(main())
