# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading what the commands wrote. What is absent reads as None or as an empty table: a figure then says so."""
import json
import os
import re
import tomllib
from itertools import chain, islice

import numpy as np

#: Longer tables are read with a stride: a cloud of more points than pixels shows nothing more.
LARGEST_TABLE_BYTES = 6_000_000


class Missing(Exception):
    """One sentence for the user: what was needed and not found."""


def read_json(folder, name):
    """The parsed file, or None when there is none."""
    path = os.path.join(folder, name)
    if not os.path.exists(path):
        return None
    try:
        with open(path, encoding="utf-8") as stream:
            return json.load(stream)
    except ValueError as error:
        raise Missing(f"{path} is not JSON: {error}") from None


def require_json(folder, name):
    content = read_json(folder, name)
    if content is None:
        raise Missing(f"{os.path.join(folder, name)} does not exist")
    return content


def read_toml(folder, name):
    """The parsed file, or an empty dictionary."""
    path = os.path.join(folder, name)
    if not os.path.exists(path):
        return {}
    try:
        with open(path, "rb") as stream:
            return tomllib.load(stream)
    except tomllib.TOMLDecodeError as error:
        raise Missing(f"{path} is not TOML: {error}") from None


def read_csv(folder, name):
    """Columns by name as arrays of float (what is not a number is NaN); {} when the file is absent or has no rows."""
    path = os.path.join(folder, name)
    if not os.path.exists(path):
        return {}
    stride = 1 + os.path.getsize(path) // LARGEST_TABLE_BYTES
    with open(path, encoding="utf-8") as stream:
        header = stream.readline().strip().split(",")
        rows = list(islice(stream, 0, None, stride))
    if not rows:
        return {}
    table = _parse(rows, len(header))
    return {column: table[:, i] for i, column in enumerate(header)}


def _parse(rows, columns):
    try:
        return np.loadtxt(rows, delimiter=",", ndmin=2, comments=None)
    except ValueError:  # empty fields or words
        fields = (row.rstrip("\r\n").split(",") for row in rows)
        flat = chain.from_iterable((line + [""] * columns)[:columns] for line in fields)
        return np.array([_number(field) for field in flat]).reshape(-1, columns)


def _number(field):
    try:
        return float(field)
    except ValueError:
        return {"true": 1.0, "false": 0.0}.get(field.strip().lower(), np.nan)


def get(content, path, default=None):
    """The value at "a.b.c", or the default where any part is absent or null."""
    for key in path.split("."):
        if not isinstance(content, dict) or content.get(key) is None:
            return default
        content = content[key]
    return content


def notes_of(content):
    """The notes of a result as (key, sentence); a note in a list may begin with the key that it explains ("horton: …")."""
    notes = content.get("notes") if isinstance(content, dict) else None
    if isinstance(notes, dict):
        return [(str(key), _sentence(value)) for key, value in notes.items()]
    found = []
    for note in [notes] if isinstance(notes, str) else notes or []:
        keyed = re.match(r"([a-z_][\w.]*(?: and \w+)?): (.+)", _sentence(note), re.DOTALL)
        found.append(keyed.groups() if keyed else ("", _sentence(note)))
    return found


def _sentence(note):
    if isinstance(note, dict):
        return "; ".join(str(value) for value in note.values())
    return ", ".join(map(str, note)) if isinstance(note, list) else str(note)


def reason(content, path):
    """Why the value at `path` is null, as far as the notes tell: by key, by its parents' key, or by being named."""
    notes = notes_of(content)
    last = path.rsplit(".", 1)[-1]
    for key, sentence in notes:
        if key in (path, last) or (key and path.startswith(key + ".")):
            return sentence
    if len(last) < 4:  # too short to be told from an ordinary word
        return ""
    named = re.compile(rf"\b{re.escape(last)}\b")
    return next((sentence for _, sentence in notes if named.search(sentence)), "")


def absences(content, path):
    """Paths of the nulls at and below `path`, wherever in the content that lies."""
    pending, found = [("", content)], []
    while pending:
        name, value = pending.pop()
        if isinstance(value, dict):
            pending += [(f"{name}.{key}", each) for key, each in value.items()]
        elif isinstance(value, list):
            pending += [(name, each) for each in value]
        elif value is None and f".{path}." in name + ".":
            found.append(name[1:])
    return found


def terrain_of(summary):
    """The measures of a summary: those of `analyze` stand at the top, those of a simulation under "terrain"."""
    return (summary or {}).get("terrain") or summary or {}


def columns(records, *names):
    """Lists of objects as arrays by key, null as NaN."""
    return [np.array([np.nan if r.get(name) is None else float(r[name]) for r in records or []]) for name in names]
