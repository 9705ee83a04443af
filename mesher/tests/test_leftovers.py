"""A run of podm that ends early leaves no file that the next run does not remove, and no process. An output that waits
does not delay the end."""

import contextlib
import fcntl
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import time
import unittest

from ending_podm import ENDLESS, LONGEST_S, end_of, start_refining
from podm_process import PROGRAM, PodmTestCase, run_podm, start_podm

VERIFIER = os.path.join(os.path.dirname(PROGRAM), "podm-verify")


class Killed(PodmTestCase):
    """kill -9 leaves temporary files. The next run with the same name removes them, except those of a living process.
    """

    def mesh(self):
        return run_podm("mesh", "phantom:spheres@24", "-o", self.folder / "out.vtu", "--log", self.folder / "run.log")

    def names(self):
        return {path.name for path in self.folder.iterdir()}

    def test_the_next_run_removes_what_is_left(self):
        process = start_refining(*ENDLESS, "-o", self.folder / "out.vtu", "--log", self.folder / "run.log")
        end_of(process, signal.SIGKILL)
        self.assertRegex(" ".join(self.names()), rf"^run.log.tmp{process.pid}-\d+$")
        others = {"other.vtu.tmp4194305-0", "run.log.tmp", f"run.log.tmp{process.pid}"}
        for name in others:
            (self.folder / name).touch()
        self.assert_exit(self.mesh(), 0)
        self.assertEqual(self.names() - others, {"out.vtu", "out_facets.vtu", "run.log"})
        self.assertLessEqual(others, self.names())

    def test_what_is_left_goes_although_its_process_has_a_successor(self):
        self.assert_exit(self.mesh(), 0)
        expected = self.names()
        for number in 1, os.getpid():
            (self.folder / f"out.vtu.tmp{number}-0").touch()
        self.assert_exit(self.mesh(), 0)
        self.assertEqual(self.names(), expected)

    def test_a_run_that_lives_keeps_its_own(self):
        process = start_refining(*ENDLESS, "-o", self.folder / "out.vtu", "--log", self.folder / "run.log")
        try:
            before = self.names()
            self.assertRegex(" ".join(before), rf"^run.log.tmp{process.pid}-\d+$")
            self.assert_exit(self.mesh(), 0)
            self.assertEqual(self.names(), before | {"out.vtu", "out_facets.vtu", "run.log"})
        finally:
            self.assertEqual(end_of(process, signal.SIGINT).code, 1)


def child_that_runs(process, program):
    """Returns the number of a process; None if there is none."""
    for entry in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            if parent == process.pid and os.path.basename(os.readlink(entry / "exe")) == program:
                return entry.name
        except OSError:  # it has ended
            pass
    return None


