"""podm under signals: at any moment there is a complete mesh or none, older files stay, and no file is left behind. The
end comes within a second plus the time of extracting, measuring and writing.

$PODM_SIGNAL_MOMENTS is the number of moments for each algorithm and signal, spread over a run by a seed.
"""

import collections
import fcntl
import json
import os
import pathlib
import random
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

from ending_podm import ENDLESS, LONGEST_S, end_of, start_refining
from podm_process import PROGRAM, PodmTestCase, run_podm, start_podm
from slow import few
from small_images import write_nifti

VERIFIER = os.path.join(os.path.dirname(PROGRAM), "podm-verify")
MOMENTS = int(os.environ.get("PODM_SIGNAL_MOMENTS", "4"))
IMAGE = "phantom:abdomen@80"
MESHES = {"out.vtu", "out_facets.vtu"}
ALGORITHMS = {"podm": ["--threads", 2],
              "pdr": ["--algorithm", "pdr", "--threads", 2],
              "pdr-podm": ["--algorithm", "pdr-podm", "--nodes", 1, "--cores-per-node", 2]}
# All signals that end a program by default and that podm does not report, except those of crashes.
ENDING = (signal.SIGQUIT, signal.SIGUSR1, signal.SIGUSR2, signal.SIGXCPU, signal.SIGALRM, signal.SIGVTALRM,
          signal.SIGPROF, signal.SIGPWR, signal.SIGIO, signal.SIGSTKFLT, signal.SIGRTMIN, signal.SIGRTMAX)


def mesh_command(image, folder, algorithm):
    """Returns a command with all outputs; takes less than a second."""
    leaves = [] if algorithm == "podm" else ["--schedule", folder / "leaves.jsonl"]
    return ["mesh", image, "--radius", 14, "--oversubscribe", *ALGORITHMS[algorithm], *leaves, "-o",
            folder / "out.vtu", "--surface", folder / "s.stl", "--log", folder / "run.log", "--record",
            folder / "runs.jsonl"]


def seconds_of_writing(record):
    return sum(record["phases_s"][phase] for phase in ("extract", "measure", "write"))


def is_whole(path):
    content = path.read_bytes()
    if path.suffix == ".stl":
        return len(content) == 84 + 50 * struct.unpack_from("<I", content, 80)[0]
    if path.suffix == ".log":
        _, start, rest = content.rpartition(b'{"schema"')
        return len(json.loads(start + rest)["mesh_sha256"]) == 64
    if path.suffix == ".jsonl":
        return content.endswith(b"\n") and all(json.loads(line) for line in content.splitlines())
    return path.suffix == ".vtu" and content.endswith(b"</VTKFile>\n")


