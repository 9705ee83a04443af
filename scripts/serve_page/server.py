"""The server of `podm serve`. It answers on 127.0.0.1 and only to addresses with its token."""
import contextlib
import errno
import http.server
import json
import os
import secrets
import signal
import sys
import threading
import time
import webbrowser
from pathlib import Path

from .child import Limits, available_bytes
from .faults import Fault
from .handler import Handler
from .picture import load_vtk_meanwhile
from .scratch import Scratch
from .settings import Declared
from .workspace import Workspace

ADDRESS = "127.0.0.1"
MOST_PAGES = 4
SECONDS_UNSEEN = 8  # a page that is open is seen every second


class Tools:
    """The programs and the limits, the same for all pages. `request`: programs (their folder), port, browser,
    max_upload_mib, max_memory_gib (0: 80 % of the available memory), max_seconds."""

    def __init__(self, request):
        self.podm, self.verifier = (Path(request["programs"]) / name for name in ("podm", "podm-verify"))
        self.declared = Declared(self.podm)
        self.most_bytes = int(request["max_upload_mib"] * 2**20)
        gib = request["max_memory_gib"]
        self.limits = Limits(int(gib * 2**30) or available_bytes(), request["max_seconds"])
        self.limits_of_mesher = ["--max-seconds", repr(request["max_seconds"]),
                                 *(["--max-memory-gib", repr(gib)] if gib else [])]
        self.converting = threading.Lock()
        self.slot = threading.Lock()  # held by the one job that runs


class Server(http.server.ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, port, tools, scratch):
        super().__init__((ADDRESS, port), Handler)
        self.tools, self._scratch = tools, scratch
        self.token, self._once = secrets.token_urlsafe(32), secrets.token_urlsafe(32)
        self.hosts = {f"{name}:{self.server_port}" for name in (ADDRESS, "localhost")}
        self._workspaces = {}
        self._lock = threading.Lock()

    @property
    def address(self):
        return f"http://{ADDRESS}:{self.server_port}/{self.token}/"

    @property
    def address_once(self):
        """The address for the browser's command line, which other users can see. It works once."""
        return f"http://{ADDRESS}:{self.server_port}/{self._once}/"

    def is_once(self, word):
        """Returns true at the first call with the word of address_once."""
        with self._lock:
            is_it = bool(self._once) and secrets.compare_digest(word.encode(), self._once.encode())
            if is_it:
                self._once = ""
            return is_it

    def new_workspace(self):
        with self._lock:
            if len(self._workspaces) >= MOST_PAGES:
                raise Fault(f"{MOST_PAGES} pages are open; close one of them.", 503)
            name = secrets.token_urlsafe(12)
            self._workspaces[name] = Workspace(self.tools, self._scratch.new_folder())
            return name

    def workspace(self, name):
        with self._lock:
            if name not in self._workspaces:
                raise Fault("The data of this page are gone; load the page again.", 410)
            return self._workspaces[name]

    def close_workspace(self, name):
        with self._lock:
            closed = self._workspaces.pop(name, None)
        if closed:
            closed.close()

    def service_actions(self):
        """Removes the data of pages that were closed. Called about twice per second."""
        with self._lock:
            unseen = [name for name, one in self._workspaces.items()
                      if time.monotonic() - one.seen_s > SECONDS_UNSEEN]
        for name in unseen:
            self.close_workspace(name)

    def close(self):
        self.server_close()
        for name in list(self._workspaces):
            self.close_workspace(name)

    def handle_error(self, request, client_address):
        if not isinstance(sys.exception() if hasattr(sys, "exception") else sys.exc_info()[1], OSError):
            super().handle_error(request, client_address)  # not merely a browser that went away


def main(arguments):
    """Returns the exit code: 0 if a signal ended the server, 2 if the port is not available."""
    request = json.loads(arguments[0])
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, _end)
    try:
        return _serve(request)
    except SystemExit:
        return 0


def _end(number, _frame):
    for one in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(one, signal.SIG_IGN)  # the server is ending
    raise SystemExit(0)


def _serve(request):
    tools = Tools(request)
    with contextlib.ExitStack() as at_end:
        scratch = Scratch()
        at_end.callback(scratch.close)
        try:
            server = Server(request["port"], tools, scratch)
        except OSError as error:
            print(f"podm: serve: {_why(request['port'], error)}", file=sys.stderr)
            return 2
        at_end.callback(server.close)
        load_vtk_meanwhile()
        print(server.address, flush=True)
        print("podm: serving this page on this machine alone; Ctrl-C ends it", file=sys.stderr, flush=True)
        if request["browser"] and any(name in os.environ for name in ("DISPLAY", "WAYLAND_DISPLAY")):
            threading.Thread(target=webbrowser.open, args=(server.address_once,), daemon=True).start()
        server.serve_forever()
    return 0


def _why(port, error):
    if error.errno == errno.EADDRINUSE:
        return f"port {port} of {ADDRESS} is in use; choose another one, or leave out --port"
    return f"port {port} of {ADDRESS} cannot be had: {error.strerror}"
