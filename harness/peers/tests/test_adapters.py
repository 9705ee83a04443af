"""Tests of the peers' adapters with synthetic programs: the runs of podm that they request, the seconds they count."""
import json
import pathlib
import subprocess
import sys
import tempfile
import textwrap
import unittest

PEERS = pathlib.Path(__file__).resolve().parents[1]
PYTHON = f"#!{sys.executable}\n"
# A podm that logs its arguments and takes 8 s for the surface and 10 s with a radius, without reading and writing.
PODM = PYTHON + textwrap.dedent("""\
    import json, pathlib, sys
    if sys.argv[1:] == ["--version"]:
        sys.exit(print("podm 9.9.9"))
    if sys.argv[1] == "info":
        sys.exit(print(json.dumps({"spacing_mm": [2, 2, 2], "affine": [[2, 0, 0, 10], [0, 2, 0, 20], [0, 0, 2, 30]]})))
    here = pathlib.Path(__file__).parent
    with open(here / "runs", "a") as log:
        print(*sys.argv[1:], file=log)
    switches = dict(zip(sys.argv[3:], sys.argv[4:]))
    seconds = float((here / "seconds_with_radius").read_text()) if "--radius" in switches else 8
    pathlib.Path(switches["-o"]).write_text("mesh")
    with open(switches["--record"], "a") as record:
        print(json.dumps({"cells": 300 if "--radius" in switches else 100, "vertices": 50, "boundary_facets": 40,
                          "phases_s": {"read": 70, "transform": 1, "allocate": 0.5, "refine": seconds - 2,
                                       "extract": 0.5, "measure": 80, "write": 90},
                          "mesh_sha256": "ab", "threads": {"asked": 2, "used": 2}}), file=record)
    """)
CGAL = PYTHON + textwrap.dedent("""\
    import json, pathlib, sys
    if "--version" in sys.argv:
        sys.exit(print("CGAL 7.7 Mesh_3, GPL"))
    pathlib.Path(sys.argv[sys.argv.index("--output") + 1]).write_text("Vertices\\n1\\n2 4 6 0\\nEnd\\n")
    print(json.dumps({"read_seconds": 5, "prepare_seconds": 0.25, "seconds": 4, "cells": 9, "vertices": 1,
                      "boundary_facets": 3, "options": {"queue": "sorted", "cgal": "7.7"}}))
    """)


