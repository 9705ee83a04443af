"""The command line itself: help, version, and refusals before any file is read."""

import json
import re
import subprocess
import unittest

from podm_process import PROGRAM, PodmTestCase, run_podm

OPTIONS = {
    "mesh": ["--output", "--radius", "--radius-of", "--size-image", "--size-near", "--grade", "--delta", "--thin",
             "--delta-least", "--target-elements", "--target-tolerance", "--target-meshes", "--smooth",
             "--box", "--min-dihedral", "--labels", "--drop-islands", "--merge", "--drop", "--layers", "--background",
             "--label-names", "--space", "--surface", "--record", "--max-elements", "--max-seconds",
             "--max-memory-gib", "--threads", "--contention", "--algorithm", "--crossover", "--nodes",
             "--cores-per-node", "--initial-ratio", "--initial-threads", "--leaf-size", "--schedule", "--executor",
             "--virtual-cost", "--seed", "--log", "--begging", "--pin", "--oversubscribe", "--topology",
             "--cost-factor", "--stats", "--verify", "--verify-fidelity", "--report", "--json-progress", "--quiet",
             "--optimize", "--dihedral-bounds", "--gmsh-version", "--lines", "--lines-delta",
             "--values", "--values-of"],
    "convert": ["--gmsh-version"],
    "replay": ["--labels", "--merge", "--drop", "--layers", "--background", "--label-names", "--drop-islands"],
    "info": ["--labels", "--merge", "--drop", "--layers", "--background", "--label-names", "--drop-islands", "--json",
             "--output", "--plan", "--radius", "--radius-of", "--size-image", "--size-near", "--grade", "--delta",
             "--thin", "--delta-least", "--target-elements", "--target-tolerance", "--smooth", "--min-dihedral",
             "--optimize", "--dihedral-bounds", "--algorithm", "--threads", "--oversubscribe", "--lines",
             "--lines-delta"],
    "phantom": ["--size", "--output", "--label-names"],
    "view": ["--output", "--cut", "--flip", "--labels", "--hide", "--colour", "--camera", "--zoom", "--size",
             "--background", "--no-legend"],
    "serve": ["--port", "--no-browser", "--max-upload-mib", "--max-memory-gib", "--max-seconds"],
}


class Help(PodmTestCase):
    def test_each_option_is_listed_with_its_default(self):
        for command, options in OPTIONS.items():
            process = run_podm(command, "--help")
            self.assert_exit(process, 0)
            self.assertEqual(process.stderr, "")
            entries = re.split(r"\n  (?=\S)", process.stdout)
            for option in options:
                entry = [e for e in entries if re.search(rf"(^|,){option}\b(?!-)", e.split(" ")[0])]
                self.assertEqual(len(entry), 1, f"{command} {option}")
                self.assertRegex(entry[0], r"\[default: [^\]]+\]|\[required\]")

    def test_no_option_is_missing_from_this_list(self):
        for command, options in OPTIONS.items():
            listed = set(re.findall(r"^  (?:-\w,)?(--[\w-]+)", run_podm(command, "--help").stdout, re.MULTILINE))
            self.assertEqual(listed - {"--help"}, set(options))

    def test_lengths_say_their_unit(self):
        text = run_podm("mesh", "--help").stdout
        for option in ("--radius", "--delta"):
            self.assertRegex(text, rf"{option} MM [^\n]*\bmm\b")

    def test_lines_fit_a_terminal(self):
        for arguments in (["--help"], *([command, "--help"] for command in OPTIONS)):
            lines = run_podm(*arguments).stdout.splitlines()
            self.assertLessEqual(max(map(len, lines)), 110)

    def test_commands_are_listed(self):
        text = run_podm("--help").stdout
        for command in OPTIONS:
            self.assertRegex(text, rf"\n  {command}\b")

    def test_version_is_data(self):
        process = run_podm("--version")
        self.assert_exit(process, 0)
        first, *build = process.stdout.splitlines()
        self.assertRegex(first, r"^podm \d+\.\d+\.\d+$")
        build_info = dict(line.split(": ", 1) for line in build)
        self.assertEqual(list(build_info), ["compiler", "flags", "commit", "dirty", "libraries"])
        self.assertRegex(build_info["commit"], r"^([0-9a-f]{40}|unknown)$")
        self.assertIn(build_info["dirty"], ("true", "false", "unknown"))
        self.assertIn("-ffp-contract=off", build_info["flags"])
        for library in ("Boost", "CGAL", "hwloc", "ITK", "numa", "zlib"):
            self.assertRegex(build_info["libraries"], rf"\b{library} \d")

    def test_standard_output_that_is_full_is_a_fault(self):
        with open("/dev/full", "w") as full:
            process = subprocess.run([PROGRAM, "--help"], stdout=full, stderr=subprocess.PIPE, text=True)
        self.assertEqual(process.returncode, 2)
        self.assertIn("standard output", process.stderr)


