"""A rebuilt corpus holds the named inputs, and as few others as take the same branches, up to the number asked for."""
import hashlib
import pathlib
import subprocess
import tempfile
import unittest

CHOOSE_INPUTS = pathlib.Path(__file__).parents[1] / "choose_inputs"


def sha1(text):
    return hashlib.sha1(text.encode()).hexdigest()


class ChooseInputs(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.corpus = self.folder / "corpus"
        self.learnt = self.folder / "learnt"
        self.corpus.mkdir()
        self.learnt.mkdir()

    def choose(self, inputs, *options, ends=True):
        """Merges inputs of the form (file, text, features). Without `ends` the last input has no features."""
        control = self.folder / "control"
        lines = [str(len(inputs)), "0"]
        for path, text, _ in inputs:
            path.write_text(text)
            lines.append(str(path))
        for i, (_, text, features) in enumerate(inputs):
            lines.append(f"STARTED {i} {len(text)}")
            if ends or i + 1 < len(inputs):
                lines += [f"FT {i} {' '.join(map(str, features))}".rstrip(), f"COV {i} 1"]
        control.write_text("\n".join(lines) + "\n")
        return subprocess.run([CHOOSE_INPUTS, control, self.corpus, *options], capture_output=True, text=True)

    def names(self):
        return {path.name for path in self.corpus.iterdir()}

    def test_keeps_named_inputs_and_removes_those_that_add_nothing(self):
        old = sha1("old")
        done = self.choose([(self.corpus / "by_hand", "long input", [1, 2]),
                            (self.corpus / old, "old", [1]),
                            (self.learnt / "x", "new", [2, 3])])
        self.assertEqual(self.names(), {"by_hand", sha1("new")})
        self.assertEqual(done.stdout, f"{self.corpus}: 2 of 3 inputs, 3 of 3 features\n", done.stderr)

    def test_keeps_an_input_by_hash_that_is_still_needed(self):
        old = sha1("old")
        self.choose([(self.corpus / old, "old", [1, 2])])
        self.assertEqual(self.names(), {old})
        self.assertEqual((self.corpus / old).read_text(), "old")

    def test_prefers_most_new_features_then_the_shortest(self):
        inputs = [(self.learnt / "a", "aaa", [1, 2]), (self.learnt / "b", "bb", [1, 2]), (self.learnt / "c", "c", [3])]
        done = self.choose(inputs, "--most", "1")
        self.assertEqual(self.names(), {sha1("bb")})
        self.assertIn("1 of 3 inputs, 2 of 3 features", done.stdout)

    def test_keeps_all_named_inputs_even_beyond_the_number(self):
        inputs = [(self.corpus / name, name, [1]) for name in ("one", "two", "three")]
        self.choose([*inputs, (self.learnt / "x", "new", [9])], "--most", "2")
        self.assertEqual(self.names(), {"one", "two", "three"})

    def test_changes_nothing_if_the_target_did_not_end_on_an_input(self):
        old = sha1("old")
        done = self.choose([(self.corpus / old, "old", []), (self.learnt / "x", "new", [1])], ends=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn(f"{self.learnt}/x: the target did not return", done.stderr)
        self.assertEqual(self.names(), {old})


if __name__ == "__main__":
    unittest.main()
