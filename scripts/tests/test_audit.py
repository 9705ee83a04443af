"""Tests that the audit passes a clean page and fails if a figure, table or number does not follow from its rows."""
import json
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

import paths  # noqa: F401
import synthetic
from docs import update
from docs.audit import audit, main, pages_of
from docs.canonical_hashes import SCHEMA
from docs.freshness import stale_folders
from docs.page import Page

QUERY = "<!--q 0.1.0/sizes/rows.jsonl; algorithm=podm; cells; median; /1e6 .2f-->"
OTHER_QUERY = "<!--q fast; refining_s; ratio algorithm=podm; .2f-->"
TOPOLOGY = ('<topology><info name="CPUVendor" value="GenuineIntel"/><info name="CPUFamilyNumber" value="6"/>'
            '<info name="CPUModelNumber" value="{model}"/><info name="CPUStepping" value="2"/></topology>')


def environment(topology, **changes):
    return {**synthetic.ROW["environment"], "topology_sha256": topology, **changes}


class Tree(unittest.TestCase):
    """A tree with two machines, four rows and a page."""

    def setUp(self):
        self.root = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.root)
        self.folder = self.root / "results/reference/0.1.0/sizes"
        self.folder.mkdir(parents=True)
        for topology, model in ("aaaa", 207), ("bbbb", 143):
            (self.folder / f"topology-{topology}.xml").write_text(TOPOLOGY.format(model=model))
        self.rows = [self.row("podm", 1, 24.0), self.row("podm", 2, 26.0),
                     self.row("pdr-podm", 1, 12.0), self.row("pdr-podm", 2, 13.0)]
        self.write_rows()

    def row(self, algorithm, repeat, refine_s, topology="aaaa"):
        return synthetic.row(algorithm, phases_s={"read": 1.0, "refine": refine_s}, key="c0ffee" * 4, repeat=repeat,
                             environment=environment(topology))

    def write_rows(self):
        (self.folder / "rows.jsonl").write_text("".join(json.dumps(row) + "\n" for row in self.rows))

    def faults(self, text):
        (self.root / "page.md").write_text(text)
        return audit(self.root).faults

    def assert_fault(self, text, *words, line=1):
        faults = self.faults(text)
        self.assertEqual(len(faults), 1, faults)
        for word in (f"page.md:{line}: ", *words):
            self.assertIn(word, faults[0])


