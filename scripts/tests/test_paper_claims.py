"""Tests the table of the paper's claims: verdicts come only from podm-bench, figures only from rows; no claim is
lost."""
import csv
import json
import stat
import subprocess
import tempfile
import tomllib
import unittest
from pathlib import Path

import paths
import synthetic
from figures import paper, paper_claims, paper_figures
from figures.experiment_verdicts import SCHEMA, read_experiment_verdicts
from figures.load import load
from test_figures import frame_of

LINES, UNJUDGED = paper_claims.read_lines()
EXPERIMENTS = paths.SCRIPTS.parent / "experiments"
IDS = ["podm-weak-scaling", "pdr-podm-weak-scaling", "podm-falls-behind", "crossover", "best-speedup",
       "parts-of-the-time", "hops", "latencies", "initial-mesh", "buffer-zones", "quality", "cost-of-distributing",
       "threshold", "over-decomposition", "single-core"]


def line(measured, simulated=None, says="it is so"):
    return {"id": "synthetic", "says": says, "place": "Table 1", "measured": measured,
            "simulated": simulated or {"reason": "not simulated"}}


def judged(measured, simulated=None, frame=None, **verdicts):
    """Returns the row of one line, by synthetic verdicts. Claims are measured, or simulated if their name begins with
    "sim"."""
    claims = [{"name": name, "statement": "so", "basis": "simulated" if name.startswith("sim") else "measured",
               "verdict": verdict, "reason": f"why {name}", "value": 1.5} for name, verdict in verdicts.items()]
    found = {"experiments": [{"experiment": "synthetic", "claims": claims}]}
    (row,) = paper_claims.rows(found, frame_of([]) if frame is None else frame, [line(measured, simulated)])
    return row


class Verdicts(unittest.TestCase):
    def test_each_follows_from_those_of_its_claims(self):
        for verdicts, expected in (
            (["holds"], "agrees"), (["holds", "holds"], "agrees"), (["holds", "withdrawn"], "agrees"),
            (["holds", "cannot_be_decided"], "agrees in part"),
            (["does_not_hold"], "contradicted"), (["does_not_hold", "cannot_be_decided"], "contradicted"),
            (["does_not_hold", "not_resolved"], "contradicted"), (["holds", "does_not_hold"], "contradicted in part"),
            (["not_resolved"], "not resolved"), (["holds", "not_resolved"], "not resolved"),
            (["not_resolved", "cannot_be_decided"], "not resolved"),
            (["cannot_be_decided"], "not judged"), (["withdrawn"], "not judged"),
        ):
            with self.subTest(verdicts=verdicts):
                named = {f"claim-{number}": verdict for number, verdict in enumerate(verdicts)}
                row = judged({"claims": list(named)}, **named)
                self.assertEqual(row["measured"]["verdict"], expected)
                self.assertEqual(row["simulated"], {"text": "not simulated", "verdict": "not judged", "claims": {}})

    def test_measured_and_simulated_ones_never_mix(self):
        row = judged({"claims": ["one"]}, {"claims": ["sim"]}, one="holds", sim="does_not_hold")
        self.assertEqual(paper_claims.verdict_text(row), "measured: agrees; simulated: contradicted")
        for measured, simulated, verdicts in (({"claims": ["sim"]}, None, {"sim": "holds"}),
                                              ({"claims": ["one"]}, {"claims": ["one"]}, {"one": "holds"})):
            with self.assertRaisesRegex(paper_claims.PaperClaimsError, "stands as"):
                judged(measured, simulated, **verdicts)

    def test_a_withdrawn_claim_is_known_and_judges_nothing(self):
        gone = {"name": "gone", "statement": "so", "verdict": "withdrawn", "reason": "another asks more"}
        found = {"experiments": [{"experiment": "synthetic", "claims": [], "withdrawn": [gone]}]}
        (row,) = paper_claims.rows(found, frame_of([]), [line({"claims": ["gone"]})])
        self.assertEqual((row["measured"]["verdict"], row["measured"]["text"]), ("not judged", "another asks more"))

    def test_a_contradiction_shows_as_one(self):
        row = judged({"claims": ["one", "two"]}, one="holds", two="does_not_hold")
        self.assertEqual(paper_claims.verdict_text(row), "measured: contradicted in part, 1 of 2 claims hold")
        self.assertIn("| measured: **contradicted** in part, 1 of 2 claims hold |",
                      paper_claims.markdown_lines([row])[2])

    def test_what_nothing_judges_has_its_reason(self):
        row = judged({"claims": ["one"], "shows": ["{speedups podm}"]}, one="cannot_be_decided")
        self.assertEqual((row["measured"]["text"], paper_claims.verdict_text(row)), ("why one", "not judged"))

    def test_a_claim_that_is_not_there_is_an_error(self):
        with self.assertRaisesRegex(paper_claims.PaperClaimsError,
                                    "synthetic: no claim of the verdicts is called 'two'"):
            judged({"claims": ["two"]}, one="holds")

    def test_a_name_that_two_claims_have_is_an_error(self):
        claims = [{"name": "one", "basis": "measured", "verdict": "holds", "reason": "", "value": None}]
        found = {"experiments": [{"experiment": name, "claims": claims} for name in ("first", "second")]}
        with self.assertRaisesRegex(paper_claims.PaperClaimsError, "2 claims are called 'one'"):
            paper_claims.rows(found, frame_of([]), [line({"claims": ["one"]})])


