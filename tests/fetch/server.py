# SPDX-License-Identifier: GPL-3.0-or-later
"""A server on loopback with range requests, over a folder, which can be told to fail."""
import http.server
import os
import threading
import time
import urllib.parse


class Fault:
    """How an answer goes wrong. `skip`: after how many that are well; `times`: how often; then the server is well again."""

    def __init__(self, kind, times=10 ** 9, skip=0, **values):
        self.kind, self.times, self.skip, self.values = kind, times, skip, values


class Server:
    """Serves `folder`; `faults` maps a part of an address to a Fault; `dynamic` maps a path to a function of the query
    that gives (status, content type, bytes). Everything asked for is in `asked` as (path with query, first, last, sent)."""

    def __init__(self, folder):
        self.folder, self.faults, self.dynamic, self.asked, self.ranges = str(folder), {}, {}, [], True
        self.lock = threading.Lock()
        handler = type("Handler", (_Handler,), {"owner": self})
        self._server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
        self._server.daemon_threads = True
        self._server.handle_error = lambda *_: None  # clients that are killed
        self.port = self._server.server_address[1]
        self.url = f"http://127.0.0.1:{self.port}"
        threading.Thread(target=self._server.serve_forever, args=(0.05,), daemon=True).start()

    def close(self):
        self._server.shutdown()
        self._server.server_close()

    def well(self):
        self.faults, self.asked, self.ranges = {}, [], True

    def fault_for(self, path):
        with self.lock:
            for part, fault in self.faults.items():
                if part in path and fault.skip > 0:
                    fault.skip -= 1
                elif part in path and fault.times > 0:
                    fault.times -= 1
                    return fault
        return None

    def bytes_sent(self, part):
        return sum(sent for path, _, _, sent in self.asked if part in path)


class _Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    owner = None

    def log_message(self, *_):
        pass

    def do_HEAD(self):
        self.answer(body=False)

    def do_GET(self):
        self.answer(body=True)

    def answer(self, body):
        try:
            fault = self.owner.fault_for(self.path)
            if fault is not None:
                self.fail(fault, body)
            else:
                self.serve(body)
        except (BrokenPipeError, ConnectionResetError):
            pass

    def serve(self, body, limit=None, delay=0.0):
        """The file or the part asked for; `limit` breaks the answer off after so many bytes."""
        path, _, query = self.path.partition("?")
        if path in self.owner.dynamic:
            status, kind, content = self.owner.dynamic[path](urllib.parse.parse_qs(query))
            return self.send(status, kind, content)
        file = os.path.normpath(self.owner.folder + urllib.parse.unquote(path))
        if not os.path.isfile(file):
            return self.send(404, "application/xml", b"<Error><Code>NoSuchKey</Code></Error>")
        with open(file, "rb") as stream:
            content = stream.read()
        first, last, status = 0, len(content) - 1, 200
        wanted = self.headers.get("Range", "")
        if wanted.startswith("bytes=") and self.owner.ranges:
            start, _, end = wanted[6:].partition("-")
            first, status = int(start), 206
            last = min(int(end) if end else last, last)
            if first > len(content) - 1:
                return self.send(416, "text/plain", b"")
        part = content[first:last + 1]
        self.send_response(status)
        self.send_header("Content-Type", "image/tiff")
        self.send_header("Content-Length", str(len(part)))
        self.send_header("ETag", f'"{os.path.getsize(file):x}-{int(os.path.getmtime(file)):x}"')
        self.send_header("Last-Modified", self.date_time_string(int(os.path.getmtime(file))))
        if self.owner.ranges:
            self.send_header("Accept-Ranges", "bytes")
        if status == 206:
            self.send_header("Content-Range", f"bytes {first}-{last}/{len(content)}")
        self.end_headers()
        time.sleep(delay)
        sent = part if limit is None else part[:limit]
        self.owner.asked.append((self.path, first, last, len(sent) if body else 0))
        if body:
            self.wfile.write(sent)
        if limit is not None:
            self.close_connection = True
        return None

    def send(self, status, kind, content, **headers):
        self.owner.asked.append((self.path, None, None, len(content)))
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        for name, value in headers.items():
            self.send_header(name.replace("_", "-"), value)
        self.end_headers()
        self.wfile.write(content)

    def fail(self, fault, body):
        values = fault.values
        if fault.kind == "status":
            self.send(values["status"], "text/html", b"<html><body>no</body></html>", **values.get("headers", {}))
        elif fault.kind == "html":
            self.send(200, "text/html", b"<!DOCTYPE html><html><body>Please sign in</body></html>")
        elif fault.kind == "broken":
            self.serve(body, limit=values["after"])
        elif fault.kind == "silent":
            time.sleep(values["seconds"])
            self.close_connection = True
        elif fault.kind == "slow":
            self.serve(body, delay=values["seconds"])
        elif fault.kind == "redirect":
            self.send(302, "text/plain", b"", Location=values["to"])
