"""podm mesh --lines: lines where three labels meet are edges of the mesh, and podm-verify agrees."""

import collections
import itertools
import os
import signal
import time
import unittest

import numpy as np

from podm_process import PROGRAM, PodmTestCase, read_medit, run_podm, start_podm
from slow import few
from small_images import write_nifti

VERIFIER = os.path.join(os.path.dirname(PROGRAM), "podm-verify")


def polycrystal(seed, size, number):
    """Grains around random seeds; voxels[z, y, x]."""
    seeds = np.random.default_rng(seed).uniform(0, size, (number, 3))
    places = np.indices((size, size, size)).reshape(3, -1).T
    return np.argmin(((places[:, None, :] - seeds[None]) ** 2).sum(axis=2), axis=1).reshape(size, size, size) + 1


def grains():
    """Grains around eight seeds, in a margin of background."""
    nearest = polycrystal(5, 20, 8)
    nearest[:2] = nearest[-2:] = nearest[:, :2] = nearest[:, -2:] = nearest[:, :, :2] = nearest[:, :, -2:] = 0
    return nearest


def noise(seed, size=6, labels=3):
    return np.random.default_rng(seed).integers(0, labels + 1, (size, size, size))


def named_edges(path):
    """Returns the lines of a Medit file: pairs of an edge, as a sorted pair of vertices, and a set of names."""
    text = path.read_text()
    lines = [line.split(" ", 3)[2:] for line in text.splitlines() if line.startswith("# line ")]
    names = {int(number): frozenset(labels.split("|")) for number, labels in lines}
    words = text[text.index("Edges\n"):].split() if "Edges\n" in text else ["Edges", "0"]
    numbers = np.array(words[2:2 + 3 * int(words[1])], int).reshape(-1, 3)
    return [(tuple(sorted((a, b))), names[line]) for a, b, line in numbers.tolist()]


def names_around_edges(mesh):
    """Returns the names of the labels of the cells around each edge, and of the outside beside its facets."""
    around, sides = collections.defaultdict(set), collections.defaultdict(list)
    for *cell, label in mesh.cells:
        for edge in itertools.combinations(sorted(cell), 2):
            around[edge].add(f"label {label}")
        for facet in itertools.combinations(sorted(cell), 3):
            sides[facet].append(label)
    for facet, labels in sides.items():
        for edge in itertools.combinations(facet, 2):
            around[edge] |= {"outside"} if len(labels) == 1 else set()
    return around


