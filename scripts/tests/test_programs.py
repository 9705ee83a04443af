"""scripts/make_figures and scripts/report as people call them, and the page as a browser shows it."""
import io
import json
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import matplotlib.image
import numpy
import paths
import synthetic
from browser import Browser, find_chromium
from figures import paper


def call(program, *arguments):
    return subprocess.run(["/usr/bin/python3", "-B", paths.SCRIPTS / program, *arguments], capture_output=True, text=True)


def write_rows(path, rows):
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
    return path


class Programs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_makes_all_of_the_reference_runs(self):
        done = call("make_figures", "--records", paths.REFERENCE, "-o", self.folder / "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("has no `schema`", done.stderr)
        made = {path.name for path in (self.folder / "out").iterdir()}
        tables = {f"{name}.{kind}" for name in ("table1", "table2", "table3", "cache") for kind in ("csv", "md")}
        figures = {f"{name}.{kind}" for name in ("fig1", "fig4a", "fig4b") for kind in ("pdf", "png")}
        self.assertEqual(made, {"rows.csv", "verdicts.json", "verdicts.md"} | tables | figures)
        found = json.loads((self.folder / "out" / "verdicts.json").read_text())
        self.assertIn("reference", {cell["verdict"] for cell in found["cells"]})
        self.assertIn("needs 256 cores, has 2", {cell["reason"] for cell in found["cells"]})

    def test_equal_records_give_equal_files(self):
        rows = write_rows(self.folder / "weak.jsonl", synthetic.like_the_paper(paper.table1(), repeats=2))
        for name in "ab":
            call("make_figures", "--records", rows, "-o", self.folder / name)
        for path in (self.folder / "a").iterdir():
            self.assertEqual(path.read_bytes(), (self.folder / "b" / path.name).read_bytes(), path.name)

    def test_bad_input_is_named(self):
        newer = write_rows(self.folder / "newer.jsonl", [synthetic.row(schema=9)])
        fine = write_rows(self.folder / "fine.jsonl", [synthetic.row()])
        for program, arguments, words in (
            ("make_figures", ["--records", self.folder / "none"], "none: no such file or folder"),
            ("make_figures", ["--records", newer], "newer.jsonl:1: schema 9"),
            ("report", ["--records", fine, "--mesh", fine], "fine.jsonl: no cells"),
            ("report", ["--records", fine, "--verified", fine], "fine.jsonl: not a report of schema podm-verify/1"),
            ("report", ["--records", fine, "--schedule", fine], "fine.jsonl: schema 2; this program reads podm-schedule/1"),
            ("report", ["--unknown"], "unrecognized arguments"),
        ):
            with self.subTest(words=words):
                done = call(program, "-o", self.folder / "out", *arguments)
                self.assertEqual(done.returncode, 2)
                self.assertIn(words, done.stderr)
                self.assertFalse((self.folder / "out").exists())

    def test_without_a_mesh_the_page_says_so(self):
        rows = write_rows(self.folder / "rows.jsonl", [synthetic.row()])
        done = call("report", "--records", rows, "-o", self.folder / "page.html")
        self.assertEqual(done.returncode, 0, done.stderr)
        text = (self.folder / "page.html").read_text()
        self.assertIn("No mesh was given", text)
        self.assertNotIn("<canvas", text)


def make_page(folder):
    """A page with everything in it."""
    rows = [synthetic.row(), synthetic.row(trial="<script>alert(1)</script>", status="failed", reason="<b>&"),
            *synthetic.like_the_paper(paper.table1(), repeats=2, executor="virtual")]
    write_rows(folder / "rows.jsonl", rows)
    write_rows(folder / "schedule.jsonl", synthetic.schedule())
    write_rows(folder / "verified.json", [synthetic.report()])
    synthetic.write_vtu(folder / "mesh.vtu", *synthetic.box_mesh(side=6))
    done = call("report", "--records", folder / "rows.jsonl", "--mesh", folder / "mesh.vtu", "--schedule",
                folder / "schedule.jsonl", "--verified", folder / "verified.json", "-o", folder / "page.html")
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    return folder / "page.html"


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = make_page(Path(folder.name))
        cls.text = cls.path.read_text()

    def test_needs_no_network(self):
        loads = re.findall(r'(?:src|href)="([^"]*)"', self.text)
        outside = {link for link in loads if not link.startswith(("#", "data:"))}
        self.assertEqual(outside, {"https://doi.org/10.1016/j.proeng.2015.10.119"})
        self.assertNotIn("@import", self.text)

    def test_ids_are_unique_and_links_arrive(self):
        ids = re.findall(r'\bid="([^"]*)"', self.text)
        self.assertEqual(len(ids), len(set(ids)))
        self.assertEqual(set(re.findall(r'href="#([^"]*)"', self.text)) - set(ids), set())

    def test_text_of_records_is_escaped(self):
        self.assertIn("status failed: &lt;b&gt;&amp;", self.text)
        self.assertNotIn("<script>alert", self.text)


@unittest.skipUnless(find_chromium(), "no Chromium here: Debian's package chromium")
class InBrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = make_page(Path(folder.name))
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)

    def test_loads_without_complaints_and_fits(self):
        for width, scheme in ((1280, "light"), (1280, "dark"), (390, "light")):
            with self.subTest(width=width, scheme=scheme):
                self.browser.open(self.path, width, scheme=scheme)
                self.assertEqual(self.browser.errors, [])
                self.assertEqual(self.browser.evaluate("document.documentElement.scrollWidth"), width)
                self.assertEqual(self.browser.evaluate("document.querySelector('[data-fault]').textContent"), "")
                self.assertGreater(self.colours_on_canvas(), 10)

    def test_the_cut_and_the_labels_change_the_picture(self):
        self.browser.open(self.path, 1280)
        whole = self.browser.screenshot("canvas")
        self.set("[name=cut]", "value", 0.2)
        cut = self.browser.screenshot("canvas")
        self.assertNotEqual(whole, cut)
        for box in range(2):
            self.browser.evaluate(f"document.querySelectorAll('[data-labels] input')[{box}].click()")
        self.assertLess(self.colours_on_canvas(), 10)  # no label, no cell

    def set(self, selector, name, value):
        self.browser.evaluate(f"""(() => {{ const one = document.querySelector('{selector}'); one.{name} = {value};
            one.dispatchEvent(new Event('input')); return new Promise(done => setTimeout(done, 500)); }})()""")

    def colours_on_canvas(self):
        """Colours inside its border."""
        self.browser.evaluate("new Promise(done => setTimeout(done, 500))")
        picture = matplotlib.image.imread(io.BytesIO(self.browser.screenshot("canvas")))
        return len(numpy.unique(picture[20:-20, 20:-20].reshape(-1, picture.shape[2]), axis=0))


if __name__ == "__main__":
    unittest.main()
