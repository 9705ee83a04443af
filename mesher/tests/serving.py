"""Runs podm serve, and talks to it as a browser does."""

import http.client
import json
import os
import pathlib
import signal
import socket
import time
import urllib.parse

from podm_process import PodmTestCase, start_podm

TIMEOUT_S = 60


class Server:
    """A running server. `folder` holds its scratch folder."""

    def __init__(self, folder, *options):
        self.scratch = pathlib.Path(folder)
        environment = {**os.environ, "TMPDIR": str(folder)}
        self.process = start_podm("serve", "--no-browser", *options, env=environment)
        self.address = self.process.stdout.readline().strip()
        parts = urllib.parse.urlsplit(self.address)
        self.port, self.token = parts.port, parts.path.strip("/")
        self.host = f"127.0.0.1:{self.port}"

    def end(self, number=signal.SIGTERM):
        """Returns the exit code and what is printed on standard error."""
        if self.process.poll() is None:
            self.process.send_signal(number)
        _, stderr = self.process.communicate(timeout=TIMEOUT_S)
        return self.process.returncode, stderr

    def ask(self, method, path, body=None, **headers):
        """Returns the response to a path as it is written, which is not resolved; its content is in `content`."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=TIMEOUT_S)
        connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
        headers = {"Host": self.host, **{name.replace("_", "-"): value for name, value in headers.items()}}
        if method == "POST":
            body = body or b""
        if body is not None:
            headers.setdefault("Content-Length", str(len(body)))
        for name, value in headers.items():
            if value is not None:
                connection.putheader(name, value)
        connection.endheaders(body)
        response = connection.getresponse()
        response.content = response.read()
        connection.close()
        return response

    def raw(self, data):
        """Returns all that the server sends after these bytes, when no more of them follow."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=TIMEOUT_S) as connection:
            connection.sendall(data)
            connection.shutdown(socket.SHUT_WR)
            return b"".join(iter(lambda: connection.recv(65536), b""))

    def files(self):
        """Returns all files in the server's scratch folder, without its lock."""
        return sorted(path for path in self.scratch.rglob("*") if path.is_file() and path.name != "lock")


class Page:
    """An open page of the server, without a browser."""

    def __init__(self, server):
        self.server = server
        self.name = self.json("POST", "new")["page"]
        self._events = http.client.HTTPConnection("127.0.0.1", server.port, timeout=TIMEOUT_S)
        self._events.request("GET", f"/{server.token}/pages/{self.name}/events")
        self._stream = self._events.getresponse()

    def ask(self, method, action, body=None):
        name = f"{self.name}/{action}" if hasattr(self, "name") else action
        return self.server.ask(method, f"/{self.server.token}/pages/{name}", body)

    def json(self, method, action, value=None):
        """Returns the answer, which must not be a fault."""
        response = self.ask(method, action, None if value is None else json.dumps(value).encode())
        assert response.status == 200, (action, response.status, response.content)
        return json.loads(response.content)

    def fault(self, method, action, body=None):
        """Returns the status and the sentence of a refusal."""
        response = self.ask(method, action, body)
        return response.status, json.loads(response.content)["fault"]

    def open(self, *paths):
        """Sends files and returns what the server reports about their image."""
        self.json("POST", "begin")
        for path in paths:
            self.json_of(self.ask("PUT", f"file/{urllib.parse.quote(path.name)}", path.read_bytes()))
        return self.json("POST", "open")

    @staticmethod
    def json_of(response):
        assert response.status == 200, response.content
        return json.loads(response.content)

    def mesh(self, sent):
        """Runs a job to its end. Returns the last state."""
        self.json("POST", "run", sent)
        return self.wait_for("done", "stopped", "failed")

    def wait_for(self, *stages):
        """Returns the next state of these stages."""
        end_s = time.monotonic() + TIMEOUT_S
        while time.monotonic() < end_s:
            line = self._stream.readline()
            if line.startswith(b"data: ") and (state := json.loads(line[6:]))["stage"] in stages:
                return state
        raise AssertionError(f"no stage {stages}")

    def close(self):
        self._stream.close()
        self._events.close()


def settings(keep=None, merges=(), **numbers):
    return {"keep": keep, "merges": [{"name": name, "values": values} for name, values in merges],
            "numbers": {name.replace("_", "-"): value for name, value in numbers.items()}}


class ServeTestCase(PodmTestCase):
    """A test with a server of its own."""

    OPTIONS = []

    def setUp(self):
        super().setUp()
        self.temporary = self.folder / "tmp"
        self.temporary.mkdir()
        self.server = self.start(*self.OPTIONS)

    def start(self, *options):
        server = Server(self.temporary, *options)
        self.addCleanup(server.end)
        return server

    def page(self):
        page = Page(self.server)
        self.addCleanup(page.close)
        return page