class Lines(PodmTestCase):
    def setUp(self):
        super().setUp()
        self.image = self.folder / "image.nii"
        self.use(grains())
        self.runs = self.folder / "runs.jsonl"
        self.out = self.folder / "out.vtu"

    def use(self, voxels):
        write_nifti(self.image, voxels.astype(np.uint8).tobytes(), voxels.shape[::-1])

    def mesh(self, *arguments):
        return run_podm("mesh", self.image, "-o", self.out, "--record", self.runs, "--radius", 2.5, "--delta", 1,
                        *arguments)

    def record_of(self, *arguments):
        self.runs.unlink(missing_ok=True)
        self.assert_exit(self.mesh(*arguments), 0)
        return self.read_record(self.runs)

    def assert_has_lines(self, record):
        lines = record["lines"]
        self.assertGreaterEqual(lines["kept_mm"] + lines["excluded_mm"], 0.999 * lines["traced_mm"])
        self.assertGreater(lines["near_lines"]["min_facet_angle_deg"], 20.7)
        self.assertGreater(lines["near_lines"]["min_facet_angle_away_deg"], 30)
        self.assertLess(record["quality"]["max_radius_edge"], 1.93)
        self.assertEqual(set(record["guarantees"].values()), {0})

    def test_every_algorithm_keeps_lines_and_equals_its_replay(self):
        for algorithm in few((["podm", "--threads", 2], ["pdr", "--threads", 2], ["podm", "--executor", "virtual"],
                              ["podm-home", "--nodes", 2], ["pdr-podm", "--nodes", 2, "--cores-per-node", 1]), 2):
            log = self.folder / "run.log"
            record = self.record_of("--lines", "--algorithm", *algorithm, "--oversubscribe", "--log", log)
            self.assert_has_lines(record)
            self.assert_exit(run_podm("replay", self.image, log), 0)

    def test_podm_verify_finds_the_lines(self):
        record = self.record_of("--lines", "--verify")
        self.assertEqual(record["verdicts"]["lines"], "pass")
        self.assertEqual(set(record["verdicts"].values()), {"pass"})
        self.assertEqual(record["verify"]["claims"].count("lines"), 1)

    def test_lines_that_are_claimed_are_found(self):
        images = [(polycrystal(seed, 10, number), smooth) for seed in range(2) for number in (5, 9)
                  for smooth in ([], ["--smooth", 0.7])] + [(noise(1), [])]
        claims = set()
        for voxels, smooth in images:
            self.use(voxels)
            record = self.record_of("--lines", "--verify", *smooth)
            lines = record["lines"]
            claims.add(lines["is_claimed"])
            self.assertEqual(lines["is_claimed"], record["verdicts"].get("lines") == "pass")
            if lines["is_claimed"]:
                self.assertGreaterEqual(lines["kept_mm"], 0.999 * lines["traced_mm"])
        self.assertEqual(claims, {False, True})

    def test_each_edge_is_there_once_under_the_names_of_the_labels_around_it(self):
        for voxels in (grains(), noise(1), noise(2), noise(3, 8, 5)):
            self.use(voxels)
            record = self.record_of("--lines")
            medit = self.folder / "out.mesh"
            self.assert_exit(run_podm("mesh", self.image, "-o", medit, "--radius", 2.5, "--delta", 1, "--lines"), 0)
            edges = named_edges(medit)
            self.assertEqual(len(edges), record["lines"]["edges"])
            self.assertEqual(len({edge for edge, _ in edges}), len(edges))
            around = names_around_edges(read_medit(medit))
            for edge, names in edges:
                self.assertEqual(names, around[edge])
                self.assertGreaterEqual(len(names), 3)

    def test_convert_finds_the_edges_under_the_same_names_and_strays(self):
        for voxels in (grains(), noise(1)):
            self.use(voxels)
            first, second = self.folder / "first.mesh", self.folder / "second.mesh"
            self.assert_exit(run_podm("mesh", self.image, "-o", first, "--radius", 2.5, "--delta", 1, "--lines"), 0)
            self.assert_exit(run_podm("convert", first, second), 0)
            kept, found = set(named_edges(first)), set(named_edges(second))
            self.assertLessEqual(kept, found)
            around = names_around_edges(read_medit(second))
            self.assertEqual({edge for edge, _ in found}, {edge for edge, names in around.items() if len(names) >= 3})

    def test_reports_leave_out_angles_of_no_facets(self):
        for voxels, has_near in ((np.ones((6, 6, 6)), False), (np.indices((2, 2, 2))[2] + 1, True),
                                 (np.arange(8).reshape(2, 2, 2), True)):
            self.use(voxels)
            self.runs.unlink(missing_ok=True)
            process = self.mesh("--lines")
            self.assert_exit(process, 0)
            near = self.read_record(self.runs)["lines"]["near_lines"]
            self.assertEqual(near["facets"] > 0, has_near)
            for name in "min_facet_angle_deg", "max_radius_edge":
                self.assertEqual(near[name] is not None, has_near, name)
            self.assertEqual("near them" in process.stderr, has_near)
            self.assertEqual("elsewhere" in process.stderr, has_near and near["min_facet_angle_away_deg"] is not None)
            self.assertNotIn("180.00", process.stderr)

    def test_one_thread_makes_the_same_mesh_every_time(self):
        meshes = [self.record_of("--lines", "--threads", 1)["mesh_sha256"] for _ in range(2)]
        self.assertEqual(meshes[0], meshes[1])

    def test_the_edges_are_in_a_file_beside_the_mesh(self):
        record = self.record_of("--lines")
        text = (self.folder / "out_lines.vtu").read_bytes()
        self.assertIn(b'NumberOfCells="%d"' % record["lines"]["edges"], text)
        self.assertIn(b"|outside", text)
        self.assertIn(b"promise:lines 1.25", self.out.read_bytes())

    def test_without_the_option_there_is_no_such_file(self):
        record = self.record_of()
        self.assertIsNone(record["lines"])
        self.assertNotIn("R0", record["counters"]["insertions"])
        self.assertFalse((self.folder / "out_lines.vtu").exists())
        self.assertNotIn(b"promise:lines", self.out.read_bytes())

    def test_a_distance_of_its_own(self):
        fine, usual = self.record_of("--lines", "--lines-delta", 0.8), self.record_of("--lines")
        self.assertGreater(fine["lines"]["edges"], 1.3 * usual["lines"]["edges"])
        self.assertEqual(fine["lines"]["delta_mm"], 0.8)
        self.assert_has_lines(fine)

    def test_other_options_go_with_it(self):
        for options in few((["--smooth", 1], ["--min-dihedral", 8], ["--target-elements", 8000]), 2):
            record = self.record_of("--lines", *options)
            lines = record["lines"]
            self.assertGreaterEqual(lines["kept_mm"] + lines["excluded_mm"], 0.99 * lines["traced_mm"], options)

    def test_what_cannot_be_is_refused(self):
        output = ("mesh", self.image, "-o", self.out)
        self.assert_refused([*output, "--lines-delta", 1], "--lines")
        self.assert_refused([*output, "--lines", "--lines-delta", -1], "--lines-delta")
        self.assert_refused([*output, "--lines", "--thin", "keep"], "--lines", "--thin keep", "topology")
        self.assert_refused([*output, "--lines", "--optimize"], "--lines", "--optimize", "remove edges")

    def test_a_distance_without_room_for_samples_is_refused(self):
        output = ("mesh", self.image, "-o", self.out, "--delta", 1, "--lines", "--lines-delta")
        for distance in (1e-300, 1e-6, 0.2499):
            self.assert_refused([*output, distance], "--lines-delta", "below 0.25 mm")
        self.assert_has_lines(self.record_of("--lines", "--lines-delta", 0.25))

    def assert_ends_early(self, reason, *limit):
        """A run that ends early writes a valid mesh, which its replay equals."""
        self.runs.unlink(missing_ok=True)
        log = self.folder / "run.log"
        self.assert_exit(self.mesh("--lines", *limit, "--log", log), 1)
        record = self.read_record(self.runs)
        self.assertEqual(record["stop_reason"], reason)
        self.assert_exit(run_podm("replay", self.image, log), 0)
        claims = "structure,delaunay,conformity,surface"
        self.assert_exit(run_podm(self.out, "--claims", claims, program=VERIFIER), 0)
        return record

    def test_limits_hold_while_lines_are_sampled(self):
        whole = self.record_of("--lines", "--lines-delta", 0.3)
        for cells in (200, 1000, 4000):
            record = self.assert_ends_early("element limit", "--lines-delta", 0.3, "--max-elements", cells)
            self.assertLess(record["counters"]["store_cells"], cells + 200)
            self.assertLess(record["lines"]["edges"], whole["lines"]["edges"])

    def assert_ended_while_lines_were_traced(self, reason):
        record = self.read_record(self.runs)
        self.assertEqual(record["stop_reason"], reason)
        self.assertFalse(record["lines"]["is_traced"])
        self.assertFalse(record["lines"]["is_claimed"])
        self.assertLess(record["phases_s"]["trace"], 2.5)

    def test_limits_and_signals_end_the_tracing_of_lines(self):
        """Tracing all lines of this noise takes far longer."""
        self.use(noise(3, 56, 20))
        self.assert_exit(self.mesh("--lines", "--max-seconds", 1), 1)
        self.assert_ended_while_lines_were_traced("time limit")
        self.runs.unlink()
        process = start_podm("mesh", self.image, "-o", self.out, "--record", self.runs, "--radius", 2.5, "--lines")
        time.sleep(1)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        self.assert_ended_while_lines_were_traced("cancelled")

    def test_lines_of_an_earlier_mesh_are_reported(self):
        beside = self.folder / "out_lines.vtu"
        kept = self.record_of("--lines")
        self.assertFalse([text for text in kept["warnings"] if beside.name in text])
        self.assertIn(f"{self.out}: {beside.name} beside it is of another mesh", self.record_of()["warnings"])
        beside.unlink()
        self.assertFalse([text for text in self.record_of()["warnings"] if beside.name in text])


if __name__ == "__main__":
    unittest.main()
