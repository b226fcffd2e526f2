#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything the program writes or takes is defined in the user guide: guide_test.py THALWEG SOURCE_FOLDER

Runs the embedded study, a fit of growth, an analysis with derivatives, and looks for each file, JSON key, CSV column, GeoPackage column, option and experiment key
between backticks in docs/guide.md; and for the experiment keys the other way round.
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


BASIN = """[basin]
outline = [[0, 0], [4000, 500], [3000, 5000], [-1000, 4000]]
trunk = [[0, 0], [1500, 3500]]
[growth]
channel_maintenance_m = 400
[output]
resolution = 100
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


def main():
    guide = words_of_guide()
    with tempfile.TemporaryDirectory() as folder:
        study = Path(folder) / "study"
        subprocess.run([THALWEG, "run", SOURCE / "validation" / "jacksboro.toml", "--out", study, "--no-figures",
                        "--set", "study.realisations=2",
                        "--quiet"], check=True)
        growth = Path(folder) / "growth"
        subprocess.run([THALWEG, "fit", SOURCE / "validation" / "data" / "jacksboro.tif", "--method", "growth", "--out",
                        growth, "--no-figures", "--quiet"], check=True)
        derived = Path(folder) / "derived"
        subprocess.run([THALWEG, "analyze", SOURCE / "validation" / "data" / "jacksboro.tif", "--derivatives", "--out",
                        derived, "--no-figures", "--quiet"], check=True)
        words = {**written_words(study), **written_words(growth), **written_words(derived), **taken_words()}
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
