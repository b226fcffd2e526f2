# SPDX-License-Identifier: GPL-3.0-or-later
"""FILE.tif.json: where a DEM comes from, under what licence, and how to cite it."""
import hashlib
import os
import re
import shlex

import numpy as np

from problems import public

PROGRAM = "thalweg fetch"


def of(source, request, canvas, counts, jobs, name, checksum):
    """The content, in the order of reading."""
    grid, heights = canvas.grid, canvas.heights
    system = grid.system()
    code = system.GetAuthorityCode(None)
    west, south, east, north = (float(f"{value:.9f}") for value in counts["bounds_deg"])
    size = {"cell_deg": grid.dx} if system.IsGeographic() else {"cell_m": grid.dx * system.GetLinearUnits()}
    if abs(grid.dx - grid.dy) > 1e-9 * grid.dx:
        size["cell_north_south"] = grid.dy
    return {
        "file": name, "sha256": checksum, "program": PROGRAM, "source": public_words(source.name),
        "title": source["title"], "data": source["title"], "licence": source["licence"], "citation": source["citation"],
        "documentation": source["documentation"] or "", "obtained_from": public(source.base) if source.base else "local files",
        "crs": f"{system.GetAuthorityName(None)}:{code}" if code else system.GetName(), "vertical": source["vertical"],
        "rows": grid.rows, "cols": grid.cols, **size,
        "bbox_deg": {"west": west, "south": south, "east": east, "north": north},
        "elevation_min_m": float(np.nanmin(heights)), "elevation_max_m": float(np.nanmax(heights)),
        "resampling": counts["resampling"], "void_cells": counts["void_cells"], "filled_cells": counts["filled_cells"],
        "cells_without_tile": counts["cells_without_tile"], "notes": counts["notes"],
        "command": shlex.join([*PROGRAM.split(), *map(public_words, _telling(request))]),
        "tiles": [_tile(job) for job in sorted(jobs, key=lambda job: job.record["name"])],
    }


#: Words that change nothing in the result, with how many follow them.
SILENT = {"--end-with-parent": 0, "--quiet": 0, "--json": 0, "--force": 0, "--cache": 1, "--threads": 1}


def _telling(words):
    """The request as somebody elsewhere would repeat it: without what concerns this machine alone."""
    result, i = [], 0
    while i < len(words):
        if words[i] in SILENT:
            i += 1 + SILENT[words[i]]
        elif words[i] == "--out":
            result += ["--out", os.path.basename(words[i + 1])]
            i += 2
        else:
            result.append(words[i])
            i += 1
    return result


def _tile(job):
    record = job.record
    content = {"name": record["name"], "address": record["address"], "published": job.tile.date or None,
               "last_modified": record.get("modified") or None, "etag": record.get("etag") or None,
               "bytes": record.get("size"), "retrieved": record.get("retrieved")}
    if job.paths:
        sums = [job.paths[key].rpartition("-")[2].removesuffix(".tif") for key in sorted(job.paths)]
        content |= {"pieces": len(sums), "pieces_sha256": hashlib.sha256("".join(sums).encode()).hexdigest()}
    else:
        content["sha256"] = record.get("sha256")
    return content


def public_words(word):
    """A word of the command line with nothing in it that may be secret."""
    found = re.search(r"https?://\S+", word)
    return word if found is None else word[:found.start()] + public(found[0])