class Adapters(unittest.TestCase):
    def setUp(self):
        made = tempfile.TemporaryDirectory()
        self.addCleanup(made.cleanup)
        self.folder = pathlib.Path(made.name)
        self.program("podm", PODM)
        self.take_with_radius(10)
        (self.folder / "image.inr").write_text("image")
        self.output = self.folder / "output"

    def program(self, name, text):
        (self.folder / name).write_text(text)
        (self.folder / name).chmod(0o755)

    def take_with_radius(self, seconds):
        (self.folder / "seconds_with_radius").write_text(str(seconds))

    def ask(self, name, *switches):
        return subprocess.run([PEERS / name / "run", "--podm", self.folder / "podm", *switches], capture_output=True,
                              text=True)

    def mesh(self, name, *switches):
        self.output.mkdir()
        return self.ask(name, "--image", self.folder / "image.inr", "--output", self.output, *switches)

    def record(self):
        return json.loads((self.output / "record.jsonl").read_text())

    def runs(self):
        return (self.folder / "runs").read_text().splitlines()

    def test_volume_part_is_what_the_radius_costs(self):
        done = self.mesh("podm_volume", "--radius", "2", "--delta", "1", "--threads", "2")
        self.assertEqual(done.returncode, 0, done.stderr)
        record = self.record()
        self.assertEqual(record["phases_s"], {"surface": 8, "refine": 2}, "neither reading nor measuring nor writing")
        self.assertEqual((record["cells"], record["surface_cells"], record["boundary_facets"]), (300, 100, 40))
        self.assertEqual(["--radius" in run for run in self.runs()], [False, True, True, False])
        for run in self.runs():
            self.assertIn("--delta 1.0", run)
            self.assertIn("--threads 2", run, "surface and volume are made on as many threads")
        self.assertEqual(len(record["surface_alone"]) + len(record["surface_and_volume"]), 4, "evidence of each run")

    def test_a_volume_part_lost_in_noise_is_no_number(self):
        self.take_with_radius(7.5)
        done = self.mesh("podm_volume", "--radius", "2", "--delta", "1")
        self.assertEqual((done.returncode, self.output.joinpath("record.jsonl").exists()), (77, False))
        self.assertIn("0.5 s longer", done.stderr)

    def test_a_volume_part_needs_a_radius(self):
        self.assertEqual(self.mesh("podm_volume", "--delta", "1").returncode, 77)

    def test_the_surface_is_made_without_the_radius_where_delta_is_given(self):
        sys.path.insert(0, str(PEERS))
        import adapter
        self.output.mkdir()
        options = lambda delta: adapter.argparse.Namespace(
            podm=str(self.folder / "podm"), image="image", output=str(self.output), radius=2.0, delta=delta, threads=1)
        adapter.surface_alone(options(1.0))
        adapter.surface_alone(options(None))
        with_delta, without = self.runs()
        self.assertNotIn("--radius", with_delta)
        self.assertIn("--radius 2.0", without, "podm's own delta follows from the radius")
        self.assertNotIn("--delta", without)

    def test_peers_on_a_surface_name_the_podm_that_makes_it(self):
        first = self.ask("podm_volume", "--version").stdout
        self.assertIn("podm 9.9.9 (", first)
        self.program("podm", PODM + "\n# another build")
        self.assertNotEqual(self.ask("podm_volume", "--version").stdout, first, "its rows are not those of the other")

    def test_cgal_6_without_headers_says_how_to_give_them(self):
        for name in ("cgal6", "cgal6_unsorted"):
            done = self.ask(name, "--version")
            self.assertEqual((done.returncode, done.stdout.strip()),
                             (77, "CGAL 6 headers were not given: make peers CGAL6=FOLDER"))
        self.assertIn("cgal_mesh3 is not built", self.ask("cgal", "--version").stdout)

    def test_cgal_reports_all_phases_and_its_version(self):
        self.program("cgal6_mesh3", CGAL)
        self.assertEqual(self.ask("cgal6", "--version").stdout.strip(), "CGAL 7.7 Mesh_3, GPL")
        done = self.mesh("cgal6", "--radius", "2", "--delta", "1")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.record()["phases_s"], {"read": 5, "prepare": 0.25, "refine": 4})
        self.assertEqual(self.record()["options"]["cgal"], "7.7")
        self.assertIn("12.0 24.0 36.0 0", (self.output / "mesh.mesh").read_text(), "in the image's frame")

    def test_lines_are_asked_of_a_cgal_that_detects_them(self):
        self.program("cgal6_mesh3", CGAL)
        done = self.mesh("cgal6", "--radius", "2", "--delta", "1", "--lines")
        self.assertEqual(done.returncode, 0, done.stderr)
        switches = self.record()["options"]["switches"]
        self.assertEqual(switches[switches.index("--lines"):][:3], ["--lines", "--edge-size", "1.25"])
        self.assertEqual(self.record()["promises"], ["structure", "conformity"])

    def test_meshers_without_lines_refuse_them(self):
        self.program("cgal_mesh3", CGAL.replace("7.7", "5.5.1"))
        for name, why in (("cgal", "before 5.6"), ("podm_volume", "keeps no lines")):
            done = self.ask(name, "--image", self.folder / "image.inr", "--output", self.output, "--lines")
            self.assertEqual(done.returncode, 77, done.stderr)
            self.assertIn(why, done.stderr)


if __name__ == "__main__":
    unittest.main()