class AnyMoment(PodmTestCase):
    """Every file of a run replaces an older file, except the record, which is one line."""

    def setUp(self):
        super().setUp()
        self.image = self.folder / "image.nii.gz"
        self.assert_exit(run_podm("phantom", "abdomen", "--size", 96, "-o", self.image), 0)

    def undisturbed(self, algorithm):
        """Returns the names of the files, and the seconds."""
        with tempfile.TemporaryDirectory(dir=self.folder) as folder:
            start = time.monotonic()
            self.assert_exit(run_podm(*mesh_command(self.image, pathlib.Path(folder), algorithm)), 0)
            return set(os.listdir(folder)), time.monotonic() - start

    def assert_kept(self, folder, names, end, signals):
        """Checks the promises of the README for a run that was ended in this way. Returns how it ended."""
        older = {name: f"older {name}".encode() for name in names - {"runs.jsonl"}}
        left = {path.name: path.read_bytes() for path in folder.iterdir()}
        self.assertLessEqual(set(left), names, end.stderr)
        self.assertLessEqual(set(older), set(left), end.stderr)
        new = {name for name, content in left.items() if content != older.get(name)}
        for name in new:
            self.assertTrue(is_whole(folder / name), name)
        has_mesh = "out.vtu" in new
        self.assertEqual(has_mesh, "out_facets.vtu" in new)
        if has_mesh:
            self.assert_exit(run_podm(folder / "out.vtu", "--claims", "structure,delaunay", program=VERIFIER), 0)
        writing_s = 0
        if end.code < 0:
            self.assertIn(-end.code, signals, end.stderr)
            if len(signals) == 1:
                self.assertEqual(new, set(), end.stderr)
        else:
            record = self.read_record(folder / "runs.jsonl")
            writing_s = seconds_of_writing(record)
            self.assertEqual((end.code, record["stop_reason"]),
                             (0, "complete") if end.code == 0 else (1, "cancelled"), end.stderr)
            self.assertEqual(has_mesh, "the mesh has no cell" not in end.stderr)
        limit = LONGEST_S + (writing_s if len(signals) == 1 else 0)
        self.assertLessEqual(end.seconds, limit, end.stderr)
        return {0: "whole mesh", 1: "mesh so far" if has_mesh else "no cell yet"}.get(end.code, "ended"), writing_s

    def disturb(self, algorithm, signals, moments, seed):
        """Divides the run time into equal parts, and makes a run that gets the signals at a random moment of each part.
        """
        names, whole_s = self.undisturbed(algorithm)
        rng = random.Random(f"{seed} {algorithm} {signals}")
        ends, worst_s, longest_writing_s = collections.Counter(), 0, 0
        for part in range(moments):
            moment_s = (part + rng.random()) / moments * whole_s
            with self.subTest(algorithm=algorithm, signals=signals, moment_s=moment_s), \
                    tempfile.TemporaryDirectory(dir=self.folder) as folder:
                folder = pathlib.Path(folder)
                for name in names - {"runs.jsonl"}:
                    (folder / name).write_text(f"older {name}")
                process = start_podm(*mesh_command(self.image, folder, algorithm))
                time.sleep(moment_s)
                end = end_of(process, *signals, pause_s=rng.uniform(0, 0.05))
                how, writing_s = self.assert_kept(folder, names, end, signals)
                ends[how] += 1
                worst_s = max(worst_s, end.seconds - writing_s)
                longest_writing_s = max(longest_writing_s, writing_s)
        names_of_signals = " then ".join(signal.Signals(number).name for number in signals)
        print(f"{algorithm}, {names_of_signals}: {moments} moments of {whole_s:.2f} s, {dict(ends)}; at worst "
              f"{worst_s:.3f} s to the end, but for extracting, measuring and writing, at most "
              f"{longest_writing_s:.3f} s",
              file=sys.stderr)

    def test_one_signal(self):
        for algorithm in ALGORITHMS:
            for number in few((signal.SIGINT, signal.SIGTERM), 1):
                self.disturb(algorithm, [number], MOMENTS, seed=1)

    def test_a_second_signal_ends_at_once(self):
        for algorithm in ALGORITHMS:
            self.disturb(algorithm, [signal.SIGINT, signal.SIGTERM], MOMENTS // 2, seed=2)


class Refinement(PodmTestCase):
    def mesh_command(self, *more):
        return [*ENDLESS, "-o", self.folder / "out.vtu", "--log", self.folder / "run.log", *more]

    def start(self, *more, **popen_options):
        """Returns a run that has made cells already: its log has reached 1 MiB."""
        process = start_refining(*self.mesh_command(*more), **popen_options)
        while not any(path.stat().st_size > 2 ** 20 for path in self.folder.glob("run.log.tmp*")):
            self.assertIsNone(process.poll())
            time.sleep(0.01)
        return process

    def assert_stopped(self, end, meshes=MESHES):
        self.assertEqual(end.code, 1, end.stderr)
        self.assertIn("ended early: cancelled", end.stderr)
        self.assertEqual({path.name for path in self.files()}, meshes | {"run.log"}, end.stderr)

    def assert_ended_by(self, number, end):
        self.assertEqual(end.code, -number, end.stderr)
        self.assertLessEqual(end.seconds, LONGEST_S)
        self.assertEqual(self.files(), {})

    def test_a_hangup_is_reported_and_obeyed(self):
        end = end_of(self.start(), signal.SIGHUP)
        self.assertIn("podm: SIGHUP: ", end.stderr)
        self.assert_stopped(end)

    def test_a_signal_that_was_ignored_stays_ignored(self):
        def nohup():
            signal.signal(signal.SIGHUP, signal.SIG_IGN)
        process = self.start(preexec_fn=nohup)
        process.send_signal(signal.SIGHUP)
        time.sleep(0.3)
        self.assertIsNone(process.poll())
        end = end_of(process, signal.SIGTERM)
        self.assertNotIn("SIGHUP", end.stderr)
        self.assert_stopped(end)

    def test_signals_of_batch_systems_timers_and_a_quit_end_at_once_without_leftovers(self):
        def no_core():
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            signal.signal(signal.SIGQUIT, signal.SIG_DFL)
        for number in ENDING:
            with self.subTest(signal=number):
                end = end_of(start_refining(*self.mesh_command(), preexec_fn=no_core), number)
                self.assert_ended_by(number, end)

    def test_signals_that_end_nothing_end_nothing(self):
        process = self.start()
        for number in signal.SIGCHLD, signal.SIGWINCH, signal.SIGURG, signal.SIGTSTP, signal.SIGCONT, signal.SIGPIPE:
            process.send_signal(number)
        time.sleep(0.3)
        self.assertIsNone(process.poll())
        self.assert_stopped(end_of(process, signal.SIGTERM))

    def test_a_node_that_never_has_a_leaf_keeps_no_worker_waiting(self):
        """One leaf holds the whole object, so all nodes except one wait until that node has finished."""
        with tempfile.TemporaryDirectory() as elsewhere:
            runs = pathlib.Path(elsewhere) / "runs.jsonl"
            process = self.start("--algorithm", "pdr", "--threads", 16, "--leaf-size", 1000, "--initial-ratio", 64,
                                 "--record", runs)
            time.sleep(0.7)
            end = end_of(process, signal.SIGINT)
            self.assert_stopped(end)
            self.assertLessEqual(end.seconds, LONGEST_S + seconds_of_writing(self.read_record(runs)))

    def test_leaves_in_the_making_keep_no_worker_waiting(self):
        """The number of leaves is the largest allowed: making the octree and the queue takes seconds."""
        for moment_s in few((0.8, 0.3, 1.3, 1.8), 1):
            with self.subTest(moment_s=moment_s), tempfile.TemporaryDirectory() as elsewhere:
                image = write_nifti(pathlib.Path(elsewhere) / "full.nii", bytes([1]) * 24 ** 3, (24, 24, 24))
                runs = pathlib.Path(elsewhere) / "runs.jsonl"
                process = start_refining("mesh", image, "--radius", 0.35, "--delta", 0.3, "--algorithm", "pdr",
                                         "--threads", 16, "--initial-ratio", 4, "--leaf-size", 0.24, "--oversubscribe",
                                         "--max-memory-gib", 4, "-o", self.folder / "out.vtu", "--log",
                                         self.folder / "run.log", "--record", runs)
                time.sleep(moment_s)
                end = end_of(process, signal.SIGINT)
                self.assert_stopped(end, set() if "the mesh has no cell" in end.stderr else MESHES)
                self.assertLessEqual(end.seconds, LONGEST_S + seconds_of_writing(self.read_record(runs)))

    def test_a_full_pipe_keeps_no_worker_waiting(self):
        read_end, write_end = os.pipe()
        try:
            size = fcntl.fcntl(write_end, fcntl.F_SETPIPE_SZ, 4096)
            os.write(write_end, bytes(size))
            process = subprocess.Popen([PROGRAM, *map(str, self.mesh_command())], stderr=write_end)
            while not any(path.name.startswith("run.log.tmp") for path in self.folder.iterdir()):
                time.sleep(0.01)
            time.sleep(0.3)
            self.assert_ended_by(signal.SIGTERM, end_of(process, signal.SIGTERM, signal.SIGTERM, pause_s=0.1))
        finally:
            os.close(read_end)
            os.close(write_end)


class DihedralPhases(PodmTestCase):
    """The refined mesh is written, with the improvements that the phase has made until then."""

    def ended_in(self, phase, *options):
        runs = self.folder / "runs.jsonl"
        process = start_podm("mesh", "phantom:abdomen@96", "--radius", 6, "--threads", 2, "--oversubscribe", *options,
                             "-o", self.folder / "out.vtu", "--record", runs)
        for line in process.stderr:
            if line.startswith(phase):
                break
        end = end_of(process, signal.SIGINT)
        self.assertEqual(end.code, 1, end.stderr)
        record = self.read_record(runs)
        self.assertEqual(record["stop_reason"], "cancelled")
        self.assertLessEqual(end.seconds, LONGEST_S + seconds_of_writing(record))
        self.assertEqual(set(record["guarantees"].values()), {0})
        return record

    def assert_proved(self, *claims):
        self.assert_exit(run_podm(self.folder / "out.vtu", "--claims", ",".join(claims), program=VERIFIER), 0)

    def test_vertices_moved_so_far_stay_where_they_are(self):
        record = self.ended_in("perturb", "--min-dihedral", 30)
        self.assertGreater(record["perturbed"]["unmoved"]["not_reached"], 0)
        self.assert_proved("structure", "delaunay", "radius_edge", "boundary_angles", "conformity")

    def test_cells_made_better_so_far_stay(self):
        record = self.ended_in("optimize", "--optimize", "--dihedral-bounds", "15,150")
        done = record["optimization"]
        self.assertGreater(done["beyond_bounds"], 0)
        self.assertLessEqual(done["beyond_bounds"], done["beyond_bounds_before"])
        self.assert_proved("structure", "radius_edge", "boundary_angles", "conformity")


class End(PodmTestCase):
    def test_a_user_whose_queue_of_signals_is_full_waits_for_nothing(self):
        def no_queue():
            resource.setrlimit(resource.RLIMIT_SIGPENDING, (0, 0))
        process = run_podm("mesh", "phantom:spheres@16", "--radius", 5, "-o", self.folder / "out.vtu",
                           preexec_fn=no_queue)
        self.assert_exit(process, 0)


class OtherCommands(PodmTestCase):
    def test_a_phantom_is_written_whole_or_not_at_all(self):
        image = self.folder / "p.nii.gz"
        command = ["phantom", "abdomen", "--size", 128, "-o", image]
        start = time.monotonic()
        self.assert_exit(run_podm(*command), 0)
        whole_s = time.monotonic() - start
        whole = image.read_bytes()
        rng = random.Random(3)
        for part in range(8):
            image.write_text("older")
            process = start_podm(*command)
            time.sleep((part + rng.random()) / 8 * whole_s)
            end = end_of(process, signal.SIGINT)
            self.assertLessEqual(end.seconds, LONGEST_S)
            self.assertIn(end.code, (0, -signal.SIGINT))
            # A signal may come when the file exists already, and the process only has to report this.
            self.assertIn(self.files(), [{image: whole}] + [{image: b"older"}] * (end.code != 0))

    def test_a_replay_ends_at_once(self):
        log = self.folder / "run.log"
        self.assert_exit(run_podm("mesh", IMAGE, "--radius", 8, "-o", self.folder / "out.vtu", "--log", log), 0)
        before = self.files()
        process = start_podm("replay", IMAGE, log)
        time.sleep(0.2)
        end = end_of(process, signal.SIGTERM)
        self.assertEqual(end.code, -signal.SIGTERM, end.stderr)
        self.assertLessEqual(end.seconds, LONGEST_S)
        self.assertEqual(self.files(), before)


if __name__ == "__main__":
    unittest.main()
