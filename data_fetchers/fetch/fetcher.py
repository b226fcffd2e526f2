# SPDX-License-Identifier: GPL-3.0-or-later
"""The walk from a request to a DEM: tiles, their records, one grid, missing pieces into the cache, the mosaic."""
import concurrent.futures
import os
from dataclasses import dataclass, field

import numpy as np
from osgeo import gdal

import cache as cache_module
import mosaic
import reader
import tiles as tile_lists
from problems import ServerError, UserError
from region import bounds_in, wgs84
from web import Absent

#: Above this many cells --yes is needed: a gigabyte of heights.
MOST_CELLS = 250_000_000
#: What thalweg can number.
MOST_CELLS_EVER = 4_294_967_294


@dataclass
class Job:
    """A tile, what is known of it, and which of its pieces are wanted and where they lie in the cache."""
    tile: tile_lists.Tile
    record: dict
    store: cache_module.TileStore | None = None
    window: reader.Window | None = None
    missing: list = field(default_factory=list)
    paths: dict = field(default_factory=dict)
    looked: bool = False  #: the server was asked in this run

    def place(self, window):
        """Takes the cells it is to give, and looks which pieces of them the cache has."""
        self.window, self.missing, self.paths = window, [], {}
        if window is None or self.store is None:
            return
        for key in reader.pieces_under(self.record, window):
            path = self.store.piece(self.record, *key)
            if path is None:
                self.missing.append(key)
            else:
                self.paths[key] = path


