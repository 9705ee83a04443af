"""The draws of `make stress`, and its criteria of failure. The test podm.stress_runs makes the runs themselves."""

import collections
import json
import pathlib
import tempfile
import types
import unittest
import unittest.mock

import numpy

import random_images
import random_runs
import random_shapes
import stress
from podm_process import PROGRAM, PodmTestCase, run_podm

SEEDS = range(1, 401)
SHAPES = [["--lines"], ["--box", "flat"], ["--lines", "--box", "flat"], ["--thin", "keep"]]


class Draws(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.draw = staticmethod(stress.Draws())
        cls.runs = [cls.draw((seed, [])) for seed in SEEDS]
        cls.shapes = [cls.draw((seed, SHAPES[seed % len(SHAPES)])) for seed in SEEDS]

    def test_a_run_follows_from_its_seed(self):
        for run, shape_options in [*((run, []) for run in self.runs[:20]),
                                   *((run, SHAPES[run.seed % len(SHAPES)]) for run in self.shapes[:20])]:
            again = self.draw((run.seed, shape_options))
            self.assertEqual((run.selection, run.options), (again.selection, again.options))
            numpy.testing.assert_array_equal(run.image.voxels, again.image.voxels)
            numpy.testing.assert_array_equal(run.image.affine, again.image.affine)

    def test_shapes_of_all_kinds_are_drawn_with_their_options(self):
        counts = collections.Counter(name for run in self.shapes for names in stress.kinds_of(run).values()
                                     for name in names)
        for kind in [*(family.__name__ for family in random_shapes.FAMILIES), "podm", "podm-home", "pdr", "pdr-podm",
                     "virtual", "threads", "--smooth", "--min-dihedral", "--lines-delta", "--max-elements"]:
            self.assertGreater(counts[kind], 0, kind)
        grains = [len(run.image.labels()) for run in self.shapes if run.image.family == "polycrystal"]
        self.assertLess(min(grains), 6)
        self.assertGreater(max(grains), 150)
        for run in self.shapes:
            self.assertEqual(run.options[-len(SHAPES[run.seed % len(SHAPES)]):], SHAPES[run.seed % len(SHAPES)])
            self.assertTrue(run.image.voxels.any())

    def test_every_kind_is_drawn(self):
        counts = collections.Counter(name for run in self.runs for names in stress.kinds_of(run).values()
                                     for name in names)
        for kinds in ([family.__name__ for family in random_images.FAMILIES],
                      [damage.__name__ for damage in random_images.DAMAGES],
                      [kind.__name__ for kind in random_images.TYPES.values()],
                      ["podm", "pdr", "pdr-podm", "auto", "virtual", "threads"],
                      ["--max-elements", "--max-seconds", "--target-elements", "--radius-of", "--merge", "--topology"]):
            for kind in kinds:
                self.assertGreater(counts[kind], 0, kind)
        self.assertGreater(counts["threads"], len(self.runs) / 10)

    def test_the_runs_of_make_test_are_of_every_kind(self):
        """A change of the draws would change these runs."""
        def kinds(runs):
            return {(kind, name) for run in runs for kind, names in stress.kinds_of(run).items() for name in names}
        kept = stress.seeds_in(pathlib.Path(__file__).with_name("stress_seeds.txt"))
        kept = [self.draw(seed) for seed in kept]
        self.assertLessEqual(kinds(self.runs), kinds(kept))

    def test_images_are_label_images_of_spacings_up_to_10_to_1(self):
        for run in self.runs:
            image = run.image
            self.assertTrue(image.voxels.any())
            self.assertLessEqual(image.spacing.max() / image.spacing.min(), 10.0001)
            stored = image.voxels.astype(random_images.TYPES[image.datatype])
            numpy.testing.assert_array_equal(stored.astype(float), image.voxels.astype(float))

    def test_seeds_that_failed_are_read_with_their_comments(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "seeds.txt"
            path.write_text("# a comment\n\n12\n7 --box flat  # pdr on threads\n")
            self.assertEqual(stress.seeds_in(path), [(12, []), (7, ["--box", "flat"])])


class Images(PodmTestCase):
    def test_the_program_reads_what_was_drawn(self):
        phantoms = types.SimpleNamespace(draw=lambda rng: numpy.ones((3, 3, 3), int))
        for seed in range(30):
            image = random_images.draw(numpy.random.default_rng(seed), phantoms)
            path = self.folder / "image.nii"
            image.write(str(path))
            process = run_podm("info", path)
            self.assert_exit(process, 0)
            for label in image.labels():
                self.assertIn(str(label), process.stdout)


def record(**changes):
    sound = {"stop_reason": "complete", "cells": 10, "guarantees": {"radius": 0},
             "verdicts": dict.fromkeys(["size", *stress.ALWAYS], "pass"), "optimization": None, "lines": None}
    return sound | changes


class Judge(unittest.TestCase):
    def judge(self, exit_code, limits=(), **changes):
        stress.judge(types.SimpleNamespace(limits=set(limits), options=[]), record(**changes),
                     types.SimpleNamespace(returncode=exit_code, stderr=""))

    def assert_fault(self, exit_code, limits=(), **changes):
        with self.assertRaises(stress.Failed):
            self.judge(exit_code, limits, **changes)

    def test_whole_runs(self):
        self.judge(0)
        self.assert_fault(1)
        self.assert_fault(1, guarantees={"radius": 1})
        self.assert_fault(0, verdicts=record()["verdicts"] | {"size": "fail"})
        self.assert_fault(0, verdicts={})

    def test_runs_that_meet_a_limit(self):
        self.judge(1, ["time limit"], stop_reason="time limit", guarantees={"radius": 3},
                   verdicts=record()["verdicts"] | {"size": "fail"})
        self.assert_fault(0, ["time limit"], stop_reason="time limit")
        self.assert_fault(1, ["time limit"], stop_reason="memory limit")
        self.assert_fault(1, ["time limit"], stop_reason="time limit",
                          verdicts=record()["verdicts"] | {"delaunay": "fail"})

    def test_large_labels_may_lack_a_cell_if_a_run_ends_early(self):
        failing = {"stop_reason": "element limit", "verdicts": record()["verdicts"] | {"labels": "fail"}}
        self.judge(1, ["element limit"], guarantees={"missing_labels": 1}, **failing)
        self.assert_fault(1, ["element limit"], guarantees={"missing_labels": 0}, **failing)

    def test_promised_lines_are_there_even_if_a_run_ends_early(self):
        self.assert_fault(1, ["time limit"], stop_reason="time limit",
                          verdicts=record()["verdicts"] | {"lines": "fail"})

    def test_topologies_that_differ_must_be_listed(self):
        differing = {"guarantees": {"topology": 1}, "verdicts": record()["verdicts"] | {"topology": "fail"}}
        self.judge(1, thin_layers={"differences": [{}]}, **differing)
        self.assert_fault(1, thin_layers={"differences": [{}, {}]}, **differing)
        self.assert_fault(0, thin_layers={"differences": [{}]}, **differing)
        self.assert_fault(1, thin_layers={"differences": []}, **differing)

    def test_meshes_without_a_cell(self):
        self.judge(1, cells=0, verdicts={})
        self.judge(1, cells=0, verdicts={}, guarantees={"missing_labels": 1})
        self.assert_fault(0, cells=0, verdicts={})
        self.assert_fault(1, cells=0, verdicts={}, guarantees={"radius": 1})
        self.assert_fault(1, guarantees={"missing_labels": 1})


class Faults(PodmTestCase):
    """Detects programs that break the promises of podm: a script replaces the program."""

    def setUp(self):
        super().setUp()
        voxels = numpy.zeros((16, 16, 16), int)
        voxels[2:14, 2:14, 2:14] = 1
        image = random_images.RandomImage("cube", [], voxels, 2, numpy.eye(4), numpy.ones(3))
        self.run_drawn = random_runs.Run(7, image, "image.nii", "out.vtu", "podm", "virtual", [],
                                         ["--radius", "3", "--threads", "2", "--oversubscribe"], set(), True)

    def fault_of(self, script):
        program = self.folder / "podm"
        program.write_text(f"#!/bin/sh\n{script}\n")
        program.chmod(0o755)
        with unittest.mock.patch.object(stress, "PROGRAM", str(program)), \
                tempfile.TemporaryDirectory(dir=self.folder) as folder:
            return stress.fault_of(self.run_drawn, folder)

    def test_a_sound_run_has_none(self):
        self.assertEqual(self.fault_of(f'exec {PROGRAM} "$@"'), (None, "complete"))

    def test_a_run_without_a_record_is_one(self):
        fault, ended = self.fault_of("exit 1")
        self.assertIn("run.jsonl", fault)
        self.assertEqual(ended, "failed")

    def fault_of_no_cell(self, delta_mm):
        empty = json.dumps({"stop_reason": "complete", "cells": 0, "guarantees": {}, "verdicts": {},
                            "optimization": None, "lines": None, "used": {"delta_mm": delta_mm}})
        return self.fault_of(
            f"""case "$*" in
            *run.jsonl*) while [ "$1" != --record ]; do shift; done; echo '{empty}' > "$2"; exit 1;;
            esac""")

    def test_no_cell_in_an_object_too_thick_for_that_is_one(self):
        """The cube holds a ball of 6 mm; the check subtracts two diagonals of a voxel."""
        self.assertIn("holds a ball of 4.27 mm", self.fault_of_no_cell(2.5)[0])
        self.assertEqual(self.fault_of_no_cell(2.6), (None, "no cell"))


class Balls(unittest.TestCase):
    def test_voxels_about_a_ball_inside_are_foreground(self):
        rng = numpy.random.default_rng(4)
        for _ in range(20):
            size, spacing = rng.integers(1, 9, 3), rng.uniform(0.5, 2, 3)
            foreground = rng.random(size) < 0.97
            image = random_images.RandomImage("random", [], foreground.astype(int), 2, numpy.eye(4), spacing)
            reach_mm = image.ball_inside_mm(foreground) + numpy.linalg.norm(spacing) - 1e-9
            voxels = numpy.argwhere(numpy.ones(size, bool))

            def is_center(center):
                near = numpy.linalg.norm((voxels - center) * spacing, axis=1) < reach_mm
                to_border = numpy.minimum(center + 1, size - center) * spacing
                return to_border.min() > reach_mm and foreground[tuple(voxels[near].T)].all()

            self.assertTrue(any(is_center(center) for center in voxels[foreground.ravel()]))


if __name__ == "__main__":
    unittest.main()