class Judging(PodmTestCase):
    def judging(self, *options):
        """Returns the claims and the options with which the record of a run has its mesh judged."""
        records = self.folder / "runs.jsonl"
        self.assert_exit(run_podm("mesh", "phantom:spheres@24", "-o", self.folder / "m.vtu", "--radius", 6, "--record",
                                  records, *options), 0)
        verify = json.loads(records.read_text().splitlines()[-1])["verify"]
        return verify["claims"], " ".join(verify["options"])

    def test_records_have_the_claims_that_a_mesh_promises(self):
        claims, options = self.judging()
        self.assertLessEqual({"delaunay", "size", "surface_vertices"}, set(claims))
        self.assertIn("--radius 6", options)
        self.assertNotIn("delaunay", self.judging("--optimize")[0])
        self.assertIn("fidelity", self.judging("--verify-fidelity")[0])
        self.assertIn("--size-near 1,0=2:3 --grade 0.5", self.judging("--size-near", "1,0=2:3", "--grade", "0.5")[1])


class Usage(PodmTestCase):
    def mesh(self, *arguments):
        return ["mesh", "phantom:spheres@16", "-o", self.folder / "out.mesh", *arguments]

    def test_unknown_words_are_named_and_the_nearest_is_offered(self):
        self.assert_refused(self.mesh("--raduis", "4"), "--raduis", "'--radius'", "podm mesh --help")
        self.assert_refused(["mehs"], "mehs", "'mesh'")
        self.assert_refused(["info", "phantom:spheres@16", "--jsn"], "--jsn", "'--json'")
        self.assert_refused(self.mesh("surplus"), "surplus")
        self.assert_refused(["--frobnicate"], "--frobnicate")

    def test_nothing_asked_for(self):
        self.assert_refused([], "mesh", "info", "phantom")
        self.assert_refused(["mesh"], "IMAGE")
        self.assert_refused(["mesh", "phantom:spheres@16"], "--output")
        self.assert_refused(["phantom", "spheres"], "--output")

    def test_lengths_are_positive_and_finite(self):
        for option in ("--radius", "--delta"):
            for value in ("0", "-1", "-0.0", "nan", "inf", "1e999", "", "two", "1mm", "0x1p3"):
                with self.subTest(option=option, value=value):
                    self.assert_refused(self.mesh(f"{option}={value}"), option)

    def test_radius_of_needs_a_label_and_a_length(self):
        for value in ("1", "=2", "1=", "1=0", "1=nan", "1=-3"):
            with self.subTest(value=value):
                self.assert_refused(self.mesh("--radius-of", value), "--radius-of")

    def test_counts_are_positive_integers(self):
        for option in ("--target-elements", "--max-elements", "--threads"):
            for value in ("0", "-1", "1.5", "1e3", "99999999999999999999999", "x"):
                with self.subTest(option=option, value=value):
                    self.assert_refused(self.mesh(f"{option}={value}"), option)

    def test_the_least_dihedral_angle_is_one_that_cells_may_have(self):
        for value in ("0", "-8", "nan", "60.5", "180", "8deg"):
            with self.subTest(value=value):
                self.assert_refused(self.mesh(f"--min-dihedral={value}"), "dihedral")

    def test_other_values(self):
        self.assert_refused(self.mesh("--space", "ras"), "--space", "RAS, LPS or voxel")
        self.assert_refused(self.mesh("--max-seconds", "0"), "--max-seconds")
        self.assert_refused(self.mesh("--max-memory-gib", "-2"), "--max-memory-gib")
        self.assert_refused(self.mesh("--background", "-1"), "--background")
        self.assert_refused(self.mesh("--labels", "3-1"), "--labels")
        self.assert_refused(self.mesh("--drop", "a"), "--drop")
        self.assert_refused(self.mesh("--merge", "2,3"), "--merge")
        self.assert_refused(["phantom", "spheres", "--size", "0", "-o", self.folder / "p.nii"], "--size")

    def test_options_that_exclude_each_other_and_repetitions(self):
        self.assert_refused(self.mesh("--radius", "2", "--target-elements", "1000"), "--radius",
                            "--target-elements")
        self.assert_refused(self.mesh("--radius", "2", "--radius", "3"), "--radius")

    def test_an_option_that_needs_another(self):
        self.assert_refused(self.mesh("--target-tolerance", "1"), "--target-tolerance", "--target-elements")


if __name__ == "__main__":
    unittest.main()