class Fetcher:
    def __init__(self, source, options, web, cache, progress):
        self.source, self.options, self.web, self.cache, self.progress = source, options, web, cache, progress
        self.notes = []
        self.lacking = []  #: what offline mode would have needed

    def run(self, box, outline):
        """The canvas with the heights, and what is to be said of them."""
        options = self.options
        self._refuse_too_large(self._expected_cells(box), box)
        target = self._target(box)
        reach = box if target is None else mosaic.box_under(target, 4)
        jobs = self._records(tile_lists.of(self.source, reach, self.web, self.cache, options.offline, options.refresh), reach)
        self._download_whole(jobs)
        native = self._place(jobs, reach)
        stale = [job for job in jobs if job.missing and not job.looked and not options.offline]
        if stale:  # what is added to a tile must be of the version that the server has now
            for job in stale:
                self._look_again(job)
            self._download_whole(jobs)
            native = self._place(jobs, reach)
        jobs = [job for job in jobs if job.window is not None]
        self._refuse_offline(jobs)
        if not jobs:
            raise UserError(self._nowhere(box))
        final = target or native
        self._refuse_too_large(max(final.rows * final.cols, native.rows * native.cols), box)
        self._state(jobs, final)
        self._fetch_pieces(jobs)
        return self._canvas(jobs, native, target, outline, box)

    # -- what there is ----------------------------------------------------------------------------------------------

    def _expected_cells(self, box):
        if self.options.cell_m or self.options.crs:
            size = self.options.cell_m or self.source["cell_size_m"]
            return box.area_km2() * 1e6 / size ** 2 if size else 0
        if self.source["cell_deg"]:
            return (box.east - box.west) * (box.north - box.south) / self.source["cell_deg"] ** 2
        return box.area_km2() * 1e6 / self.source["cell_m"] ** 2 if self.source["cell_m"] else 0

    def _refuse_too_large(self, cells, box):
        text = f"the region of {box.area_km2():,.0f} km² has {cells:,.0f} cells, {cells * 4 / 1e9:,.1f} GB of heights"
        if cells > MOST_CELLS_EVER:
            raise UserError(f"{text}: more than thalweg can number; choose a smaller region or a coarser source")
        if cells > MOST_CELLS and not self.options.yes:
            raise UserError(f"{text}; --yes fetches it all the same")

    def _target(self, box):
        if not self.options.crs:
            if self.options.cell_m:
                raise UserError("--cell-m needs --crs: without it the source's own cells are kept")
            return None
        size = self.options.cell_m or self.source["cell_size_m"]
        if size is None:
            raise UserError(f"--crs with {self.source.key} needs --cell-m, the size of the new cells")
        return mosaic.projected_grid(box, self.options.crs, size)

    def _place(self, jobs, reach):
        """The grid of the source's own cells, every job placed under it."""
        native = mosaic.native_grid(reach, [job.record for job in jobs])
        if native is None:
            raise UserError(self._nowhere(reach))
        bounds = bounds_in(native.bounds(), native.system(), wgs84())
        for job in jobs:
            job.place(mosaic.window_of(job.record, bounds))
        return native

    def _records(self, found, box):
        """What is known of each tile, from the cache where that is enough; tiles that are not there drop out."""
        jobs = []
        for number, tile in enumerate(found):
            self.progress.status(f"looking at tile {number + 1} of {len(found)}")
            job = self._local(tile) if tile.kind == "local" else self._remote(tile)
            if job is not None:
                jobs.append(job)
        self._refuse_offline([])
        if not jobs:
            raise UserError(self._nowhere(box))
        return jobs

    def _nowhere(self, box):
        why = "it lies in the sea or outside the coverage" if self.source.kind != "index" else "nothing there"
        return f"{self.source.name} has no tile for the box {box}: {why} ({self.source['coverage']})"

    def _local(self, tile):
        try:
            data = gdal.Open(tile.address)
        except RuntimeError:
            raise UserError(f"the tile '{tile.address}' of the index is no raster that GDAL reads") from None
        record = {"name": tile.name, "address": os.path.basename(tile.address)} | reader.describe(data, tile.address)
        return Job(tile, record)

    def _remote(self, tile):
        self.web.check_host(tile.address, "tiles are on")
        store = self.cache.tile(self.source.key, tile.name, tile.address)
        record = store.record()
        if record and "wkt" in record and not (self.options.refresh and not self.options.offline):
            return Job(tile, record, store)
        if self.options.offline:
            if record is None:
                self.lacking.append(tile.name)
            return None
        return self._looked_at(tile, store, record)

    def _looked_at(self, tile, store, record):
        if self.source.kind == "api":
            self._require_key()
            return Job(tile, {"name": tile.name, "address": tile.address.split("?")[0], "version": "v1",
                              "retrieved": cache_module.today()}, store, looked=True)
        fresh = reader.look(tile, self.web)
        if fresh is None:
            store.remember({"name": tile.name, "absent": True})
            return None
        if record and "wkt" in record and record["version"] == fresh["version"]:
            if tile.kind == "cog" or store.piece(record, 0, 0):
                return Job(tile, record, store, looked=True)  # keeps the day of the first look
        if "wkt" in fresh:
            store.remember(fresh)
        return Job(tile, fresh, store, looked=True)

    def _look_again(self, job):
        """At a tile that was taken from the cache, of which pieces are wanted that the cache lacks."""
        found = self._looked_at(job.tile, job.store, job.record)
        if found is None:
            raise ServerError(f"tile {job.tile.name} is in the cache in part, and the server has it no more (HTTP 404)")
        job.record, job.looked = found.record, True

    def _require_key(self):
        if not os.environ.get(self.source["key"], "").strip():
            raise UserError(f"{self.source.name} needs a key: request one at {self.source['documentation']} and put it into the "
                            f"environment variable {self.source['key']}")

    def _refuse_offline(self, jobs):
        if not self.options.offline:
            return
        names = self.lacking + [f"{job.tile.name} ({len(job.missing)} of {len(job.missing) + len(job.paths)} pieces)"
                                for job in jobs if job.missing]
        if names:
            raise UserError(f"offline, and the cache lacks {', '.join(names)}")

    # -- getting it -------------------------------------------------------------------------------------------------

    def _download_whole(self, jobs):
        """Files that cannot be read in parts, and that the cache does not have."""
        wanted = [job for job in jobs if job.store is not None and "wkt" not in job.record]
        if not wanted or self.options.dry_run:
            self._say_whole(wanted)
            return
        sizes = [job.record.get("size") or 0 for job in wanted]
        self.progress.start(f"{len(wanted)} file{'s' * (len(wanted) > 1)} of {self.source.name}: "
                            + (_megabytes(sum(sizes)) if all(sizes) else "size not told by the server"), sum(sizes))
        self._all_at_once(self._whole, wanted)

    def _say_whole(self, wanted):
        if wanted:
            sizes = [job.record.get("size") or 0 for job in wanted]
            told = _megabytes(sum(sizes)) if all(sizes) else "size not told by the server"
            raise Planned(f"{len(wanted)} files of {self.source.name} to download: {told}")

    def _whole(self, job):
        with job.store.lock(job.record, 0):
            there = job.store.record()
            if there and there.get("version") == job.record["version"] and "wkt" in there and job.store.piece(there, 0, 0):
                job.record = there
                return
            try:
                job.record = reader.fetch_whole(job.tile, job.store, job.record, self.web, self._count)
            except ServerError as problem:
                if self.source.kind == "api":
                    raise self._key_or_server(problem) from None
                raise

    def _key_or_server(self, problem):
        status = getattr(problem, "status", None)
        if status in (401, 403):
            return UserError(f"{self.source.name}: the server does not accept the key in {self.source['key']} (HTTP {status})")
        if status == 400:
            return UserError(f"{self.source.name}: the server refuses the request (HTTP 400): is the box inside the dataset?")
        return problem

    def _state(self, jobs, grid):
        """Says what will be read before anything is."""
        wanted = [job for job in jobs if job.missing]
        pieces = sum(len(job.missing) for job in wanted)
        size = sum(reader.bytes_of(job.tile, job.record, job.missing) for job in wanted)
        have = sum(len(job.paths) for job in jobs)
        text = (f"{len(jobs)} tile{'s' * (len(jobs) > 1)} of {self.source.name}, {grid.cols} x {grid.rows} cells: "
                f"{_megabytes(size)} to read in {pieces} pieces, {have} pieces in the cache")
        if self.options.dry_run:
            raise Planned(text)
        self.progress.start(text, pieces)

    def _fetch_pieces(self, jobs):
        tasks = [(job, key) for job in jobs for key in job.missing]
        for job in {id(job): job for job, _ in tasks}.values():
            job.store.sweep(job.record)
        self._all_at_once(self._piece, tasks)

    def _piece(self, task):
        job, (row, col) = task
        number = row * (job.record["width"] // job.record["piece"][0] + 1) + col + 1
        with job.store.lock(job.record, number):
            path = job.store.piece(job.record, row, col)
            if path is None:
                try:
                    content = reader.read_piece(job.tile, job.record, row, col, self.web)
                except Absent:
                    raise ServerError(f"tile {job.tile.name} vanished from the server (HTTP 404)") from None
                path = job.store.add(job.record, row, col, content)
            job.paths[row, col] = path
        self._count(1)

    def _count(self, amount):
        self.progress.step(amount)

    def _all_at_once(self, action, tasks):
        """On a few threads; the first failure ends all."""
        pool = concurrent.futures.ThreadPoolExecutor(self.options.threads or 4)
        try:
            waiting = [pool.submit(action, task) for task in tasks]
            for done in concurrent.futures.as_completed(waiting):
                done.result()
        finally:
            pool.shutdown(wait=False, cancel_futures=True)

    # -- putting it together ----------------------------------------------------------------------------------------

    def _canvas(self, jobs, native, target, outline, box):
        self.progress.status("putting the tiles together")
        wide = any(job.record["type"] in ("Float64", "Int32", "UInt32") for job in jobs)
        canvas = mosaic.Canvas(native, np.float64 if wide else np.float32)
        for job in jobs:
            self._lay(job, canvas)
        warped = [job.record["name"] for job in jobs if job.record["wkt"] != native.wkt or
                  abs(job.record["transform"][1] / native.dx - 1) > 1e-6]
        counts = {"resampling": "none", "filled_cells": 0, "notes": self.notes}
        if warped:
            counts["resampling"] = "bilinear where tiles have other cells: " + ", ".join(sorted(warped))
        if self.options.fill_voids:
            counts["filled_cells"] = canvas.fill_voids()
        if target is not None:
            canvas = canvas.moved_to(target)
            counts["resampling"] = "bilinear"
        self._count_voids(canvas, counts, outline)
        counts["bounds_deg"] = bounds_in(canvas.grid.bounds(), canvas.grid.system(), wgs84())
        return canvas, counts, jobs

    def _lay(self, job, canvas):
        if job.store is None:
            job.record["sha256"] = cache_module.sha256_of(job.tile.address)
            try:
                canvas.lay(job.record, job.window, reader.read_window(gdal.Open(job.tile.address), job.window))
            except RuntimeError:
                raise UserError(f"the tile '{job.tile.address}' cannot be read whole: truncated or damaged") from None
            return
        window = job.window
        heights = np.full((window.tall, window.wide), np.nan, canvas.heights.dtype)
        for (row, col), path in job.paths.items():
            piece = reader.piece_window(job.record, row, col)
            x0, y0 = max(piece.x, window.x), max(piece.y, window.y)
            x1, y1 = min(piece.x + piece.wide, window.x + window.wide), min(piece.y + piece.tall, window.y + window.tall)
            values = gdal.Open(path).ReadAsArray(x0 - piece.x, y0 - piece.y, x1 - x0, y1 - y0)
            heights[y0 - window.y:y1 - window.y, x0 - window.x:x1 - window.x] = values
        canvas.lay(job.record, window, heights)

    def _count_voids(self, canvas, counts, outline):
        inside = canvas.keep_inside(outline) if outline is not None else np.ones(canvas.heights.shape, bool)
        empty = np.isnan(canvas.heights) & inside
        counts["void_cells"] = int((empty & (canvas.covered == 1)).sum())
        counts["cells_without_tile"] = int((empty & (canvas.covered == 0)).sum())
        if not np.isfinite(canvas.heights).any():
            raise UserError(f"{self.source.name} has no heights there: every cell of the region is void")
        total = int(inside.sum())
        for key, what in (("void_cells", "voids of the source"), ("cells_without_tile", "under no tile (sea, or no coverage)")):
            if counts[key]:
                share = 100 * counts[key] / total
                more = "; --fill-voids interpolates them" if key == "void_cells" and not self.options.fill_voids else ""
                self.notes.append(f"{counts[key]} of {total} cells ({share:.2g} %) are {what}{more}")


class Planned(Exception):
    """All that --dry-run asked for: the plan."""


def _megabytes(count):
    return f"{count / 1e6:,.1f} MB" if count < 1e9 else f"{count / 1e9:,.2f} GB"