class Lines(unittest.TestCase):
    """Tests the present results/paper/claims.toml."""

    def test_are_those_that_are_asked_for(self):
        self.assertEqual([one["id"] for one in LINES], IDS)

    def test_hold_no_verdict_and_name_claims_that_there_are(self):
        of_experiments = {}
        for path in sorted(EXPERIMENTS.glob("*.toml")):
            for claim in tomllib.loads(path.read_text())["claims"]:
                of_experiments.setdefault(claim["name"], []).append(claim)
        for one in LINES:
            self.assertEqual(set(one), {"id", "says", "place", "measured", "simulated"})
            for side in ("measured", "simulated"):
                self.assertLessEqual(set(one[side]), {"claims", "shows"} if "claims" in one[side] else {"reason"})
                for name in one[side].get("claims", []):
                    (claim,) = of_experiments[name]
                    self.assertIn(claim["basis"], (side, "any"), name)

    def test_give_published_values_as_they_are_printed(self):
        text = {one["id"]: paper_claims.published(one["says"]) for one in LINES}
        with open(paper.FOLDER / "table1.csv", encoding="utf-8") as file:
            last = list(csv.DictReader(file))[-1]
        self.assertIn(f"{last['pdr_podm_speedup']} times one core on 256", text["best-speedup"])
        self.assertIn("O(1500) from another blade's", text["latencies"])
        for one in [*LINES, *UNJUDGED]:
            self.assertNotIn("{", paper_claims.published(one["says"]))

    def test_a_line_with_claims_and_a_reason_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "claims.toml"
            path.write_text('unjudged = []\n[[claims]]\nid = "both"\n[claims.measured]\nclaims = []\nreason = "none"\n')
            with self.assertRaisesRegex(paper_claims.PaperClaimsError, "both: measured needs either claims or"):
                paper_claims.read_lines(path)


def simulated(**changes):
    """Yields two sizes. On the larger size PDR.PODM is twice as fast, and ahead from 256 cores on."""
    def speedup_of(factor):
        return lambda algorithm, cores: factor * cores / 4 if algorithm == "pdr-podm" else 30

    for size, factor in ((40_000, 1), (160_000, 2)):
        yield from synthetic.simulated_size(size, speedup_of(factor), **changes)


class Figures(unittest.TestCase):
    def ours(self, rows, basis="simulated", **values):
        return paper_figures.Ours(frame_of(rows), basis, values)

    def figure(self, query, rows, basis="simulated"):
        text = paper_figures.figure(query, self.ours(rows, basis))
        return text and text.replace("\N{NO-BREAK SPACE}", " ")

    def test_sizes_stand_side_by_side_and_are_named(self):
        rows = list(simulated())
        self.assertEqual(self.figure("speedups pdr-podm 256", rows), "64 (40 k), 128 (160 k) on 256 cores")
        self.assertEqual(self.figure("speedups podm 32 256", rows), "30, 30 (40 k); 30, 30 (160 k) on 32, 256 cores")
        fewer = [one for one in rows if one["cells"] != 40_000 * 32]
        self.assertEqual(self.figure("speedups pdr-podm 32 256", fewer),
                         "-, 64 (40 k); 16, 128 (160 k) on 32, 256 cores")
        self.assertIsNone(self.figure("speedups pdr-podm 64", rows))

    def test_a_basis_never_shows_rows_of_the_other(self):
        measured = [synthetic.row(cores=cores, experiment="weak_scaling") for cores in (1, 2)]
        self.assertEqual(self.figure("speedups podm", [*simulated(), *measured], "measured"), "2 (3 M) on 2 cores")
        self.assertIsNone(self.figure("speedups podm", simulated(), "measured"))
        self.assertIsNone(self.figure("speedups podm", measured))

    def test_the_crossover_is_stated_for_each_size(self):
        self.assertEqual(self.figure("crossover", simulated()),
                         "between 32 and 256 (40 k), 32 and 256 (160 k) cores")

    def test_accesses_and_parts_of_time_are_those_of_the_rows(self):
        rows = list(synthetic.with_losses(simulated(zero_hops=0.975), compute=0.5, between_attempts=0.05, locks=0.025,
                                          begging=0.2, contention=0.225))
        self.assertEqual(self.figure("zero_hops 32 256", rows),
                         "97.50 %, 97.50 % (40 k); 97.50 %, 97.50 % (160 k) on 32, 256 cores")
        self.assertEqual(self.figure("distributing 32", rows), "7.5 % (40 k), 7.5 % (160 k) on 32 cores")
        self.assertEqual(self.figure("undistributing_ratio 256", rows), "0.47 (40 k), 0.23 (160 k) on 256 cores")
        self.assertEqual(self.figure("meshing_ratio 256", rows), "0.47 (40 k), 0.23 (160 k) on 256 cores")
        self.assertEqual(self.figure("part refine 256", rows), "100.0 % (40 k), 100.0 % (160 k) on 256 cores")

    def test_facts_of_meshes_count_failed_ones_too(self):
        good, bad = (synthetic.row(experiment="quality", cells=10_000, asked={"fidelity": True},
                                   topology={"labels": 3, "components_as_image": kept, "euler_as_image": 3},
                                   verdicts={**synthetic.PASSED, "fidelity": verdict})
                     for kept, verdict in ((3, "pass"), (2, "fail")))
        rows = [good, bad, synthetic.row(experiment="quality", verdicts=synthetic.PASSED)]
        self.assertEqual(self.figure("proofs fidelity", rows, "measured"),
                         "fidelity proved of 1 of 2 that were checked")
        self.assertEqual(self.figure("topology", rows, "measured"),
                         "5 of 6 labels have the image's components, 6 its Euler number")
        self.assertIn("3 meshes on 1 core (3 M): ratios up to 1.92", self.figure("shapes", rows, "measured"))

    def test_every_query_of_the_lines_is_one(self):
        ours = {side: self.ours([], side) for side in ("measured", "simulated")}
        for one in LINES:
            for side, own in ours.items():
                for part in one[side].get("shows", []):
                    for query in paper_claims.PLACEHOLDER.findall(part):
                        self.assertIsNone(paper_figures.figure(query, own), "no rows, no figure")

    def test_queries_that_are_none_are_refused(self):
        for query, words in (("beauty", "no figure is called 'beauty'"), ("crossover 32", "'crossover 32': crossover")):
            with self.assertRaisesRegex(paper_figures.QueryError, words):
                self.figure(query, [])


