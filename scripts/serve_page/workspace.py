"""The data of one open page: its image, its mesh, and the program that works on them."""
import json
import shutil
import threading
import time
from pathlib import Path

from .child import Child
from .download import made_in
from .faults import Fault
from .picture import colours_of_image, make_showable, mesh_parts
from .settings import Settings, stem_of
from .upload import IMAGES, TABLES, check_header, checked_name, receive

SHOWN = "shown.nii"
NOTHING = {"stage": "none"}
SLOT_TRIES, SLOT_PERIOD_S = 10, 0.2
SECONDS_TO_WRITE = 60  # beyond its limit, for a mesh that reached it
SECONDS_TO_END = 10  # for a program that was killed


class Replaced(Fault):
    """A later request of the same page made this one needless."""


class Workspace:
    """`tools`: what all pages share (server.Tools). Files that were uploaded and files that are made have folders of
    their own. Programs run in the folder of uploads, so that their messages name files as the user does."""

    def __init__(self, tools, folder):
        self.tools = tools
        self.seen_s = time.monotonic()
        self._folder = folder
        self._images, self._made = folder / "images", folder / "made"
        self._changed = threading.Condition()
        self._state, self._version = NOTHING, 0
        self._child = self._converter = self._querying = self._latest = self._job = None
        self._is_closed = False
        self._clear()

    def _clear(self):
        self.image = self.table = self.info = self.parts = None
        for folder in (self._images, self._made):
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(mode=0o700)

    def close(self):
        """Ends the programs that run, waits for them, and removes everything."""
        with self._changed:
            self._is_closed = True
            self._changed.notify_all()
        self._kill()
        if converter := self._converter:
            converter.kill()
        if job := self._job:
            job.join(SECONDS_TO_END)
        shutil.rmtree(self._folder, ignore_errors=True)

    @property
    def is_closed(self):
        return self._is_closed

    def wait_for_change(self, version, timeout_s):
        """Returns the state and its version once it is newer than `version`, or after a time."""
        with self._changed:
            self._changed.wait_for(lambda: self._version != version or self._is_closed, timeout_s)
            return self._state, self._version

    def _show(self, **state):
        with self._changed:
            self._state, self._version = state, self._version + 1
            self._changed.notify_all()

    def begin(self):
        """Forgets the image and the mesh before files of another one come."""
        self._refuse_if_busy()
        self._latest = None  # replaces a query that runs
        self._kill()
        self._clear()
        self._show(**NOTHING)

    def upload(self, name, stream, length):
        receive(stream, length, self._images / checked_name(name))

    def open_image(self):
        """Returns what podm info says about the uploaded image, with colours."""
        names = sorted(path.name for path in self._images.iterdir())
        images = [name for name in names if name.endswith(IMAGES)]
        tables = [name for name in names if name.endswith(TABLES)]
        if len(images) != 1 or len(tables) > 1:
            raise Fault("One image is needed, with the voxels of its header and a table of label names at most.")
        check_header(self._images / images[0])
        self.image, self.table = images[0], next(iter(tables), None)
        shown = self._made / SHOWN
        self.info = self._info(["-o", shown])
        values = [label["value"] for label in self.info["labels"]]
        self.info["shown"] = make_showable(shown, values)
        self.colours = colours_of_image(self.info["labels"])
        for label in self.info["labels"]:
            label["colour"] = self.colours[label["value"]]
        return {**self.info, "path": self.image}

    def shown_image(self):
        self._need_image()
        return self._made / SHOWN

    def _image_arguments(self):
        return [self.image, *(["--label-names", self.table] if self.table else [])]

    def _need_image(self):
        if self.info is None:
            raise Fault("There is no image yet.", 409)

    def settings(self, sent):
        self._need_image()
        return Settings.of(sent, self.tools.declared)

    def lines(self, settings):
        return {"command": settings.command_line(self.image, self.table),
                "python": settings.python_lines(self.image, self.table, self.tools.declared)}

    def predict(self, settings):
        """Returns what podm info --plan predicts. A later call, or one of run(), ends this one, which returns None."""
        try:
            return self._info([*settings.of_labels(), "--plan", *settings.of_cells()])["plan"]
        except Replaced:
            return None

    def _info(self, arguments):
        """Returns what podm info reports. Raises Fault with its message if it fails."""
        mine = self._take_slot()
        try:
            self._querying = self._start([self.tools.podm, "info", *self._image_arguments(), "--json", *arguments])
            ended = self._querying.wait()
        finally:
            self._querying = self._child = None
            self.tools.slot.release()
        if self._latest is not mine:
            raise Replaced("A later request replaced this one.", 409)
        if ended.exit_code != 0:
            raise Fault(f"{self.image}: {ended.broken}." if ended.broken else _complaint(ended))
        return json.loads(ended.output)

    def _take_slot(self):
        """Waits for the one slot of jobs, and ends this page's own query in it. Raises Fault if the slot is taken, or
        if a later call of this page came."""
        mine = self._latest = object()
        for _ in range(SLOT_TRIES):
            if query := self._querying:
                query.kill()
            if self.tools.slot.acquire(timeout=SLOT_PERIOD_S):
                if self._latest is mine:
                    return mine
                self.tools.slot.release()
            if self._latest is not mine:
                raise Replaced("A later request replaced this one.", 409)
        raise Fault("Another job runs; this server runs one at a time.", 409)

    def _start(self, command, on_line=None, limits=None):
        if self._is_closed:
            raise Fault("The page is closed.", 410)
        self._child = Child(command, self._images, limits or self.tools.limits, on_line)
        return self._killed_if_closed(self._child)

    def _killed_if_closed(self, child):
        """Returns the child. Kills it if close() came before this page knew the child."""
        if self._is_closed:
            child.kill()
        return child

    def _kill(self):
        if child := self._child:
            child.kill()

    def run(self, settings):
        """Begins to mesh. wait_for_change() reports how it goes."""
        self._take_slot()
        self.parts = None
        self._show(stage="meshing", phase="start", fraction=0, cells=0, seconds=0)
        self._job = threading.Thread(target=self._run, args=(settings,), daemon=True)
        self._job.start()

    def stop(self):
        """Asks the mesher to end with a valid mesh, or with none if it has none yet; ends the verifier."""
        if child := self._child:
            child.stop()

    def _run(self, settings):
        try:
            mesh = self._mesh(settings)
            if mesh:
                self._verify(settings, mesh)
        except Fault as fault:
            self._show(stage="failed", fault=str(fault))
        except Exception as error:  # the page must not wait for ever
            self._show(stage="failed", fault=f"The server failed: {error}")
            raise
        finally:
            self._child = None
            self.tools.slot.release()

    def _mesh(self, settings):
        """Returns what the page shows of the mesh; None if there is none."""
        for path in self._made.iterdir():
            if path.name != SHOWN:
                path.unlink()
        limits = self.tools.limits
        command = [self.tools.podm, "mesh", *self._image_arguments(), *settings.of_labels(), *settings.of_cells(),
                   *self.tools.limits_of_mesher, "--quiet", "--json-progress", "--record", self._record, "-o",
                   self._mesh_path]
        child = self._start(command, self._progress, type(limits)(limits.memory_bytes,
                                                                  limits.seconds + SECONDS_TO_WRITE))
        ended = child.wait()
        if not self._mesh_path.exists():
            self._show(stage="stopped", fault=f"{self.image}: {ended.broken}." if ended.broken else
                       "" if ended.exit_code < 0 else _complaint(ended))
            return None
        record = json.loads(self._record.read_text())
        self.parts = mesh_parts(self._mesh_path, record["cells"], self.colours)
        mesh = {"cells": record["cells"], "vertices": record["vertices"], "turns": self.parts is not None,
                "seconds": sum(record["phases_s"].values()), "sha256": record["mesh_sha256"],
                "unmet": _lines(ended.errors, "podm: "), "warnings": _lines(ended.errors, "warning: ")}
        self._show(stage="verifying", mesh=mesh)
        return mesh | {"verify": record["verify"]}

    def _progress(self, line):
        self._show(stage="meshing", **json.loads(line))

    def _verify(self, settings, mesh):
        judging = mesh.pop("verify")
        child = self._start([self.tools.verifier, self._mesh_path, "--quiet", "--json", "-", "--claims",
                             ",".join(judging["claims"]), *judging["options"], "--image", self.image,
                             *settings.of_labels()])
        ended = child.wait()
        report = json.loads(ended.output) if ended.exit_code in (0, 1) else None
        claims = [{"name": name.replace("_", " "), "verdict": claim["verdict"], "reason": claim["reason"]}
                  for name, claim in report["claims"].items()] if report else []
        why_none = "" if claims else ended.broken or _last_line(ended.errors) or "podm-verify was stopped"
        self._show(stage="done", mesh=mesh, claims=claims, undecided=why_none)

    @property
    def _mesh_path(self):
        return self._made / f"{stem_of(self.image)}.vtu"

    @property
    def _record(self):
        return self._made / "record.jsonl"

    def turned(self):
        """Returns the description and the bytes of the mesh for viewer.js."""
        if self.parts is None:
            raise Fault("There is no mesh that this page turns.", 409)
        return self.parts

    def download(self, extension):
        """Returns the name and the path of a file with the mesh in that format."""
        if not (self.image and self._mesh_path.exists()):
            raise Fault("There is no mesh yet.", 409)
        with self.tools.converting:
            return made_in(extension, self._mesh_path, self.tools.declared, self._folder, self._convert)

    def _convert(self, path, folder):
        """Runs podm convert, also while another program makes a mesh."""
        self._converter = Child([self.tools.podm, "convert", self._mesh_path, path], folder, self.tools.limits)
        return self._killed_if_closed(self._converter).wait()

    def _refuse_if_busy(self):
        if self._state["stage"] in ("meshing", "verifying"):
            raise Fault("A mesh is being made; stop it first.", 409)


def _complaint(ended):
    """Returns the sentence with which podm ended."""
    lines = _lines(ended.errors, "podm: ")
    return lines[0] if lines else f"podm ended with code {ended.exit_code} and no message."


def _last_line(text):
    return text.strip().rpartition("\n")[2].removesuffix(".")


def _lines(text, start):
    return [line.removeprefix(start) for line in text.splitlines() if line.startswith(start)]
