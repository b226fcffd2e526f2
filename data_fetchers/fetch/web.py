# SPDX-License-Identifier: GPL-3.0-or-later
"""Asking servers: only hosts that the source or the user names, few patient attempts, and plain words for failures.

No query string and no secret ever stands in a message."""
import http.client
import os
import socket
import ssl
import time
import urllib.error
import urllib.parse
import urllib.request
from dataclasses import dataclass
from email.utils import parsedate_to_datetime

from catalogue import host_of
from problems import ServerError, UserError, public

AGENT = "thalweg-fetch"
#: Worth asking again; the others say the same tomorrow.
PASSING = (408, 425, 429, 500, 502, 503, 504)
LONGEST_PAUSE_S = 60.0
BLOCK = 1 << 18
#: A server that sends less than this for a whole timeout hangs.
LEAST_BYTES_PER_S = 500


class Absent(Exception):
    """404 or 410: the server is well and has no such file."""


class Passing(Exception):
    """A failure that may be gone at the next attempt. pause_s: what the server asked for, or None."""

    def __init__(self, text, pause_s=None):
        super().__init__(text)
        self.pause_s = pause_s


@dataclass
class Answer:
    """What a server says of a file."""
    url: str  #: after redirects
    size: int | None
    ranges: bool  #: it serves parts
    start: bytes  #: the first bytes
    etag: str
    modified: str


class Web:
    """The way out, with one source's hosts and the user's patience."""

    def __init__(self, hosts, retries=4, timeout_s=30.0, pause_s=1.0):
        self.hosts, self.retries, self.timeout_s, self.pause_s = set(hosts), retries, timeout_s, pause_s
        self._opener = urllib.request.build_opener(_Redirects(self))

    def check_host(self, url, why):
        host = host_of(url)
        if host not in self.hosts:
            raise UserError(f"{why} '{host}', which is no host of this source; --allow-host {host} permits it")

    def again(self, action, what):
        """The action's result; repeated with growing pauses while it fails in passing."""
        for attempt in range(self.retries + 1):
            try:
                return action()
            except Passing as problem:
                if attempt == self.retries:
                    times = f" ({attempt + 1} attempts)" if attempt else ""
                    raise ServerError(f"{what}: {problem}{times}") from None
                time.sleep(min(LONGEST_PAUSE_S, max(problem.pause_s or 0, self.pause_s * 2 ** attempt)))

    def open(self, url, first=None, last=None):
        """The open response. Absent, Passing, UserError or ServerError otherwise."""
        self.check_host(url, "the address is on")
        request = urllib.request.Request(url, headers={"User-Agent": AGENT, "Accept-Encoding": "identity"})
        if first is not None:
            request.add_header("Range", f"bytes={first}-{last}")
        with _in_words(url):
            return self._opener.open(request, timeout=self.timeout_s)

    def probe(self, url):
        """Is it there, how large, and what does it begin with?"""
        def ask():
            with self.open(url, 0, 15) as response, _in_words(url):
                ranges = response.status == 206
                size = _total(response) if ranges else _number(response.headers.get("Content-Length"))
                return Answer(response.url, size, ranges, response.read(16), response.headers.get("ETag", ""),
                              _day_and_time(response.headers.get("Last-Modified")))
        return self.again(ask, public(url))

    def text(self, url, most=64 << 20):
        """A whole text, such as a list of tiles."""
        def ask():
            with self.open(url) as response, _in_words(url):
                content = response.read(most + 1)
                _check_whole(response, len(content))
                return content
        content = self.again(ask, public(url))
        if len(content) > most:
            raise ServerError(f"{public(url)}: more than {most >> 20} MB where a list was expected")
        return content.decode("utf-8", "replace")

    def download(self, url, path, what, tick=lambda count: None):
        """The whole file into path; returns the day and time of its last change, and its ETag."""
        def ask():
            started, count = time.monotonic(), 0
            with self.open(url) as response, open(path, "wb") as file:
                if response.status == 204:
                    raise UserError(f"{what}: the server has no data there")
                while block := _read(response, url):
                    file.write(block)
                    count += len(block)
                    tick(len(block))
                    seconds = time.monotonic() - started
                    if seconds > self.timeout_s and count < LEAST_BYTES_PER_S * seconds:
                        raise Passing(f"the server sends almost nothing ({count} bytes in {seconds:.0f} s)")
                _check_whole(response, count)
                file.flush()
                os.fsync(file.fileno())
                return _day_and_time(response.headers.get("Last-Modified")), response.headers.get("ETag", "")
        return self.again(ask, what)


class _Redirects(urllib.request.HTTPRedirectHandler):
    """Follows a redirect only to hosts that are allowed: a key must not be carried elsewhere."""
    max_redirections = 5

    def __init__(self, web):
        self.web = web

    def redirect_request(self, request, stream, code, message, headers, new_url):
        self.web.check_host(new_url, f"{host_of(request.full_url)} redirects to")
        return super().redirect_request(request, stream, code, message, headers, new_url)


class _in_words:
    """Turns the many exceptions of http and sockets into ours."""

    def __init__(self, url):
        self.url = url

    def __enter__(self):
        return self

    def __exit__(self, kind, problem, trace):
        if problem is None or isinstance(problem, (Absent, Passing, UserError, ServerError)):
            return False
        if isinstance(problem, urllib.error.HTTPError):
            problem.close()  # unread: an error's page may repeat the address with its key
            raise meaning_of(problem.code, self.url, problem.headers) from None
        reason = problem.reason if isinstance(problem, urllib.error.URLError) else problem
        if isinstance(reason, (TimeoutError, socket.timeout)):
            raise Passing("no answer in time") from None
        if isinstance(reason, ssl.SSLCertVerificationError):
            raise ServerError(f"{public(self.url)}: its certificate is not valid ({reason.verify_message})") from None
        if isinstance(reason, http.client.IncompleteRead):
            raise Passing("the answer broke off") from None
        if isinstance(reason, (OSError, http.client.HTTPException)):
            raise Passing(f"no connection ({_plain(reason)})") from None
        return False


def meaning_of(status, url, headers=None):
    """The exception that an HTTP status stands for."""
    if status in (404, 410):
        return Absent(public(url))
    if status in PASSING:
        word = "too many requests" if status == 429 else "the server failed"
        return Passing(f"{word} (HTTP {status})", _number((headers or {}).get("Retry-After")))
    word = "access refused " if status in (401, 403) else ""
    problem = ServerError(f"{public(url)}: {word}(HTTP {status})")
    problem.status = status
    return problem


def _read(response, url):
    with _in_words(url):
        return response.read(BLOCK)


def _check_whole(response, count):
    promised = _number(response.headers.get("Content-Length"))
    if promised is not None and count < promised:
        raise Passing(f"the answer broke off after {count} of {promised} bytes")


def _total(response):
    return _number(response.headers.get("Content-Range", "").rpartition("/")[2])


def _number(text):
    try:
        return int(text)
    except (TypeError, ValueError):
        return None


def _day_and_time(text):
    try:
        return parsedate_to_datetime(text).strftime("%Y-%m-%dT%H:%M:%SZ")
    except (TypeError, ValueError):
        return ""


def _plain(reason):
    return getattr(reason, "strerror", None) or type(reason).__name__


def quote(values):
    return urllib.parse.urlencode(values)
