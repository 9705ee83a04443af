"""podm mesh --report: a complete page about a run, or none, with the verdicts and the quality of cells."""

import json
import re
import shutil
import sys
import unittest

from podm_process import PROGRAM, PodmTestCase, run_podm
from slow import slow

try:
    import vtk  # noqa: F401
    from browser import Browser, find_chromium
except ImportError:
    vtk = None


def setUpModule():
    if vtk is None:
        print("skipped: python3-vtk9 is not installed", file=sys.stderr)
        raise unittest.SkipTest("not installed")


class Report(PodmTestCase):
    def mesh(self, *more, name="a.vtu", **options):
        return run_podm("mesh", "phantom:spheres@16", "--radius", "5", "--threads", "1", "--record",
                        self.folder / "a.jsonl", "-o", self.folder / name, "--report", self.folder / "a.html", *more,
                        **options)

    def page(self):
        return (self.folder / "a.html").read_text()

    def test_the_page_says_what_was_proved_and_what_was_not_asked(self):
        self.assert_exit(self.mesh("--verify"), 0)
        record = self.read_record(self.folder / "a.jsonl")
        self.assertIn(f"podm-verify has proved {len(record['verdicts'])} claims", self.page())
        self.assertIn(f"{record['cells']:,} tetrahedra", self.page())
        self.assertIn(record["mesh_sha256"], self.page())
        for label in record["labels"]:
            self.assertIn(f'"value": {label["value"]}, ', self.page())
        (self.folder / "a.jsonl").unlink()
        self.assert_exit(self.mesh(), 0)
        self.assertIn("It is not verified independently", self.page())

    def test_a_missed_limit_is_the_first_thing_said(self):
        self.assert_exit(self.mesh("--max-elements", "200"), 1)
        self.assertIn("No, not all of it.", self.page())
        self.assertRegex(self.page(), "ended early: element limit")

    @slow
    def test_formats_give_the_same_numbers(self):
        tables = []
        for name in ("a.vtu", "a.vtk", "a.inp", "a.xdmf"):
            self.assert_exit(self.mesh(name=name), 0)
            tables.append(re.search(r'<section id="labels".*?</section>', self.page(), re.DOTALL).group())
        self.assertEqual(len(set(tables)), 1)

    def test_needs_no_network_and_draws(self):
        self.assert_exit(self.mesh("--verify"), 0)
        self.assertEqual({link for link in re.findall(r'(?:src|href)="([^"]*)"', self.page())
                          if not link.startswith(("#", "data:"))}, set())
        if find_chromium() is None:
            self.skipTest("chromium is not installed")
        browser = Browser()
        self.addCleanup(browser.close)
        for width, scheme in ((1300, "light"), (400, "dark")):
            browser.open(self.folder / "a.html", width, scheme=scheme)
            self.assertEqual(browser.errors, [])
            self.assertEqual(browser.evaluate("document.documentElement.scrollWidth"), width)
            self.assertEqual(browser.evaluate("document.querySelector('[data-fault]').textContent"), "")
            self.assertEqual(browser.evaluate("document.querySelectorAll('[data-labels] input').length"),
                             len(self.read_last()["labels"]))

    def read_last(self):
        return json.loads((self.folder / "a.jsonl").read_text().splitlines()[-1])

    @slow
    def test_a_mesh_too_large_to_turn_is_cut_by_planes(self):
        self.assert_exit(run_podm("mesh", "phantom:spheres@24", "--radius", "1", "--quiet", "-o", self.folder / "a.vtu",
                                  "--report", self.folder / "a.html"), 0)
        self.assertRegex(self.page(), "cells, more than the 200,000 that a page can turn")
        self.assertEqual(self.page().count('src="data:image/png;base64,'), 1)
        self.assertNotIn("<canvas", self.page())

    def test_text_of_images_is_escaped(self):
        self.assert_exit(self.mesh("--merge", "1,2=<b>1"), 0)
        self.assertNotIn("<b>1", self.page())
        self.assertIn("&lt;b&gt;1", self.page())

    def test_what_cannot_be_is_refused_before_meshing(self):
        for report in "a.htm", "none/a.html":
            self.assert_refused(["mesh", "phantom:spheres@16", "-o", self.folder / "a.vtu", "--report",
                                 self.folder / report], report)

    def test_a_failure_leaves_the_mesh_and_the_page_before(self):
        (self.folder / "a.html").write_text("before")
        program = self.folder / "bin" / "podm"
        (self.folder / "share").mkdir()
        (self.folder / "share" / "podm").mkdir()
        program.parent.mkdir()
        shutil.copy(PROGRAM, program)
        script = self.folder / "share" / "podm" / "mesh_report"
        script.write_text("import sys; sys.exit(sys.argv[1] != '--check' and 'it fails')\n")
        process = self.mesh(program=program)
        self.assert_exit(process, 2)
        self.assertIn("it fails", process.stderr)
        self.assertIn("a.vtu is written", process.stderr)
        self.assertEqual(self.page(), "before")
        self.assertTrue((self.folder / "a.vtu").exists() and (self.folder / "a.jsonl").exists())
        self.assertEqual([path for path in self.folder.iterdir() if ".tmp" in path.name], [])
        script.unlink()
        self.assert_exit(self.mesh(program=program), 2)


if __name__ == "__main__":
    unittest.main()