class Figures(Tree):
    def test_a_figure_that_its_rows_give_passes(self):
        self.assertEqual(self.faults(f"Some **3.00**{QUERY} M cells, 256 cores.\n"), [])

    def test_a_wrong_digit_fails(self):
        self.assert_fault(f"Some\n\n3.01{QUERY} M cells.\n", "'3.01' is 3.00", line=3)

    def test_a_row_of_a_dirty_program_fails_whoever_is_dirty(self):
        build = {"sha256": "ab", "build": {"dirty": "true"}}
        for change in ({"programs": {"podm": build}}, {"programs": {"podm_verify": build}},
                       {"environment": environment("aaaa", sources={"commit": "1", "dirty": True})}):
            self.setUp()
            self.rows[0].update(change)
            self.write_rows()
            self.assert_fault(f"3.00{QUERY} M cells\n", "not committed", "c0ffee")

    def test_rows_of_two_machines_fail_only_where_the_machine_matters(self):
        self.rows[1] = self.row("podm", 2, 26.0, topology="bbbb")
        self.write_rows()
        self.assertEqual(self.faults(f"3.00{QUERY} M cells\n"), [])
        self.assert_fault(f"25.0{QUERY.replace('cells', 'refining_s').replace('/1e6 .2f', '.1f')} s\n", "two machines")

    def test_a_row_that_records_its_processor_needs_no_topology(self):
        identity = {"vendor": "GenuineIntel", "family": 6, "model": 207, "stepping": 2, "cache_bytes": {}}
        query = QUERY.replace("cells", "refining_s").replace("/1e6 .2f", ".1f")
        for row in self.rows:
            row["environment"] = environment("gone", identity=identity)
        self.write_rows()
        self.assertEqual(self.faults(f"25.0{query} s\n"), [])
        self.rows[0]["environment"] = environment("aaaa")
        self.write_rows()
        self.assertEqual(self.faults(f"25.0{query} s\n"), [], "the same processor, told in two ways")
        self.rows[1]["environment"]["identity"] = {**identity, "cache_bytes": {"L1": 32768}}
        self.write_rows()
        self.assert_fault(f"25.0{query} s\n", "two machines")

    def test_a_row_whose_topology_is_lost_gives_no_seconds(self):
        self.rows[0]["environment"]["topology_sha256"] = "gone"
        self.write_rows()
        self.assertEqual(self.faults(f"3.00{QUERY} M cells\n"), [])
        self.assert_fault(f"24.0{QUERY.replace('cells', 'refining_s').replace('/1e6 .2f', '.1f')} s\n", "no machine")

    def test_virtual_seconds_need_no_machine_and_wall_seconds_of_simulating_them_do(self):
        self.rows = [synthetic.row(executor="virtual", environment=environment("gone"), phases_s={"refine": 5.0})]
        self.write_rows()
        query = "<!--q 0.1.0/sizes/rows.jsonl;; {}; only; .1f-->"
        self.assertEqual(self.faults(f"5.0{query.format('refining_s')} s\n"), [])
        self.assert_fault(f"1234.5{query.format('process.wall_s')} s\n", "no machine")

    def test_ratios_are_within_rounds(self):
        alias = "<!--rows fast = 0.1.0/sizes/rows.jsonl; algorithm=pdr-podm-->\n"
        self.assertEqual(self.faults(f"{alias}{0.5:.2f}{OTHER_QUERY}\n"), [])
        self.rows[2]["repeat"] = 2
        self.write_rows()
        self.assert_fault(f"{alias}0.50{OTHER_QUERY}\n", "two rows of one side", line=2)

    def test_a_filter_that_matches_nothing_fails(self):
        self.assert_fault(f"3.00{QUERY.replace('=podm', '=podm2')} M cells\n", "no row matches")
        query = QUERY.replace("algorithm", "algorithmus").replace("median", "count")
        self.assert_fault(f"none{query}\n", "algorithmus")

    def test_words_counts_and_intervals(self):
        count = "<!--q 0.1.0/sizes/rows.jsonl; cells>1e6 status=ok; cells; count; words-->"
        low = QUERY.replace("cells; median; /1e6", "refining_s; low;")
        self.assertEqual(self.faults(f"Of four{count} rows the least is 24.00{low} s.\n"), [])
        self.assert_fault(f"Of five{count} rows.\n", "'five' is four")

    def test_warm_ups_never_count(self):
        self.rows.append({**self.row("podm", 3, 24.0), "warmup": True, "cells": 9e9})
        self.write_rows()
        self.assertEqual(self.faults(f"3.00{QUERY} M cells\n"), [])

    def test_queries_that_cannot_be_read_say_why(self):
        for query, word in (("x; y", "not a query"), ("0.1.0/gone.jsonl;; cells; median; d", "no such file"),
                            ("0.1.0/sizes/rows.jsonl;; cells; mode; d", "not a statistic"),
                            ("0.1.0/sizes/rows.jsonl;; __import__('os'); median; d", "not a path"),
                            ("0.1.0/sizes/rows.jsonl;; cells; median; /1e6", "not a format"),
                            ("0.1.0/sizes/rows.jsonl;; cells / (repeat - repeat); max; d", "division by zero"),
                            ("0.1.0/sizes/rows.jsonl;; status; median; d", "median of 'status'"),
                            ("somewhere;; cells; median; d", "neither files")):
            with self.subTest(query=query):
                self.assert_fault(f"3<!--q {query}-->\n", word)


class Numbers(Tree):
    def test_a_number_without_a_query_fails(self):
        for text in ("It takes 1.5 GB.", "Some 40<!-- so --> % more.", "| a |\n| --- |\n| 236<!-- so --> |",
                     "It is 3 times as fast.", "Some 40 % more.", "In 12,345 runs.",
                     "| a |\n| --- |\n| 236 |", "After 5 minutes."):
            with self.subTest(text=text):
                self.assertEqual(len(self.faults(text + "\n")), 1)

    def test_what_is_no_measurement_needs_nothing(self):
        text = ("# 1.5 GB\n\nSince 2015 `4.5 GB` of [a](b1.5) 2^31 voxels, version 0.1.0, Gmsh 4.1, C3D4,\n"
                "26 neighbours\n\n"
                "    podm --radius 4.5\n\n```\n12.5\n```\n\n1. First\n\n"
                "| commit |\n| --- |\n| 646bd55 |\n")
        self.assertEqual(self.faults(text), [])

    def test_marks_cover_a_number_a_line_a_block_a_section_and_a_page(self):
        for text, num_faults in (
                ("1.5<!--not measured--> and 2.5\n", 1), ("2.5 and 40 k<!--not measured--> and 3.5 mm\n", 2),
                ("1.5 and 2.5 <!--not measured: bounds-->\n\n3.5\n", 1),
                ("<!--not measured: bounds-->\n1.5\n2.5\n\n3.5\n", 1),
                ("# A\n\n<!--not measured below: bounds-->\n\n1.5\n\n## B\n\n2.5\n\n# C\n\n3.5\n", 1),
                ("<!--not measured page: printed-->\n\n1.5\n\n# A\n\n2.5\n", 0),
                ("<!--not measured-->\n1.5\n", 2), ("<!--not measured page-->\n1.5\n", 2)):
            with self.subTest(text=text):
                self.assertEqual(len(self.faults(text)), num_faults)

    def test_a_figure_within_a_mark_is_recomputed_all_the_same(self):
        self.assert_fault(f"<!--not measured page: printed-->\n\n3.01{QUERY}\n", "'3.01' is 3.00", line=3)


