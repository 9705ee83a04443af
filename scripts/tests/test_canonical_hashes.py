"""Tests the hashes of a fixed set of meshes, with a synthetic program."""
import json
import tempfile
import unittest
from pathlib import Path

import paths  # noqa: F401
from docs import canonical_hashes

PODM = """#!/bin/sh
# Writes a record whose hash is {hash}, where it is asked for one.
while [ $# -gt 0 ]; do [ "$1" = --record ] && echo '{{"mesh_sha256": "{hash}"}}' > "$2"; shift; done
exit {code}
"""


class Hashes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def podm(self, text):
        path = self.folder / "podm"
        path.write_text(text)
        path.chmod(0o755)
        return str(path)

    def test_written_hashes_are_those_of_every_mesh(self):
        path = self.folder / "hashes.json"
        self.assertEqual(canonical_hashes.main(["--podm", self.podm(PODM.format(hash="abc", code=0)), "--write",
                                                str(path)]), 0)
        found = canonical_hashes.read(path)
        self.assertEqual({one["mesh_sha256"] for one in found.values()}, {"abc"})
        self.assertEqual({name: one["arguments"] for name, one in found.items()}, canonical_hashes.MESHES)

    def test_another_hash_is_named_and_exits_with_1(self):
        self.assertEqual(canonical_hashes.main(["--podm", self.podm(PODM.format(hash="abc", code=0))]), 1)
        theirs = canonical_hashes.read(canonical_hashes.HASHES)
        ours = json.loads(json.dumps(theirs))
        ours["leaves"]["mesh_sha256"] = "another"
        self.assertEqual(canonical_hashes.differences(ours, theirs), ["leaves"])
        self.assertEqual(canonical_hashes.differences({}, theirs), sorted(theirs))

    def test_a_program_that_makes_no_mesh_exits_with_2(self):
        self.assertEqual(canonical_hashes.main(["--podm", self.podm("#!/bin/sh\necho no >&2; exit 2\n")]), 2)
        self.assertEqual(canonical_hashes.main(["--podm", str(self.folder / "gone")]), 2)

    def test_hashes_on_one_thread_and_of_virtual_workers_are_among_them(self):
        is_virtual = ["--executor" in arguments for arguments in canonical_hashes.MESHES.values()]
        self.assertEqual(set(is_virtual), {False, True})
        self.assertTrue(all("--threads" not in arguments or "--executor" in arguments
                            for arguments in canonical_hashes.MESHES.values()))

    def test_a_file_of_another_kind_is_refused(self):
        path = self.folder / "hashes.json"
        for text in ("[]", "{", '{"schema": "other"}'):
            path.write_text(text)
            with self.assertRaises(canonical_hashes.HashesError):
                canonical_hashes.read(path)


if __name__ == "__main__":
    unittest.main()