def ends_within(process, seconds):
    """Returns true if the process with this number ends soon, or is at least a zombie."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            if pathlib.Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] == "Z":
                return True
        except OSError:
            return True
        time.sleep(0.005)
    return False


class Verification(PodmTestCase):
    MESH = {"out.vtu", "out_facets.vtu"}

    def start_verifying(self, image="phantom:abdomen@48"):
        """Returns a run, and the number of its podm-verify."""
        process = start_podm("mesh", image, "--radius", 8, "-o", self.folder / "out.vtu", "--verify")
        child = None
        while child is None:
            time.sleep(0.005)
            self.assertIsNone(process.poll())
            child = child_that_runs(process, "podm-verify")
        return process, child

    def names(self):
        return {path.name for path in self.folder.iterdir()}

    def test_a_signal_ends_the_verifier_too(self):
        process, child = self.start_verifying()
        blocked = re.search(r"SigBlk:\s*(\w+)", pathlib.Path(f"/proc/{child}/status").read_text())[1]
        self.assertEqual(int(blocked, 16), 0)
        end = end_of(process, signal.SIGTERM)
        self.assertEqual(end.code, 1, end.stderr)
        self.assertLessEqual(end.seconds, LONGEST_S)
        self.assertIn("podm-verify: ended early", end.stderr)
        self.assertFalse(os.path.exists(f"/proc/{child}"))
        self.assertEqual(self.names(), self.MESH)
        self.assert_exit(run_podm(self.folder / "out.vtu", "--claims", "structure,delaunay", program=VERIFIER), 0)

    def test_signals_that_end_at_once_end_the_verifier_too(self):
        """The image is in a file. With a phantom, whose image file is removed, the verifier would end by itself."""
        image = self.folder / "image.nii.gz"
        self.assert_exit(run_podm("phantom", "abdomen", "--size", 48, "-o", image), 0)
        for number in signal.SIGUSR1, signal.SIGRTMIN:
            with self.subTest(signal=number):
                process, child = self.start_verifying(image)
                end = end_of(process, number)
                self.assertEqual(end.code, -number, end.stderr)
                self.assertLessEqual(end.seconds, LONGEST_S)
                self.assertTrue(ends_within(child, LONGEST_S))
                self.assertEqual(self.names(), self.MESH | {"image.nii.gz"})

    def test_what_a_killed_run_left_goes_with_the_next(self):
        process, child = self.start_verifying()
        process.kill()
        process.communicate()
        with contextlib.suppress(ProcessLookupError):
            os.kill(int(child), signal.SIGKILL)
        left = self.names() - self.MESH
        self.assertRegex(" ".join(left), rf"^out.vtu.tmp{process.pid}-\d+$")
        self.assertEqual(os.listdir(self.folder / left.pop()), ["image.nii.gz"])
        self.assert_exit(run_podm("mesh", "phantom:spheres@24", "-o", self.folder / "out.vtu"), 0)
        self.assertEqual(self.names(), self.MESH)

    def test_no_other_folder_is_needed(self):
        runs = self.folder / "runs.jsonl"
        process = run_podm("mesh", "phantom:spheres@24", "-o", self.folder / "out.vtu", "--verify", "--record", runs,
                           env={**os.environ, "TMPDIR": "/nonexistent"})
        self.assert_exit(process, 0)
        self.assertEqual(set(self.read_record(runs)["verdicts"].values()), {"pass"})
        self.assertEqual(self.names(), self.MESH | {"runs.jsonl"})

    def test_a_missing_verifier_is_reported_before_there_is_a_mesh(self):
        alone = self.folder / "podm"
        shutil.copy(PROGRAM, alone)
        process = run_podm("mesh", "phantom:spheres@24", "-o", self.folder / "out.vtu", "--verify", program=alone)
        self.assert_exit(process, 2)
        self.assertIn("podm-verify cannot be run", process.stderr)
        self.assertEqual(self.names(), {"podm"})

    def test_a_signal_before_it_leaves_it_out(self):
        runs = self.folder / "runs.jsonl"
        process = start_podm("mesh", "phantom:abdomen@80", "--radius", 8, "-o", self.folder / "out.vtu", "--verify",
                             "--record", runs)
        for line in process.stderr:
            if line.startswith("extract"):
                break
        end = end_of(process, signal.SIGTERM)
        self.assertEqual(end.code, 1, end.stderr)
        self.assertIn("podm-verify: ended early by a signal", end.stderr)
        record = self.read_record(runs)
        self.assertEqual((record["stop_reason"], record.get("verdicts", {})), ("complete", {}))


class Record(PodmTestCase):
    """A record that waits does not delay signals."""

    def setUp(self):
        super().setUp()
        self.runs = self.folder / "runs.jsonl"

    def start(self):
        """Returns a run whose mesh is written, and which may wait to write the record."""
        process = start_podm("mesh", "phantom:spheres@16", "-o", self.folder / "out.vtu", "--record", self.runs)
        while not (self.folder / "out_facets.vtu").exists():
            time.sleep(0.01)
        time.sleep(0.3)
        self.assertIsNone(process.poll())
        return process

    def assert_two_signals_end(self, process):
        end = end_of(process, signal.SIGTERM, signal.SIGTERM, pause_s=0.1)
        self.assertEqual(end.code, -signal.SIGTERM, end.stderr)
        self.assertLessEqual(end.seconds, LONGEST_S)
        self.assertEqual({path.name for path in self.folder.iterdir()}, {"out.vtu", "out_facets.vtu", "runs.jsonl"})

    def test_a_lock(self):
        self.runs.write_text("{}\n")
        with open(self.runs) as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            self.assert_two_signals_end(self.start())
            self.assertEqual(self.runs.read_text(), "{}\n")

    def test_the_first_signal_still_writes_it_when_the_lock_is_gone(self):
        self.runs.touch()
        with open(self.runs) as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            process = self.start()
            process.send_signal(signal.SIGTERM)
            time.sleep(0.1)
        _, stderr = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, stderr)
        self.assertEqual(self.read_record(self.runs)["stop_reason"], "complete")

    def test_a_full_pipe(self):
        os.mkfifo(self.runs)
        reader = os.open(self.runs, os.O_RDONLY | os.O_NONBLOCK)
        writer = os.open(self.runs, os.O_WRONLY)
        try:
            os.write(writer, bytes(fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, 4096)))
            self.assert_two_signals_end(self.start())
        finally:
            os.close(reader)
            os.close(writer)

    def mesh(self, record):
        process = start_podm("mesh", "phantom:spheres@16", "--quiet", "-o", self.folder / "out.vtu", "--record", record)
        try:
            stdout, stderr = process.communicate(timeout=20)
        finally:
            process.kill()  # no effect if it has ended
        return subprocess.CompletedProcess(process.args, process.returncode, stdout, stderr)

    def test_a_pipe_without_a_reader_is_refused_before_there_is_a_mesh(self):
        os.mkfifo(self.runs)
        process = self.mesh(self.runs)
        self.assert_exit(process, 2)
        self.assertIn(f"cannot write {self.runs}: the pipe has no reader", process.stderr)
        self.assertEqual(list(self.folder.iterdir()), [self.runs])

    def test_a_pipe_with_a_reader_standard_output_and_the_null_device(self):
        os.mkfifo(self.runs)
        with open(os.open(self.runs, os.O_RDONLY | os.O_NONBLOCK)) as reader:
            self.assert_exit(self.mesh(self.runs), 0)
            self.assertEqual(json.loads(reader.read())["stop_reason"], "complete")
        process = self.mesh("/dev/stdout")
        self.assert_exit(process, 0)
        self.assertEqual(json.loads(process.stdout)["stop_reason"], "complete")
        self.assert_exit(self.mesh("/dev/null"), 0)


if __name__ == "__main__":
    unittest.main()
