"""Behaviour during a run: progress, Ctrl-C, other Python threads, several meshers at once."""

import os
import signal
import subprocess
import sys
import threading
import time
import traceback
import unittest

import numpy as np

from balls import AFFINE, TestCase, balls, hash_of, podm
from slow import slow

LONG = {"labels": "phantom:abdomen@64", "radius": 8}  # takes a few seconds
ENDLESS = {"labels": "phantom:abdomen@64", "radius": 1, "max_memory_gib": 100}  # runs until the test ends it


class Stop(Exception):
    pass


class ProgressTest(TestCase):
    def test_the_callback_gets_phases_on_the_calling_thread_some_times_per_second(self):
        calls, threads = [], set()

        def progress(now):
            calls.append((now.phase, now.fraction, now.cells, now.seconds))
            threads.add(threading.get_ident())

        start = time.monotonic()
        podm.mesh(**LONG, progress=progress)
        seconds = time.monotonic() - start
        self.assertEqual(threads, {threading.get_ident()})
        self.assertIn("refine", {phase for phase, *_ in calls})
        self.assertLessEqual(len(calls), 11 * seconds + 2)
        self.assertTrue(all(0 <= fraction <= 1 for _, fraction, *_ in calls))
        self.assertEqual([now[3] for now in calls], sorted(now[3] for now in calls))

    def test_a_run_of_no_time_is_reported_too(self):
        calls = []
        podm.mesh(balls(), progress=calls.append)
        self.assertGreater(len(calls), 0)
        self.assertIn("podm.Progress(phase=", repr(calls[0]))

    def test_what_the_callback_raises_ends_the_run_and_is_raised(self):
        def progress(now):
            if now.phase == "refine":
                raise Stop("enough")

        start = time.monotonic()
        with self.assertRaisesRegex(Stop, "enough"):
            try:
                podm.mesh(**ENDLESS, progress=progress)
            except Stop as stop:
                self.assertIn("progress", {frame.name for frame in traceback.extract_tb(stop.__traceback__)})
                raise
        self.assertLess(time.monotonic() - start, 60)

    def test_a_callback_that_cannot_be_called_is_a_type_error(self):
        with self.assertRaises(TypeError):
            podm.mesh(balls(), progress="bar")


class InterruptTest(TestCase):
    """A callback sends signals to this process, and so at a known moment."""

    def interrupt_refinement(self, **options):
        def progress(now):
            if now.phase == "refine" and now.cells > 10000:  # a smaller mesh may have no cell in the image yet
                os.kill(os.getpid(), signal.SIGINT)

        return podm.mesh(**ENDLESS, progress=progress, **options)

    def test_ctrl_c_raises_an_interruption_with_the_valid_mesh_so_far(self):
        for threads in (1, 2):
            with self.assertRaises(podm.Interrupted) as interrupted:
                self.interrupt_refinement(threads=threads)
            self.assertIsInstance(interrupted.exception, KeyboardInterrupt)
            mesh = interrupted.exception.mesh
            self.assertFalse(mesh.is_complete)
            self.assertEqual(mesh.stop_reason, "cancelled")
            self.assert_valid(mesh)
            self.assertEqual(mesh.record["stop_reason"], "cancelled")

    def test_ctrl_c_before_there_is_a_mesh_is_a_keyboard_interrupt(self):
        timer = threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT))
        image = np.zeros((400, 400, 400), np.uint8)
        image[100:300, 100:300, 100:300] = 1
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            podm.mesh(image, radius=5)

    def test_what_another_signals_handler_raises_ends_the_run_and_is_raised(self):
        def end(*_):
            raise Stop("alarm")

        before = signal.signal(signal.SIGALRM, end)
        self.addCleanup(signal.signal, signal.SIGALRM, before)
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with self.assertRaisesRegex(Stop, "alarm"):
            podm.mesh(**ENDLESS)

    def test_python_meshes_on_after_an_interruption(self):
        expected = hash_of(podm.mesh(balls()))
        with self.assertRaises(podm.Interrupted):
            self.interrupt_refinement()
        self.assertEqual(hash_of(podm.mesh(balls())), expected)


