# SPDX-License-Identifier: GPL-3.0-or-later
"""The cache: pieces of tiles, each a small GeoTIFF whose name holds its checksum.

    CACHE/v1/SOURCE/TILE-xxxxxxxx/tile.json            what is known of the tile: version, grid, dates
    CACHE/v1/SOURCE/TILE-xxxxxxxx/VERSION/p3_5-SHA.tif  piece in row 3, column 5

A piece appears by one rename, so whoever is killed leaves whole pieces or none. Processes that want one piece at the same
moment wait for each other by a lock on a byte of the version's lock file, which the system lets go if its holder dies.
A new version of a tile on the server gets a folder of its own: nobody's pieces vanish under them."""
import contextlib
import fcntl
import hashlib
import json
import os
import re
import shutil
import threading
import time
from datetime import datetime, timezone

from problems import UserError


def default_folder():
    home = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return os.path.join(home, "thalweg")


def sha256_of(path):
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def safe(name):
    """A name from a server as a file name: it can neither leave its folder nor hide."""
    return re.sub(r"[^A-Za-z0-9._-]", "_", name.rpartition("/")[2]).lstrip(".")[:100] or "tile"


def write_whole(path, content):
    """Bytes or text under a name that appears in one step."""
    partial = f"{path}.partial-{os.getpid()}-{threading.get_ident()}"
    try:
        with open(partial, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
            file.flush()
            os.fsync(file.fileno())
        os.replace(partial, path)
    except OSError:
        with contextlib.suppress(OSError):
            os.unlink(partial)
        raise


def today():
    return datetime.now(timezone.utc).strftime("%Y-%m-%d")


class Cache:
    def __init__(self, folder):
        self.folder = os.path.join(os.path.abspath(folder), "v1")
        try:
            os.makedirs(self.folder, exist_ok=True)
        except OSError as problem:
            raise UserError(f"the cache '{folder}' cannot be written: {problem.strerror}; --cache names another") from None

    def tile(self, source, name, address):
        key = hashlib.sha256(address.encode()).hexdigest()[:8]
        return TileStore(os.path.join(self.folder, safe(source), f"{safe(name)}-{key}"))

    @staticmethod
    def keep(path, text):
        """Keeps a list under its path."""
        write_whole(path, text)

    def text(self, source, name, address):
        """Path of a cached list of tiles."""
        key = hashlib.sha256(address.encode()).hexdigest()[:8]
        folder = os.path.join(self.folder, safe(source))
        os.makedirs(folder, exist_ok=True)
        return os.path.join(folder, f"{safe(name)}-{key}.txt")


class TileStore:
    """What the cache holds of one tile."""

    def __init__(self, folder):
        self.folder = folder
        self._lock_file = None
        self._opening = threading.Lock()

    def record(self):
        """The last known state of the tile, or None."""
        try:
            with open(os.path.join(self.folder, "tile.json"), encoding="utf-8") as file:
                return json.load(file)
        except (OSError, ValueError):
            return None

    def remember(self, record):
        os.makedirs(self.folder, exist_ok=True)
        write_whole(os.path.join(self.folder, "tile.json"), json.dumps(record, indent=1) + "\n")

    def version_folder(self, record):
        path = os.path.join(self.folder, record["version"])
        os.makedirs(path, exist_ok=True)
        return path

    def sweep(self, record):
        """Removes what processes that were killed left half-written more than a day ago."""
        folder = self.version_folder(record)
        for name in os.listdir(folder):
            path = os.path.join(folder, name)
            with contextlib.suppress(OSError):
                if ".partial-" in name and time.time() - os.path.getmtime(path) > 86400:
                    shutil.rmtree(path) if os.path.isdir(path) else os.unlink(path)

    def piece(self, record, row, col):
        """Path of a whole and sound piece, or None. A damaged one is removed."""
        folder = os.path.join(self.folder, record["version"])
        start = f"p{row}_{col}-"
        with contextlib.suppress(OSError):
            for name in sorted(os.listdir(folder)):
                if name.startswith(start) and name.endswith(".tif"):
                    path = os.path.join(folder, name)
                    if sha256_of(path) == name[len(start):-4]:
                        return path
                    os.unlink(path)
        return None

    def add(self, record, row, col, content):
        """Keeps the bytes of a piece; returns its path."""
        name = f"p{row}_{col}-{hashlib.sha256(content).hexdigest()}.tif"
        path = os.path.join(self.version_folder(record), name)
        write_whole(path, content)
        return path

    @contextlib.contextmanager
    def lock(self, record, number):
        """Alone with one piece of this version, among processes. Where the file system has no locks, not alone: then two
        may fetch the same piece, which costs time and nothing else."""
        with self._opening:
            if self._lock_file is None:
                path = os.path.join(self.version_folder(record), "lock")
                self._lock_file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
        locked = False
        with contextlib.suppress(OSError):
            fcntl.lockf(self._lock_file, fcntl.LOCK_EX, 1, number)
            locked = True
        try:
            yield
        finally:
            if locked:
                fcntl.lockf(self._lock_file, fcntl.LOCK_UN, 1, number)
