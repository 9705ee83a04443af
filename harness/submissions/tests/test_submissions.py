"""Tests of podm-bench pack and check, with the programs that PODM_BENCH, PODM and PODM_VERIFIER name.

One run of a small experiment is packed and is VALID. Each planted fault makes it NOT VALID with the right reason.
"""

import gzip
import hashlib
import io
import json
import os
import pathlib
import shutil
import subprocess
import tarfile
import tempfile
import unittest

from slow import slow

EXPERIMENT = """
title = "T"
claim = "C"
[inputs.torus]
image = "phantom:torus@24"
[[trials]]
name = "one"
input = "torus"
target_elements = 3_000
repeats = 2
[[trials]]
name = "two"
input = "torus"
radius_mm = 6
threads = 2
oversubscribe = true
[[trials]]
name = "stranger"
input = "torus"
radius_mm = 6
mesher = "stranger"
[[claims]]
name = "all-pass"
statement = "Every trial passes."
basis = "any"
kind = "share"
value = "passed"
at_least = 1.0
"""

# A mesher of another project, by the contract of harness/peers/README.md.
PEER = """#!/bin/sh
[ "$1" = --version ] && { echo 'Stranger 1.0, BSD-3-Clause'; exit 0; }
while [ $# -gt 0 ]; do
  case $1 in --podm) podm=$2;; --image) image=$2;; --output) output=$2;; --radius) radius=$2;; esac
  shift
done
"$podm" mesh "$image" --radius "$radius" -o "$output/mesh.vtu" --record "$output/own.jsonl" --quiet
/usr/bin/python3 -c 'import json, sys
own = json.load(open(sys.argv[1] + "/own.jsonl"))
print(json.dumps({"mesh": "mesh.vtu", "cells": own["cells"], "vertices": own["vertices"], "threads": own["threads"],
                  "phases_s": {"refine": own["phases_s"]["refine"]}, "promises": ["structure"]}))' "$output" \\
  > "$output/record.jsonl"
"""


def run(arguments, **options):
    return subprocess.run([os.environ["PODM_BENCH"], *map(str, arguments)], check=False, capture_output=True, text=True,
                          timeout=300, **options)


def files_of(archive):
    with tarfile.open(archive) as opened:
        return {member.name: opened.extractfile(member).read() for member in opened}


def write_archive(path, files):
    with tarfile.open(path, "w:gz") as opened:
        for name, data in files.items():
            member = tarfile.TarInfo(name)
            member.size = len(data)
            opened.addfile(member, io.BytesIO(data))


def with_new_hashes(files):
    """As a forger does: the manifest gets the hashes of the edited files."""
    manifest = json.loads(files["manifest.json"])
    manifest["files"] = {name: hashlib.sha256(data).hexdigest() for name, data in files.items()
                         if name != "manifest.json"}
    return {**files, "manifest.json": json.dumps(manifest).encode()}


def edit_rows(path, edit):
    """Changes each row of a file of JSON lines in place."""
    rows = [json.loads(line) for line in path.read_text().splitlines()]
    for row in rows:
        edit(row)
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))


def clean(row):
    """The tree of a developer may be dirty; this test is about other faults."""
    for program in row["programs"].values():
        if "build" in program:
            program["build"]["dirty"] = "false"
    if isinstance(row["environment"]["sources"], dict):
        row["environment"]["sources"]["dirty"] = False


