# SPDX-License-Identifier: GPL-3.0-or-later
"""Telling how far things are: one line that rewrites itself on a terminal, nothing elsewhere."""
import sys
import threading

CLEAR = "\r\033[K"
BAR = 30


class Progress:
    def __init__(self, quiet):
        self.shows = not quiet and sys.stderr.isatty()
        self._done, self._total, self._lock = 0, 0, threading.Lock()

    def start(self, text, total):
        """What is about to be read, as a line that stays; then the bar starts from nothing."""
        if self.shows:
            sys.stderr.write(f"{CLEAR}thalweg: {text}\n")
        self._done, self._total = 0, total

    def step(self, amount):
        with self._lock:
            self._done += amount
            if self.shows and self._total:
                share = min(1.0, self._done / self._total)
                bar = "#" * round(BAR * share)
                sys.stderr.write(f"{CLEAR}thalweg: fetching [{bar:<{BAR}}] {share:4.0%}")
                sys.stderr.flush()

    def status(self, text):
        if self.shows:
            sys.stderr.write(f"{CLEAR}thalweg: {text}")
            sys.stderr.flush()

    def clear(self):
        if self.shows:
            sys.stderr.write(CLEAR)
            sys.stderr.flush()
