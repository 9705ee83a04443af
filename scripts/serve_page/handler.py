"""Answers one request: checks that it may be answered, finds what it asks for, and does it."""
import http.server
import json
import secrets
import select
import shutil
import socket
import time
from urllib.parse import quote, unquote

from .faults import Fault
from .static import FILES, POLICY, START, TYPES

LONGEST_JSON = 1 << 20
MOST_DIGITS = 30  # of a length
PERIOD_S = 1  # between two looks whether a page is still open
MOST_IGNORED_BYTES = 1 << 26  # of a refused upload; the browser shows the refusal only after it has sent enough
JSON, BYTES = "application/json", "application/octet-stream"
REFUSAL = b"403: this address lacks the secret that podm serve printed\n"
HEADERS = {"Content-Security-Policy": POLICY, "X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer",
           "Cache-Control": "no-store", "Cross-Origin-Resource-Policy": "same-origin",
           "Cross-Origin-Opener-Policy": "same-origin"}


class Handler(http.server.BaseHTTPRequestHandler):
    """Paths are /TOKEN/, /TOKEN/FILE and /TOKEN/pages/PAGE/ACTION."""

    protocol_version = "HTTP/1.1"
    timeout = 60  # seconds without a byte

    def parse_request(self):
        """Refuses everything without the token, whatever its method and path."""
        if not super().parse_request():
            return False
        word, _, self._asked = self.path.partition("?")[0].removeprefix("/").partition("/")
        if self._is_of_this_machine() and _is_same(word, self.server.token):
            return True
        self.close_connection = True
        if self._is_of_this_machine() and self.command == "GET" and self.server.is_once(word):
            self._send(303, "text/plain", b"", Location=f"/{self.server.token}/")
        else:
            self._send(403, "text/plain", REFUSAL)
        return False

    def _is_of_this_machine(self):
        """Returns false if the request names another host (DNS rebinding), or comes from a page of another site."""
        hosts = self.headers.get_all("Host") or []
        return (len(hosts) == 1 and hosts[0] in self.server.hosts
                and all(origin == f"http://{hosts[0]}" for origin in self.headers.get_all("Origin") or []))

    def do_GET(self):
        self._answer({"options": self._options, "events": self._events, "image": self._image, "mesh": self._mesh,
                      "mesh.bytes": self._mesh_bytes, "download": self._download})

    def do_POST(self):
        self._answer({"begin": lambda page: page.begin(), "open": lambda page: page.open_image(),
                      "lines": lambda page: page.lines(self._settings(page)),
                      "plan": lambda page: page.predict(self._settings(page)),
                      "run": lambda page: page.run(self._settings(page)), "stop": lambda page: page.stop(),
                      "leave": self._leave})

    def do_PUT(self):
        self._answer({"file": self._upload})

    def _answer(self, actions):
        self._is_unread = self.command == "PUT"
        try:
            self._body = self.rfile.read(self._length(LONGEST_JSON)) if self.command == "POST" else b""
            if not self._asked.startswith("pages/"):
                self._send_file(self._asked)
                return
            _, name, action, *more = [*self._asked.split("/"), "", ""]
            self._page_name, self._argument = name, unquote(more[0])
            if self.command == "POST" and name == "new":
                self._send_json({"page": self.server.new_workspace()})
            elif action not in actions:
                raise Fault("This page has no such part.", 404)
            else:
                result = actions[action](self.server.workspace(name))
                if result is not _SENT:
                    self._send_json(result)
        except Fault as fault:
            self._refuse(fault)

    def _send_file(self, name):
        if self.command != "GET":
            raise Fault("This page has no such part.", 404)
        if not name:
            self._send(200, TYPES[".html"], START)
        elif name in FILES:
            self._send(200, *FILES[name])
        else:
            raise Fault("This page has no such part.", 404)

    def _options(self, page):
        tools = page.tools
        return {"sliders": tools.declared.sliders(), "formats": tools.declared.extensions,
                "most_bytes": tools.most_bytes}

    def _settings(self, page):
        try:
            sent = json.loads(self._body)
        except (ValueError, RecursionError):
            raise Fault("The settings are not those of this page.") from None
        return page.settings(sent)

    def _upload(self, page):
        length = self._length(page.tools.most_bytes)
        self._is_unread = False  # it is read next, or the connection is at its end
        page.upload(self._argument, self.rfile, length)

    def _length(self, most):
        length = self.headers.get("Content-Length", "")
        if not length.isdecimal() or len(length) > MOST_DIGITS:
            self.close_connection = True  # the end of the body is unknown
            raise Fault("The length of the upload is missing.", 411)
        if int(length) > most:
            self._is_unread = True
            raise Fault(f"{int(length) / 2**20:,.1f} MiB are more than the {most / 2**20:,.1f} MiB that this server "
                        "takes (--max-upload-mib).", 413)
        return int(length)

    def _leave(self, _page):
        self.server.close_workspace(self._page_name)

    def _events(self, page):
        """Sends the state of the page whenever it changes, until the page is closed."""
        self.close_connection = True
        self._send_head(200, "text/event-stream")
        version = None
        while not page.is_closed and not _is_closed(self.connection):
            page.seen_s = time.monotonic()
            state, now = page.wait_for_change(version, PERIOD_S)
            text = f"data: {json.dumps(state)}\n\n" if now != version else ":\n\n"
            version = now
            self.wfile.write(text.encode())
        return _SENT

    def _image(self, page):
        return self._send_path(page.shown_image())

    def _mesh(self, page):
        return page.turned()[0]

    def _mesh_bytes(self, page):
        self._send(200, BYTES, page.turned()[1])
        return _SENT

    def _download(self, page):
        name, path = page.download(self._argument)
        try:
            return self._send_path(path, **{"Content-Disposition": f"attachment; filename*=UTF-8''{quote(name)}"})
        finally:
            path.unlink()

    def _send_path(self, path, **headers):
        try:
            file = open(path, "rb")
        except OSError:
            raise Fault("This file is gone.", 410) from None
        with file:
            self._send_head(200, BYTES, path.stat().st_size, **headers)
            shutil.copyfileobj(file, self.wfile)
        return _SENT

    def _send_json(self, value, status=200):
        self._send(status, JSON, json.dumps(value).encode())

    def _send(self, status, kind, content, **headers):
        self._send_head(status, kind, len(content), **headers)
        if self.command != "HEAD":
            self.wfile.write(content)

    def _send_head(self, status, kind, length=None, **headers):
        self.send_response(status)
        lengths = {} if length is None else {"Content-Length": str(length)}
        closes = {"Connection": "close"} if self.close_connection else {}
        for name, value in {"Content-Type": kind, **HEADERS, **lengths, **closes, **headers}.items():
            self.send_header(name, value)
        self.end_headers()

    def _refuse(self, fault):
        """Sends the sentence. The rest of a body is read and dropped, so that the browser shows the sentence."""
        self.close_connection = self.close_connection or self._is_unread
        self._send_json({"fault": str(fault)}, fault.status)
        if not self.close_connection:
            return
        self.wfile.flush()
        self.connection.shutdown(socket.SHUT_WR)
        self.connection.settimeout(2)
        dropped = 0
        while dropped < MOST_IGNORED_BYTES and (part := self.connection.recv(1 << 16)):
            dropped += len(part)

    def version_string(self):
        return "podm"

    def log_message(self, *_arguments):
        """Prints nothing: addresses hold the token."""


_SENT = object()


def _is_same(word, secret):
    return secrets.compare_digest(word.encode(), secret.encode())


def _is_closed(connection):
    """Returns true if the other side has closed the connection."""
    readable, _, _ = select.select([connection], [], [], 0)
    try:
        return bool(readable) and connection.recv(1, socket.MSG_PEEK) == b""
    except OSError:
        return True
