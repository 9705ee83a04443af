"""Tests scripts/make_figures and scripts/report from the command line, and the text of the page."""
import json
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import paths
import synthetic
from figures import paper, paper_claims
from slow import slow


def call(program, *arguments):
    command = ["/usr/bin/python3", "-B", paths.SCRIPTS / program, *arguments]
    return subprocess.run(command, capture_output=True, text=True)


def write_rows(path, rows):
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
    return path


class Programs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def check_all_made(self, records):
        """A folder of records gives every table and figure that needs no other file. Returns the finished process."""
        done = call("make_figures", "--records", records, "-o", self.folder / "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        made = {path.name for path in (self.folder / "out").iterdir()}
        names = ("table1", "table2", "table3", "simulated", "cache", "guarantees", "guarantees_of_others", "peers")
        tables = {f"{name}.{kind}" for name in names for kind in ("csv", "md")}
        figures = {f"{name}.{kind}" for name in ("fig1", "fig4a", "fig4b") for kind in ("pdf", "png")}
        self.assertLessEqual({"rows.csv", "verdicts.json", "verdicts.md"} | tables | figures, made)
        found = json.loads((self.folder / "out" / "verdicts.json").read_text())
        self.assertIn("reference", {cell["verdict"] for cell in found["cells"]})
        self.assertIn("needs 256 cores, has 2", {cell["reason"] for cell in found["cells"]})
        return done

    @slow
    def test_makes_all_of_the_reference_runs(self):
        self.check_all_made(paths.REFERENCE)

    def test_makes_all_of_a_folder_and_those_within(self):
        (self.folder / "runs" / "default_tier").mkdir(parents=True)
        virtual = synthetic.with_hops([synthetic.row("pdr-podm", 64, executor="virtual")], {64: [9, 1]})
        unread = {"counters": {"cycles": "unavailable: no such counter"}}
        write_rows(self.folder / "runs" / "default_tier" / "rows.jsonl",
                   [synthetic.row(process=unread), synthetic.row(cores=2), synthetic.peer("tetgen"), *virtual])
        write_rows(self.folder / "runs" / "radii.jsonl", [{"target_elements": 5}])
        done = self.check_all_made(self.folder / "runs")
        self.assertNotIn("radii", done.stderr)
        self.assertIn("podm-bench verdicts", done.stdout, "it says how verdicts of experiments are made")

    def test_verdicts_of_experiments_are_printed_and_written(self):
        rows = write_rows(self.folder / "rows.jsonl", [synthetic.row()])
        found = synthetic.experiment_verdicts(first="holds", second="does_not_hold", third="cannot_be_decided")
        write_rows(self.folder / "found.json", [found])
        done = call("make_figures", "--records", rows, "--experiment-verdicts", self.folder / "found.json",
                    "-o", self.folder / "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        written = (self.folder / "out" / "verdicts.md").read_text()
        for words in (done.stdout, written):
            self.assertLess(words.index("second"), words.index("first"), "what does not hold is not hidden")
            self.assertIn("because of <third>", words)
        self.assertIn("1 hold, 1 do not, 0 not resolved, 1 cannot be decided here", done.stdout)

    @slow
    def test_equal_records_give_equal_files(self):
        rows = write_rows(self.folder / "weak.jsonl", synthetic.like_the_paper(paper.table1(), repeats=2))
        for name in "ab":
            call("make_figures", "--records", rows, "-o", self.folder / name)
        for path in (self.folder / "a").iterdir():
            self.assertEqual(path.read_bytes(), (self.folder / "b" / path.name).read_bytes(), path.name)

    def test_bad_input_is_named(self):
        newer = write_rows(self.folder / "newer.jsonl", [synthetic.row(schema=9)])
        fine = write_rows(self.folder / "fine.jsonl", [synthetic.row()])
        odd = write_rows(self.folder / "odd.json", [synthetic.experiment_verdicts(one="perhaps")])
        for program, arguments, words in (
            ("make_figures", ["--records", self.folder / "none"], "none: no such file or folder"),
            ("make_figures", ["--records", newer], "newer.jsonl:1: schema 9"),
            ("report", ["--records", fine, "--mesh", fine], "fine.jsonl: not a mesh file that can be shown"),
            ("report", ["--records", fine, "--verified", fine], "fine.jsonl: not a report of schema podm-verify/1"),
            ("report", ["--records", fine, "--schedule", fine],
             "fine.jsonl: schema 4; this program reads podm-schedule/1"),
            ("report", ["--records", fine, "--experiment-verdicts", fine],
             "fine.jsonl: not verdicts of schema podm-bench-verdicts/2"),
            ("make_figures", ["--records", fine, "--experiment-verdicts", odd], "weak_scaling: one: verdict 'perhaps'"),
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


def make_page(folder, *more):
    """Makes a page with all parts, and with the rows of `more`."""
    rows = [*(synthetic.row(cores=cores, repeat=repeat) for cores in (1, 2) for repeat in (1, 2)),
            synthetic.row(trial="<script>alert(1)</script>", status="failed", reason="<b>&"), synthetic.peer("tetgen"),
            synthetic.with_levels([4, 11, 40, 200, 1500]),
            *synthetic.like_the_paper(paper.table1(), repeats=2, executor="virtual"), *more]
    write_rows(folder / "rows.jsonl", rows)
    write_rows(folder / "schedule.jsonl", synthetic.schedule())
    write_rows(folder / "verified.json", [synthetic.report()])
    found = synthetic.experiment_verdicts(good="holds", bad="does_not_hold", vague="not_resolved",
                                           open="cannot_be_decided", former="withdrawn")
    of_paper = synthetic.paper_verdicts(paper_claims.read_lines()[0], **{"podm-falls-beyond-128": "does_not_hold"})
    found["experiments"] += of_paper["experiments"]
    write_rows(folder / "experiments.json", [found])
    synthetic.write_vtu(folder / "mesh.vtu", *synthetic.box_mesh(side=6))
    done = call("report", "--records", folder / "rows.jsonl", "--mesh", folder / "mesh.vtu", "--schedule",
                folder / "schedule.jsonl", "--verified", folder / "verified.json", "--experiment-verdicts",
                folder / "experiments.json", "-o", folder / "page.html")
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

    def answers(self, text=None):
        """Returns the four answers by name."""
        cards = re.findall(r'<section class="answer" id="(\w+)".*?</section>', text or self.text, re.DOTALL)
        texts = re.findall(r'<section class="answer".*?</section>', text or self.text, re.DOTALL)
        return dict(zip(cards, texts))

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
        self.assertIn("because of &lt;bad&gt;", self.text)
        self.assertNotIn("<script>alert", self.text)

    def test_four_answers_come_before_any_table_but_that_of_the_papers_claims(self):
        answers = self.answers()
        self.assertEqual(list(answers), ["works", "fast", "scales", "holds"])
        self.assertEqual(answers["holds"].count("<table"), 1)
        self.assertEqual(self.text[: self.text.index('aria-label="Sections"')].count("<table"), 1)
        for name in ("works", "fast", "scales"):
            self.assertIn('class="bars"', answers[name])
            self.assertIn("<p", answers[name])
        self.assertIn("2 cores, refining", answers["scales"])
        self.assertIn("2 cores, equation 1", answers["scales"])
        self.assertNotIn("256", answers["scales"], "simulated cores are none of this machine's")

    @slow
    def test_a_busy_machine_is_stated_before_any_answer_and_over_its_tables(self):
        self.assertNotIn("processors busy", self.text)
        busy = synthetic.ROW["environment"] | {"busy_elsewhere": 0.8}
        with tempfile.TemporaryDirectory() as folder:
            text = make_page(Path(folder), synthetic.row(environment=busy)).read_text()
        said = r'<p class="remark">(Other work kept 0.8 of 2 processors busy during 1 of \d+ runs)'
        first, *others = re.findall(said, text)
        self.assertLess(text.index(first), text.index('<section class="answer"'))
        self.assertTrue(others, "tables say it too")

    @slow
    def test_faults_of_others_are_not_counted_for_our_meshes(self):
        works = self.answers()["works"]
        self.assertIn("none refuted; trials: 1 failed", works)
        self.assertNotIn("tetgen", works)
        self.assertIn("its meshes miss delaunay", self.answers()["fast"])
        with tempfile.TemporaryDirectory() as folder:
            wrong = synthetic.row(verdicts={**synthetic.PASSED, "size": "fail"})
            works = self.answers(make_page(Path(folder), wrong).read_text())["works"]
        self.assertIn("No: 1 claims about our", works)
        self.assertIn("1 refuted", works)

    def test_what_differs_is_listed_and_what_is_open_is_folded(self):
        holds = self.answers()["holds"]
        shown, folded = re.sub(r"<details>.*?</details>", "", holds, flags=re.DOTALL), re.findall(
            r"<details>.*?</details>", holds, re.DOTALL)
        self.assertIn("weak_scaling: bad is so", shown)
        self.assertNotIn("open is so", shown)
        self.assertTrue(any("open is so" in one for one in folded))

    def test_a_claim_of_the_paper_that_is_contradicted_is_seen_at_first_sight(self):
        shown = re.sub(r"<details>.*?</details>", "", self.answers()["holds"], flags=re.DOTALL)
        self.assertEqual(len(re.findall(r'<th scope="row">', shown)), len(paper_claims.read_lines()[0]))
        line = re.search(r"<tr>(?:(?!</tr>).)*PODM falls behind.*?</tr>", shown).group()
        self.assertIn('simulated <span class="verdict contradicted">', line)
        self.assertIn("simulated: 12 agrees, 1 contradicted, 2 not judged", shown)

    @slow
    def test_verdicts_without_a_claim_that_the_paper_needs_name_it(self):
        rows = write_rows(self.path.parent / "few.jsonl", [synthetic.row()])
        write_rows(self.path.parent / "few.json", [synthetic.experiment_verdicts(good="holds")])
        done = call("report", "--records", rows, "--experiment-verdicts", self.path.parent / "few.json", "-o",
                    self.path.parent / "few.html")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("no claim of the verdicts is called &#x27;podm-keeps-its-rate&#x27;",
                      self.answers((self.path.parent / "few.html").read_text())["holds"])

    def test_without_rows_nothing_is_claimed(self):
        with tempfile.TemporaryDirectory() as folder:
            write_rows(Path(folder) / "rows.jsonl", [])
            done = call("report", "--records", Path(folder) / "rows.jsonl", "-o", Path(folder) / "page.html")
            self.assertEqual(done.returncode, 0, done.stderr)
            answers = self.answers((Path(folder) / "page.html").read_text())
        for name in ("works", "fast", "scales"):
            self.assertIn("Not known", answers[name])
        self.assertIn("podm-bench verdicts", answers["holds"])


if __name__ == "__main__":
    unittest.main()