class Tables(Tree):
    def page(self):
        path = self.root / "page.md"
        path.write_text("<!-- table solvers 0.1.0/sizes -->\n<!-- end table -->\n")
        return path

    def setUp(self):
        super().setUp()
        self.rows = [synthetic.solved(200, programs={"podm": {"sha256": "ab", "version": "podm"}})]
        self.write_rows()

    def test_an_edited_table_fails_until_it_is_written_again(self):
        path = self.page()
        self.assertEqual(len(audit(self.root).faults), 1)
        self.assertEqual(update.main(["--root", str(self.root)]), 0)
        self.assertIn("| 200 |", path.read_text())
        self.assertEqual(audit(self.root).faults, [])
        path.write_text(path.read_text().replace("| 200 |", "| 199 |"))
        self.assertEqual(len(audit(self.root).faults), 1)

    def test_a_table_over_a_row_of_a_dirty_program_fails(self):
        self.page()
        update.main(["--root", str(self.root)])
        self.rows[0]["programs"]["podm"]["build"] = {"dirty": "true"}
        self.write_rows()
        self.assertIn("not committed", audit(self.root).faults[0])

    def test_a_table_of_an_unknown_name_or_without_its_end_fails(self):
        self.assert_fault("<!-- table no -->\n<!-- end table -->\n", "no table 'no'", line=2)
        self.assert_fault("<!-- table solvers 0.1.0/sizes -->\n", "without its other end")


class Updating(Tree):
    def test_figures_are_written_only_when_asked_for(self):
        text = f"**3.01**{QUERY} and 4.5<!--not measured-->\n"
        path = self.root / "page.md"
        path.write_text(text)
        self.assertEqual((update.main(["--root", str(self.root)]), path.read_text()), (0, text))
        self.assertEqual(update.main(["--root", str(self.root), "--figures"]), 0)
        self.assertEqual(path.read_text(), text.replace("3.01", "3.00"))

    def test_what_cannot_be_computed_stays(self):
        path = self.root / "page.md"
        path.write_text(f"3.01{QUERY.replace('rows.jsonl', 'gone.jsonl')}\n")
        self.assertEqual(update.main(["--root", str(self.root), "--figures"]), 1)
        self.assertIn("3.01", path.read_text())


class Freshness(Tree):
    def hashes(self, path, value):
        path.write_text(json.dumps({"schema": SCHEMA, "meshes": {"ball": {"arguments": [], "mesh_sha256": value}}}))

    def judged(self):
        warnings, faults = stale_folders(self.root, {Path("0.1.0/sizes")})
        return len(warnings), len(faults)

    def git(self, *arguments):
        subprocess.run(["git", "-C", self.root, "-c", "user.name=a", "-c", "user.email=a@b", *arguments], check=True,
                       capture_output=True)

    def test_stale_rows_are_a_warning_before_the_release_and_a_fault_after_it(self):
        self.assertEqual(self.judged(), (1, 0))
        self.hashes(self.root / "results/reference/canonical_hashes.json", "new")
        self.hashes(self.folder / "canonical_hashes.json", "old")
        self.assertEqual(self.judged(), (1, 0))
        self.git("init", "-q")
        self.git("commit", "-q", "--allow-empty", "-m", "a")
        self.git("tag", "0.1.0")
        self.assertEqual(self.judged(), (0, 1))
        self.hashes(self.folder / "canonical_hashes.json", "new")
        self.assertEqual(self.judged(), (0, 0))

    def test_the_exit_code_reports_it(self):
        (self.root / "page.md").write_text(f"3.00{QUERY}\n")
        self.assertEqual(main(["--root", str(self.root)]), 0)
        (self.root / "page.md").write_text(f"3.01{QUERY}\n")
        self.assertEqual(main(["--root", str(self.root)]), 1)
        self.assertEqual(main(["--root", str(self.root / "gone")]), 2)


class ThisTree(unittest.TestCase):
    """Tests the present documentation: the audit finds every figure that is changed."""

    def test_each_figure_with_its_first_digit_changed_is_found(self):
        root = paths.SCRIPTS.parent
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder)
            (copy / "results").mkdir()
            for name in ("reference", "paper"):
                (copy / "results" / name).symlink_to(root / "results" / name)
            num_figures = 0
            for path in pages_of(root):
                page = Page(path.read_text())
                numbers = [one for one in page.figures if one.text.strip("+-")[0].isdigit()]
                text = page.text
                for figure in reversed(numbers):
                    first = next(place for place in range(figure.start, figure.end) if text[place].isdigit())
                    text = text[:first] + str((int(text[first]) + 1) % 10) + text[first + 1:]
                (copy / path.name).write_text(text)
                faults = [one for one in audit(copy).faults if "by its rows" in one]
                self.assertEqual(len(faults), len(numbers), path)
                num_figures += len(numbers)
                (copy / path.name).unlink()
            self.assertGreater(num_figures, 50)


if __name__ == "__main__":
    unittest.main()