class ThreadsTest(TestCase):
    def test_other_python_threads_run_meanwhile(self):
        done = threading.Event()
        counts = []

        def count():
            while not done.is_set():
                counts.append(time.monotonic())
                time.sleep(0.005)

        counter = threading.Thread(target=count)
        counter.start()
        start = time.monotonic()
        podm.mesh(**LONG)
        end = time.monotonic()
        done.set()
        counter.join()
        longest = max(np.diff([start] + [at for at in counts if start < at < end] + [end]))
        self.assertLess(longest, max(0.5, (end - start) / 2))

    @slow
    def test_meshers_of_several_python_threads_at_once_make_the_meshes_of_one(self):
        images = [balls(dtype, order) for dtype in ("u1", "i4") for order in "CF"] + ["phantom:torus@40"]
        options = [{"threads": 1, "radius": 1}, {"threads": 1, "optimize": True}, {"threads": 1, "min_dihedral": 8},
                   {"threads": 1, "algorithm": "pdr-podm", "nodes": 1, "cores_per_node": 1},
                   {"radius": 1.5, "executor": "virtual", "threads": 4, "seed": 3, "oversubscribe": True}]
        options[3].pop("threads")
        runs = list(zip(images, options))
        expected = [hash_of(podm.mesh(labels, **keywords)) for labels, keywords in runs]
        found = [[None] * len(runs) for _ in range(3)]

        def make(row, order):
            for i in order:
                labels, keywords = runs[i]
                mesh = podm.mesh(labels, **keywords)
                mesh.save(self.folder / f"{row}_{i}.xdmf")
                found[row][i] = hash_of(mesh)

        threads = [threading.Thread(target=make, args=(row, np.roll(range(len(runs)), row))) for row in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(found, [expected] * 3)

    def test_meshers_of_several_threads_each_do_not_meet(self):
        """Each mesher has its own locks, and each mesh is verified."""
        meshes = []

        def make():
            meshes.append(podm.mesh("phantom:spheres@24", radius=4, threads=2))

        threads = [threading.Thread(target=make) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(meshes), 3)
        for mesh in meshes:
            self.assertTrue(mesh.verify(), mesh.verify().text)

    def test_a_signal_is_the_main_threads(self):
        """Ctrl-C in the main thread does not affect meshers of other threads."""
        meshes = []
        thread = threading.Thread(target=lambda: meshes.append(podm.mesh(**LONG)))
        thread.start()
        with self.assertRaises(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(5)
        thread.join()
        self.assertTrue(meshes[0].is_complete)

    def test_processors_that_the_caller_may_use_stay_the_same(self):
        before = os.sched_getaffinity(0)
        podm.mesh(balls(), affine=AFFINE, threads=1, pin="compact")
        self.assertEqual(os.sched_getaffinity(0), before)


class MemoryTest(TestCase):
    def test_the_image_is_not_copied_but_into_labels_of_two_bytes_a_voxel(self):
        code = """
import numpy as np, podm, sys
image = np.empty((320, 320, 320), np.int64, order=sys.argv[1])
image.fill(0)
image[140:180, 140:180, 140:180] = 1
def peak():
    return int(next(line for line in open("/proc/self/status") if line.startswith("VmHWM")).split()[1]) * 1024
before = peak()
mesh = podm.mesh(image, radius=20, delta=8, threads=1)
print((peak() - before) / image.size)
"""
        for order in "CF":
            process = subprocess.run([sys.executable, "-c", code, order], capture_output=True, text=True, check=True)
            self.assertLess(float(process.stdout), 8, "bytes a voxel: labels, transform and mesh")


if __name__ == "__main__":
    unittest.main()
