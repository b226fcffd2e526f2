#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything the program writes or takes is defined in the user guide: guide_test.py THALWEG SOURCE_FOLDER

Runs the embedded study, a fit of growth, an analysis with derivatives, a growth and a simulation of their own, and
looks for each file, JSON key, CSV column, GeoPackage column, option and experiment key between backticks in
docs/guide.md; and for the experiment keys the other way round.
"""
import json
import re
import sqlite3
import subprocess
import sys
import tempfile
from pathlib import Path

THALWEG, SOURCE = sys.argv[1], Path(sys.argv[2])
OPTIONS_OF_LIBRARIES = {"--help"}
COLUMNS_OF_GEOPACKAGES = {"fid", "geom"}


def words_of_guide():
    """Every word between backticks or in a code block, and the words it is made of (`domain.dem`: dem too)."""
    text = (SOURCE / "docs" / "guide.md").read_text(encoding="utf-8")
    code = re.findall(r"```(.*?)```", text, re.S) + re.findall(r"`([^`]+)`", re.sub(r"```.*?```", "", text, flags=re.S))
    return {word for piece in code for word in re.findall(r"[A-Za-z][A-Za-z0-9_.-]*|--[a-z0-9-]+", piece)}


def json_keys(value, keys):
    if isinstance(value, dict):
        for key, below in value.items():
            keys.add(key)
            json_keys(below, keys)
    elif isinstance(value, list):
        for below in value:
            json_keys(below, keys)
    return keys


def geopackage_words(path):
    with sqlite3.connect(f"file:{path}?mode=ro", uri=True) as file:
        layers = [row[0] for row in file.execute("select table_name from gpkg_contents")]
        columns = {row[1] for layer in layers for row in file.execute(f"pragma table_info({layer})")}
    return {*layers, *columns} - COLUMNS_OF_GEOPACKAGES


def written_words(folder):
    """Word: where it was seen, for all that the study wrote."""
    seen = {}
    for path in sorted(p for p in folder.rglob("*") if p.is_file() and not p.name.startswith(".")):
        where = str(path.relative_to(folder))
        words = {path.name}
        if path.suffix == ".json":
            content = json.loads(path.read_text())
            content.pop("libraries", None)  # names of other people's
            words |= json_keys(content, set())
        elif path.suffix == ".csv":
            words |= set(path.open().readline().strip().split(","))
        elif path.suffix == ".gpkg":
            words |= geopackage_words(path)
        seen.update({word: where for word in words})
    return seen


GROW = """[basin]
outline = [[0, 0], [4000, 500], [3000, 5000], [-1000, 4000]]
trunk = [[0, 0], [1500, 3500]]
[growth]
channel_maintenance_m = 400
[output]
resolution = 100
"""

SIMULATE = """[domain]
size_m = [10000, 8000]
nodes = 1000
[uplift]
rate_m_per_yr = 1e-3
[river]
k = 2e-5
m = 0.5
[time]
step_yr = 1e5
max_steps = 2
[output]
mesh_file = "obj"
"""


def help_of(*command):
    return subprocess.run([THALWEG, *command, "--help"], capture_output=True, text=True, check=True).stdout


def taken_words():
    """Subcommands, their options and the experiment's keys, as --help names them."""
    seen = {}
    for command in re.findall(r"^  ([a-z]+)  ", help_of().split("Subcommands:")[1], re.M):
        seen[command] = "thalweg --help"
        text = help_of(command)
        seen.update({option: f"{command} --help" for option in re.findall(r"--[a-z0-9-]+", text)})
        if command == "simulate":
            seen.update({key: "simulate --help" for key in re.findall(r"^  ([a-z]+\.[a-z_0-9]+) ", text, re.M)})
    return {word: where for word, where in seen.items() if word not in OPTIONS_OF_LIBRARIES}


def all_words(folder):
    """Word: where it was seen, for all that commands write and take."""
    for name, text in (("grow", GROW), ("simulate", SIMULATE)):
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    dem = SOURCE / "validation" / "data" / "jacksboro.tif"
    seen = taken_words()
    for number, command in enumerate((("run", SOURCE / "validation" / "jacksboro.toml", "--set", "study.realisations=2"),
                                      ("fit", dem, "--method", "growth"), ("analyze", dem, "--derivatives"),
                                      ("grow", folder / "grow.toml"), ("simulate", folder / "simulate.toml"))):
        out = folder / str(number)
        subprocess.run([THALWEG, *command, "--out", out, "--no-figures", "--quiet"], check=True)
        seen.update(written_words(out))
    return seen


def main():
    guide = words_of_guide()
    with tempfile.TemporaryDirectory() as folder:
        words = all_words(Path(folder))
    missing = {word: where for word, where in words.items() if word not in guide}
    for word, where in sorted(missing.items()):
        print(f"docs/guide.md does not define {word} ({where})")
    keys = {word for word, where in words.items() if where == "simulate --help" and "." in word}
    sections = {key.split(".")[0] for key in keys}
    files = {word for word in words if word not in keys}
    extra = {word for word in guide if word.split(".")[0] in sections and "." in word} - keys - files
    for word in sorted(extra):
        print(f"docs/guide.md defines {word}, which the program does not know")
    print(f"{len(words)} words looked up, {len(missing)} missing, {len(extra)} too many")
    return 1 if missing or extra or len(words) < 100 else 0


if __name__ == "__main__":
    sys.exit(main())