class Submissions(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.suite = cls.folder / "suite"
        cls.results = cls.folder / "results"
        cls.peers = cls.folder / "peers"
        (cls.peers / "stranger").mkdir(parents=True)
        cls.suite.mkdir()
        (cls.suite / "exp.toml").write_text(EXPERIMENT)
        (cls.peers / "stranger/run").write_text(PEER)
        (cls.peers / "stranger/run").chmod(0o700)
        cls.programs = ["--podm", os.environ["PODM"], "--verifier", os.environ["PODM_VERIFIER"], "--peers", cls.peers]
        made = run(["run", cls.suite / "exp.toml", "--results", cls.results, *cls.programs])
        assert made.returncode == 0, made.stdout + made.stderr
        edit_rows(cls.results / "exp.jsonl", clean)
        cls.archive = cls.folder / "whole.tar.gz"
        packed = cls.pack(cls.archive)
        assert packed.returncode == 0, packed.stderr
        cls.files = files_of(cls.archive)

    @classmethod
    def pack(cls, archive, *more, results=None):
        return run(["pack", "-o", archive, "--submitter", "A. Stranger", "--results", results or cls.results,
                    "--experiments", cls.suite, *more])

    def check(self, files, sample=0, more=()):
        """Returns the answer of podm-bench check on an archive of these files."""
        path = self.folder / "edited.tar.gz"
        write_archive(path, files)
        return run(["check", path, "--experiments", self.suite, "--sample", sample, "--sample-seed", 1, *self.programs,
                    *more])

    def rows(self):
        return [json.loads(line) for line in self.files["rows/exp.jsonl"].splitlines()]

    def edited(self, edit, trial="one", log_too=False):
        """Returns the files with the first row of a trial edited, and its log likewise on request."""
        rows = self.rows()
        row = next(row for row in rows if row["trial"] == trial)
        edit(row)
        files = {**self.files, "rows/exp.jsonl": "".join(json.dumps(row) + "\n" for row in rows).encode()}
        if log_too:
            name = f"logs/{row['key']}/record.jsonl"
            record = json.loads(files[name])
            edit(record)
            files[name] = json.dumps(record).encode()
        return with_new_hashes(files)

    def assert_fault(self, answer, *words):
        self.assertEqual(answer.returncode, 1, answer.stdout + answer.stderr)
        self.assertRegex(answer.stdout.splitlines()[-1], "^NOT VALID: ")
        for word in words:
            self.assertIn(word, answer.stdout)

    def test_a_pack_of_a_run_is_valid_and_its_meshes_are_made_again(self):
        answer = self.check(self.files, sample=3)
        self.assertEqual(answer.returncode, 0, answer.stdout + answer.stderr)
        self.assertEqual(answer.stdout.splitlines()[-1],
                         "VALID: closed division, 4 rows of 1 experiment on 1 machine")
        self.assertRegex(answer.stdout, r"meshed again: exp: one, repeat 1: the same mesh, \d+ of \d+ claims pass, "
                                        "equal to its replay")
        self.assertRegex(answer.stdout, r"meshed again: exp: two, repeat 1: \d+ cells, ")
        self.assertRegex(answer.stdout, r"meshed again: exp: stranger, repeat 1: \d+ cells, ")

    def test_an_archive_holds_rows_logs_hashes_and_the_machine(self):
        keys = [row["key"] for row in self.rows()]
        logs = ("record.jsonl", "verification.json", "stderr.txt")
        self.assertEqual({name for name in self.files if name.startswith("logs/")},
                         {f"logs/{key}/{log}" for key in keys for log in logs})
        self.assertTrue(any(name.startswith("topology-") for name in self.files))
        manifest = json.loads(self.files["manifest.json"])
        self.assertEqual((manifest["schema"], manifest["division"], manifest["submitter"]),
                         ("podm-submission/1", "closed", "A. Stranger"))
        self.assertEqual(set(manifest["files"]), set(self.files) - {"manifest.json"})

    def test_packing_the_same_rows_gives_the_same_files(self):
        self.pack(self.folder / "again.tar.gz")
        again = files_of(self.folder / "again.tar.gz")
        self.assertEqual({name: data for name, data in again.items() if name != "manifest.json"},
                         {name: data for name, data in self.files.items() if name != "manifest.json"})

    def test_edited_seconds_break_the_clock_and_differ_from_the_log(self):
        def faster(row):
            row["phases_s"]["refine"] /= 2

        self.assert_fault(self.check(self.edited(faster)), "clock: exp: one", "cells_per_second", "logs: exp: one",
                          "phases_s is")

        def faster_with_rates(row):
            faster(row)
            seconds = sum(s for phase, s in row["phases_s"].items() if phase not in ("measure", "write"))
            row["cells_per_second"] = row["cells"] / seconds
            row["refine_cells_per_second"] = row["cells"] / row["phases_s"]["refine"]

        self.assert_fault(self.check(self.edited(faster_with_rates)), "phases_s is")

        def slower_than_the_process(row):
            row["phases_s"]["write"] = row.get("process", {}).get("wall_s", 99.0) * 2 + 1

        self.assert_fault(self.check(self.edited(slower_than_the_process, log_too=False)), "its phases take")

    def test_edited_cells_break_the_counts_and_differ_from_the_log(self):
        self.assert_fault(self.check(self.edited(lambda row: row.update(cells=row["cells"] + 1000))),
                          "its labels have", "logs: exp: one, repeat 1: cells is")

    def test_another_hash_of_a_mesh_differs_from_the_log_the_repeat_and_the_mesh_made_again(self):
        def other(row):
            row["mesh_sha256"] = "ab" * 32

        self.assert_fault(self.check(self.edited(other)), "logs: exp: one, repeat 1: mesh_sha256 is")
        self.assert_fault(self.check(self.edited(other, log_too=True)),
                          "another mesh than a row of the same options")
        rows = [row for row in self.rows() if row["trial"] == "one"]
        files = self.files
        for row in rows:  # a forger edits both repeats and their logs
            name = f"logs/{row['key']}/record.jsonl"
            record = json.loads(files[name])
            other(record)
            files = {**files, name: json.dumps(record).encode()}
            text = files["rows/exp.jsonl"].decode().replace(row["mesh_sha256"], "ab" * 32)
            files["rows/exp.jsonl"] = text.encode()
        files = with_new_hashes(files)
        self.assertEqual(self.check(files).returncode, 0, "only the mesh itself refutes it")
        self.assert_fault(self.check(files, sample=3), "meshed again: exp: one, repeat 1: the mesh here has the hash")

    def test_cells_that_another_run_does_not_make_are_found(self):
        def more(row):
            factor = 2 if "phases_s" in row else 1
            row["cells"] *= factor
            for key in ("cells_per_second", "refine_cells_per_second"):
                row[key] *= factor
            row["labels"] = [{**label, "cells": label["cells"] * factor} for label in row["labels"]]
            if "dihedral_deg" in row:
                row["dihedral_deg"]["counts"] = [count * factor for count in row["dihedral_deg"]["counts"]]

        files = self.edited(more, "two", log_too=True)
        self.assertEqual(self.check(files).returncode, 0)
        self.assert_fault(self.check(files, sample=3), "cells here, not about")

    def test_a_missing_log_is_found(self):
        key = self.rows()[0]["key"]
        for log, words in (("record.jsonl", "the log of the mesher is missing"),
                           ("verification.json", "the log of podm-verify is missing")):
            files = {name: data for name, data in self.files.items() if name != f"logs/{key}/{log}"}
            self.assert_fault(self.check(files), f"files: logs/{key}/{log}: missing")
            self.assert_fault(self.check(with_new_hashes(files)), words)

    def test_an_edited_verdict_differs_from_the_log(self):
        files = self.edited(lambda row: row["verdicts"].update(delaunay="fail"))
        self.assert_fault(self.check(files), "delaunay is fail, in its log pass", "ok in spite of delaunay: fail")

    def test_a_claim_that_is_left_out_of_row_and_log_is_found(self):
        files = self.edited(lambda row: row["verdicts"].pop("delaunay"))
        key = next(row["key"] for row in self.rows() if row["trial"] == "one")
        name = f"logs/{key}/verification.json"
        report = json.loads(files[name])
        del report["claims"]["delaunay"]
        files = with_new_hashes({**files, name: json.dumps(report).encode()})
        self.assert_fault(self.check(files), "ok in spite of no verdict of podm-verify on delaunay")

    def test_a_row_of_podm_promises_what_it_is_judged_by(self):
        def promise_nothing(row):
            row["promises"] = []
            row["verdicts"]["delaunay"] = "fail"

        self.assert_fault(self.check(self.edited(promise_nothing)), "ok in spite of delaunay: fail")

    def test_dirty_programs_are_refused(self):
        for program in ("podm", "podm_verify"):
            def soil(row):
                row["programs"][program]["build"]["dirty"] = "true"

            self.assert_fault(self.check(self.edited(soil)), "is not of clean sources: dirty is 'true'")

        def soil_bench(row):
            row["environment"]["sources"] = {"commit": "0" * 40, "dirty": True}

        self.assert_fault(self.check(self.edited(soil_bench)), "podm-bench is not of clean sources")

    def test_rows_of_two_machines_are_refused(self):
        def move(row):
            row["environment"]["identity"]["model"] += 1

        self.assert_fault(self.check(self.edited(move)), "of another machine than", "its key is not that of")

    def test_a_row_that_does_not_name_its_machine_is_refused(self):
        self.assert_fault(self.check(self.edited(lambda row: row["environment"].pop("identity"))),
                          "it does not name its machine")
        files = {name: data for name, data in self.files.items() if not name.startswith("topology-")}
        self.assert_fault(self.check(with_new_hashes(files)), ".xml is missing")

    def test_another_schema_is_refused(self):
        self.assert_fault(self.check(self.edited(lambda row: row.update(schema=3))),
                          "schema: rows/exp.jsonl:", "not a row of schema 4")
        self.assert_fault(self.check(self.edited(lambda row: row.pop("process"))), "has no key 'process'")
        self.assert_fault(self.check(self.edited(lambda row: row.update(experiment="other"))),
                          "schema: rows/exp.jsonl:", "a row of the experiment 'other'")
        deep = self.files["rows/exp.jsonl"] + b'{"schema": 4, "asked": ' + b"[" * 100000 + b"]" * 100000 + b"}\n"
        self.assert_fault(self.check(with_new_hashes({**self.files, "rows/exp.jsonl": deep})), "not a row of schema 4")

    def test_an_altered_hash_of_an_input_is_found(self):
        def alter(row):
            row["input"]["sha256"] = "cd" * 32

        self.assert_fault(self.check(self.edited(alter)), "its key is not that of", "the hash of its input is",
                          "input phantom:torus@24 has another hash in another row")

    def test_altered_files_differ_from_the_manifest(self):
        files = {**self.files, "rows/exp.jsonl": self.files["rows/exp.jsonl"] + b"\n"}
        self.assert_fault(self.check(files), "files: rows/exp.jsonl: its hash is not that of the manifest")
        self.assert_fault(self.check({**self.files, "more.txt": b"more"}), "the manifest does not list it")
        for name in "more.txt", "topology-more.xml":
            self.assert_fault(self.check(with_new_hashes({**self.files, name: b"more"})), f"{name}: no row needs it")

    def test_closed_rows_have_inputs_and_options_of_the_suite(self):
        for edit, trial in ((lambda row: row["asked"].update(seed=7), "one"),
                            (lambda row: row["asked"].update(radius_mm=7.0), "stranger"),
                            (lambda row: row["input"].update(name="phantom:torus@25"), "two")):
            self.assert_fault(self.check(self.edited(edit, trial)), f"division: exp: {trial}", "no trial of the")

        def far(row):
            row["resolved"]["cells"] *= 2

        self.assert_fault(self.check(self.edited(far)), "its radius gave")

    def test_open_submissions_declare_what_they_did(self):
        declaration = self.folder / "declaration.md"
        declaration.write_text("Made with another clock.\n")
        opened = self.folder / "open.tar.gz"
        self.assertEqual(self.pack(opened, "--division", "open").returncode, 1)
        self.assertFalse(opened.exists())
        packed = self.pack(opened, "--division", "open", "--declaration", declaration)
        self.assertEqual(packed.returncode, 0, packed.stderr)
        answer = run(["check", opened, "--experiments", self.folder / "peers", "--sample", 3, *self.programs])
        self.assertEqual(answer.returncode, 0, answer.stdout + answer.stderr)
        self.assertIn("meshed again: exp: stranger, repeat 1", answer.stdout)

    def test_options_that_name_files_or_programs_are_never_run(self):
        manifest = json.loads(self.files["manifest.json"])
        manifest.update(division="open", declaration="mine")
        for options in ({"output": "/tmp/evil"}, {"size_image": "/etc/passwd"}, {"algorithm": "--record"},
                        {"mesher": "../../bin/evil"}, {"radius_mm": "-1"}):
            files = self.edited(lambda row, more=options: row["asked"].update(more), "two")
            files["manifest.json"] = json.dumps({**json.loads(files["manifest.json"]), **{
                key: manifest[key] for key in ("division", "declaration")}}).encode()
            answer = self.check(files, sample=3)
            self.assertEqual(answer.returncode, 1)
            self.assertNotIn("meshed again: exp: two", answer.stdout)

    def test_pack_refuses_rows_that_break_a_rule_and_writes_nothing(self):
        results = self.folder / "soiled"
        shutil.copytree(self.results, results)
        edit_rows(results / "exp.jsonl", lambda row: row["programs"]["podm"]["build"].update(dirty="true"))
        packed = self.pack(self.folder / "soiled.tar.gz", results=results)
        self.assertEqual(packed.returncode, 1)
        self.assertIn("is not of clean sources", packed.stderr)
        self.assertFalse((self.folder / "soiled.tar.gz").exists())
        for results, *bad in ((self.folder / "none",), (self.results, "--division", "ajar"),
                              (self.results, "--declaration", "none.md")):
            packed = self.pack(self.folder / "bad.tar.gz", *bad, results=results)
            self.assertEqual((packed.returncode, len(packed.stderr.splitlines())), (2, 1), packed.stderr)
            self.assertFalse((self.folder / "bad.tar.gz").exists())


class Archives(unittest.TestCase):
    """A malicious or broken archive is refused by one sentence, and nothing is written."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.inside = self.folder / "inside"
        self.inside.mkdir()
        self.path = self.folder / "a.tar.gz"

    def add(self, name, data=b"x", **members):
        member = tarfile.TarInfo(name)
        member.size = len(data)
        for key, value in members.items():
            setattr(member, key, value)
        return member, data

    def write(self, *entries):
        with tarfile.open(self.path, "w:gz") as opened:
            for member, data in entries:
                opened.addfile(member, io.BytesIO(data))

    def assert_refused(self, words):
        environment = {**os.environ, "TMPDIR": str(self.inside)}
        before = sorted(self.folder.rglob("*"))
        answer = run(["check", self.path], cwd=self.inside, env=environment)
        self.assertEqual((answer.returncode, answer.stdout), (2, ""), answer.stderr)
        (line,) = answer.stderr.splitlines()
        self.assertIn(words, line)
        self.assertIn(str(self.path), line)
        self.assertEqual(sorted(self.folder.rglob("*")), before)

    def test_names_that_leave_the_archive(self):
        for name in ("../evil", "rows/../../evil", "/tmp/evil", "./rows/a.jsonl"):
            self.write(self.add(name))
            self.assert_refused("is not a plain name inside the archive")

    def test_entries_that_are_no_plain_files(self):
        for kind in (tarfile.SYMTYPE, tarfile.LNKTYPE, tarfile.FIFOTYPE, tarfile.CHRTYPE):
            self.write(self.add("manifest.json", b"", type=kind, linkname="/etc/passwd"))
            self.assert_refused("neither a plain file nor a folder")

    def test_a_name_twice(self):
        self.write(self.add("manifest.json"), self.add("manifest.json"))
        self.assert_refused("is there twice")

    def test_a_file_that_unpacks_to_too_much(self):
        self.write(self.add("manifest.json", bytes(2**27 + 1)))
        self.assertLess(self.path.stat().st_size, 2**20)
        self.assert_refused("unpacks to more than")

    @slow
    def test_files_that_together_unpack_to_too_much(self):
        self.write(*(self.add(f"rows/{number}.jsonl", bytes(2**26)) for number in range(9)))
        self.assert_refused("it unpacks to more than")

    def test_too_many_entries(self):
        self.write(*(self.add(f"rows/{number}", b"") for number in range(100_001)))
        self.assert_refused("more than 100000 entries")

    def test_files_that_are_no_archive(self):
        for data in (b"", b"no archive at all", gzip.compress(b"no archive at all"), gzip.compress(b"")):
            self.path.write_bytes(data)
            self.assert_refused("not a whole .tar.gz archive")
        self.path.unlink()
        self.assert_refused("no such file")

    def test_an_archive_that_is_cut_off(self):
        self.write(self.add("manifest.json", os.urandom(100_000)))
        whole = self.path.read_bytes()
        for size in (len(whole) // 2, len(whole) - 20, 300):
            self.path.write_bytes(whole[:size])
            self.assert_refused("not a whole .tar.gz archive")

    def test_an_archive_without_a_readable_manifest(self):
        for data, words in ((None, "it has no manifest.json"), (b"{", "manifest.json"), (b"[]", "manifest.json"),
                            (b'{"schema": "other"}', "manifest.json"), (b"[" * 100_000, "manifest.json")):
            self.write(*([self.add("manifest.json", data)] if data else [self.add("rows/a.jsonl")]))
            self.assert_refused(words)


if __name__ == "__main__":
    unittest.main()
