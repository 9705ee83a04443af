"""podm mesh --box flat: objects end in the planes of the image's box, in any frame, and podm-verify proves it."""

import collections
import math
import unittest

import numpy as np

from podm_process import PodmTestCase, run_podm
from slow import few
from small_images import write_nifti

C, S, D, T = math.cos(0.3), math.sin(0.3), math.cos(1.1), math.sin(1.1)
FRAMES = {"parallel": ((1, 0, 0, -7.3), (0, 1, 0, 11.1), (0, 0, 1, 3.7)),
          "permuted": ((0, -1, 0, 5.3), (-1, 0, 0, 6.7), (0, 0, -1, 7.1)),
          "oblique": ((C, -S * D, S * T, -95.8), (S, C * D, -C * T, 97.4), (0, T, D, -79.9))}
SHEARED = ((1, 0.3, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0))


def block():
    """Two labels that fill the image, with an interface at an angle, and a cut ball of background; voxels[z, y, x]."""
    z, y, x = np.indices((13, 14, 15))
    voxels = np.where(x + 0.4 * y - 0.3 * z < 7, 1, 2)
    return np.where(x**2 + y**2 + (z - 12)**2 < 36, 0, voxels)


class Box(PodmTestCase):
    def setUp(self):
        super().setUp()
        self.runs = self.folder / "runs.jsonl"

    def image(self, frame):
        path = self.folder / f"block{len(frame)}{frame[0][0]}.nii"
        return write_nifti(path, block().astype(np.uint8).tobytes(), block().shape[::-1], affine=frame)

    def record_of(self, image, *arguments, output="out.vtu"):
        self.runs.unlink(missing_ok=True)
        self.assert_exit(run_podm("mesh", image, "-o", self.folder / output, "--record", self.runs, "--radius", 4,
                                  "--box", "flat", *arguments), 0)
        return self.read_record(self.runs)

    def test_every_algorithm_and_frame_passes_all_claims_and_equals_its_replay(self):
        for name, frame in FRAMES.items():
            image = self.image(frame)
            for algorithm in few((["podm", "--threads", 1], ["podm", "--threads", 2], ["pdr", "--threads", 2],
                                  ["pdr-podm", "--threads", 2]), 2):
                log = self.folder / "run.log"
                record = self.record_of(image, "--algorithm", *algorithm, "--oversubscribe", "--log", log, "--verify")
                self.assertEqual(record["verdicts"]["box"], "pass", name)
                self.assertEqual(set(record["verdicts"].values()), {"pass"}, name)
                self.assertEqual(record["turned"] is not None, name == "oblique")
                self.assertEqual("delaunay" in record["verdicts"],
                                 record["turned"] is None or record["turned"]["is_delaunay"])
                self.assertEqual(set(record["guarantees"].values()), {0})
                self.assertTrue(all(record["facets_of_sides"].values()), record["facets_of_sides"])
                self.assert_exit(run_podm("replay", image, log), 0)

    def test_lines_are_kept_in_every_frame_and_by_every_algorithm(self):
        for name, frame in FRAMES.items():
            image = self.image(frame)
            for algorithm in few((["podm", "--threads", 1], ["podm", "--threads", 2], ["pdr", "--threads", 2],
                                  ["pdr-podm", "--threads", 2], ["podm", "--smooth", 1, "--threads", 2]), 2):
                log = self.folder / "run.log"
                record = self.record_of(image, "--lines", "--algorithm", *algorithm, "--oversubscribe", "--log", log,
                                        "--verify")
                self.assertEqual(set(record["verdicts"].values()), {"pass"}, name)
                self.assertLessEqual({"box", "lines"}, set(record["verdicts"]), name)
                self.assertEqual(set(record["guarantees"].values()), {0})
                self.assertAlmostEqual(record["lines"]["kept_mm"], record["lines"]["traced_mm"])
                self.assert_exit(run_podm("replay", image, log), 0)

    def test_files_have_sides_and_lines(self):
        image = self.image(FRAMES["parallel"])
        texts = {"out.msh": (b'"box i-"', b'"label 1|label 2|outside"'), "out.mesh": (b"outside box i-", b"# line "),
                 "out.inp": (b"NAME=box_i-", b"NSET=label_1-label_2-outside"),
                 "out.exo": (b"box i-", b"label 1|label 2|outside"), "out.xdmf": (b'Name="side"', b'Name="lines"')}
        for name, marks in texts.items():
            self.record_of(image, "--lines", output=name)
            text = (self.folder / name).read_bytes()
            for mark in marks:
                self.assertIn(mark, text, name)
        self.record_of(image, "--lines")
        self.assertIn(b"box_side", (self.folder / "out_facets.vtu").read_bytes())
        self.assertIn(b"line:label 1", (self.folder / "out_lines.vtu").read_bytes())

    def test_the_sides_are_named_sets(self):
        image = self.image(FRAMES["parallel"])
        self.record_of(image, output="out.msh")
        self.assertIn(b'"box i-"', (self.folder / "out.msh").read_bytes())
        self.record_of(image, "--gmsh-version", "2.2", output="old.msh")
        self.assertIn('|outside box k+"', (self.folder / "old.msh").read_text())
        counts = self.record_of(image, output="out.inp")["facets_of_sides"]
        text = (self.folder / "out.inp").read_text()
        surface = text.split("*SURFACE, TYPE=ELEMENT, NAME=box_j-\n")[1].split("*")[0]
        self.assertEqual(len(surface.splitlines()), counts["j-"])
        self.record_of(image, output="out.exo")
        self.assertIn(b"box k-", (self.folder / "out.exo").read_bytes())
        self.record_of(image, output="out.vtk")
        self.assertIn(b"SCALARS box_side", (self.folder / "out_facets.vtk").read_bytes())
        self.record_of(image, output="out.xdmf")
        self.assertIn('Name="side"', (self.folder / "out.xdmf").read_text())

    def test_a_number_is_of_one_pair_on_one_side(self):
        """Medit and TetGen have one number per facet: it names the pair of labels and the side."""
        image = self.image(FRAMES["parallel"])
        counts = self.record_of(image, output="out.mesh")["facets_of_sides"]
        self.record_of(image, output="out.node")
        medit, tetgen = ((self.folder / name).read_text().splitlines() for name in ("out.mesh", "out.face"))
        first = medit.index("Triangles") + 2
        triangles = medit[first:first + int(medit[first - 1])]
        faces = tetgen[1:1 + int(tetgen[0].split()[0])]
        for lines, numbers in ((medit, triangles), (tetgen, faces)):
            names = {row.split()[2]: row for row in lines if row.startswith("# pair ")}
            found = collections.Counter(names[row.split()[-1]].partition(" box ")[2] for row in numbers)
            del found[""]
            self.assertEqual(found, {side: count for side, count in counts.items() if count})
            self.assertIn("label 1|outside box i-", "\n".join(names.values()))

    def test_an_open_box_has_no_sides(self):
        self.assert_exit(run_podm("mesh", self.image(FRAMES["parallel"]), "-o", self.folder / "open.vtu", "--record",
                                  self.runs, "--radius", 4), 0)
        record = self.read_record(self.runs)
        self.assertIsNone(record["facets_of_sides"])
        self.assertNotIn(b"box", (self.folder / "open.vtu").read_bytes()[:2000])

    def test_what_it_refuses(self):
        out = self.folder / "out.vtu"
        self.assert_refused(["mesh", self.image(SHEARED), "-o", out, "--box", "flat"], "--box flat", "sheared")


if __name__ == "__main__":
    unittest.main()