class Table(unittest.TestCase):
    def test_a_folder_and_its_verdicts_make_it(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            (folder / "weak.jsonl").write_text("".join(json.dumps(one) + "\n" for one in simulated()))
            (folder / "verdicts.json").write_text(json.dumps(synthetic.paper_verdicts(LINES)))
            found = read_experiment_verdicts(folder / "verdicts.json")
            text = paper_claims.markdown_lines(paper_claims.rows(found, load([folder]).frame))
        self.assertEqual([one.count(" | ") for one in text[: 2 + len(LINES)]], [4] * (2 + len(LINES)))
        self.assertTrue(any("64 (40 k), 128 (160 k) on 256 cores; not fitted" in one for one in text))
        self.assertIn("Not judged: threads of a computing node", text[3 + len(LINES)])
        self.assertLessEqual(max(map(len, text[3 + len(LINES):])), 120)
        self.assertFalse(any("\N{NO-BREAK SPACE}" in one for one in text))


BENCH = """#!/usr/bin/python3
import json, pathlib, sys
folder, file, experiment = sys.argv[3], sys.argv[5], pathlib.Path(sys.argv[6]).stem
rows = pathlib.Path(folder, experiment + ".jsonl")
verdict = rows.read_text().strip() if rows.exists() else "cannot_be_decided"
claim = {"name": "one", "basis": "measured", "verdict": verdict}
pathlib.Path(file).write_text(json.dumps({"schema": "SCHEMA", "experiments": [
    {"experiment": experiment, "claims": [claim]}]}))
""".replace("SCHEMA", SCHEMA)


class ReferenceVerdicts(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.bench = self.folder / "podm-bench"
        self.bench.write_text(BENCH)
        self.bench.chmod(self.bench.stat().st_mode | stat.S_IXUSR)

    def call(self, folder):
        return subprocess.run([paths.SCRIPTS / "reference_verdicts", folder, "--bench", self.bench],
                              capture_output=True, text=True)

    def test_each_experiment_is_judged_by_the_folders_that_have_its_rows(self):
        rows = self.folder / "rows"
        for inside, name, verdict in (("a", "weak_scaling", "holds"), ("b", "sizes", "holds"),
                                      ("c", "sizes", "does_not_hold")):
            (rows / inside).mkdir(parents=True)
            (rows / inside / f"{name}.jsonl").write_text(verdict)
        done = self.call(rows)
        self.assertEqual(done.returncode, 0, done.stderr)
        found = [(one["experiment"], one["rows"], one["claims"][0]["verdict"])
                 for one in json.loads((rows / "verdicts.json").read_text())["experiments"]]
        self.assertEqual({name for name, *_ in found}, {path.stem for path in EXPERIMENTS.glob("*.toml")})
        for one in (("weak_scaling", "a", "holds"), ("sizes", "b", "holds"), ("sizes", "c", "does_not_hold"),
                    ("quality", ".", "cannot_be_decided")):
            self.assertIn(one, found)

    def test_what_cannot_be_judged_is_named(self):
        self.bench.write_text("#!/bin/sh\necho 'rows.jsonl:3: broken' >&2; exit 2\n")
        for folder, words in ((self.folder / "none", "none: no such folder"), (self.folder, "rows.jsonl:3: broken")):
            done = self.call(folder)
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)
            self.assertFalse((folder / "verdicts.json").exists())


if __name__ == "__main__":
    unittest.main()
