"""Tests scripts/claims_history on synthetic repositories: lost, loosened or renamed claims are reported or refused."""
import subprocess
import tempfile
import unittest
from pathlib import Path

import paths
from claim_changes import definitions

CLAIM = """[[claims]]
name = "{name}"
statement = "It is {name}."
kind = "ratio"
value = "seconds"
at_least = {at_least}
trials = {trials}
where = {where}
{more}
"""
WITHDRAWN = """[[withdrawn]]
name = "{name}"
statement = "It is {name}."
reason = "{reason}"
{more}
"""


def claim(name="fast", at_least=0.98, trials='["3M", "1M"]', where="{threads = [1, 2]}", more=""):
    return CLAIM.format(name=name, at_least=at_least, trials=trials, where=where, more=more)


def withdrawn(name="fast", reason="It was refuted.", more=""):
    return WITHDRAWN.format(name=name, reason=reason, more=more)


class Repository(unittest.TestCase):
    """A separate repository for each test."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        (self.root / "experiments").mkdir()
        self.git("init", "--quiet", "--initial-branch", "main")

    def git(self, *arguments):
        names = ["-c", "user.name=A", "-c", "user.email=a@example.org", "-c", "commit.gpgsign=false"]
        done = subprocess.run(["git", "-C", self.root, *names, *arguments], capture_output=True, text=True, check=True)
        return done.stdout.strip()

    def write(self, *claims, experiment="a"):
        (self.root / "experiments" / f"{experiment}.toml").write_text("".join(claims))

    def commit(self, *claims, experiment="a"):
        """Returns the commit's name as the page shows it."""
        self.write(*claims, experiment=experiment)
        self.git("add", "experiments")
        self.git("commit", "--quiet", "--allow-empty", "-m", "change")
        return self.git("rev-parse", "HEAD")[:7]

    def call(self, *arguments):
        return subprocess.run([paths.SCRIPTS / "claims_history", "--root", self.root, *arguments],
                              capture_output=True, text=True, check=False)

    def page(self):
        done = self.call()
        self.assertEqual(done.returncode, 0, done.stderr)
        return (self.root / "experiments" / "claims-history.md").read_text()

    def check_fails(self, *words):
        """Uses an up-to-date page, so that the fault can only be in the claims."""
        self.page()
        done = self.call("--check")
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertEqual(len(done.stdout.splitlines()), 1, done.stdout)
        for word in words:
            self.assertIn(word, done.stdout)

    def check_passes(self):
        self.page()
        done = self.call("--check")
        self.assertEqual(done.returncode, 0, done.stdout)


class Lost(Repository):
    def test_a_claim_that_is_gone_fails_until_it_is_withdrawn_with_a_reason(self):
        self.commit(claim(), claim("sound"))
        self.commit(claim("sound"))
        self.check_fails("claim 'fast' once stood")
        self.write(claim("sound"), withdrawn())
        self.check_passes()
        self.assertIn("| `fast` | withdrawn | It is fast. (a; at least 0.98) | It was refuted. |", self.page())

    def test_one_that_went_and_came_back_is_there(self):
        self.commit(claim())
        self.commit()
        self.commit(claim())
        self.check_passes()
        self.assertIn("claimed again", self.page())

    def test_one_that_moved_is_there_and_the_page_states_from_where(self):
        self.commit(claim(), claim("sound"))
        self.write(claim(), experiment="b")
        moved = self.commit(claim("sound"))
        self.check_passes()
        self.assertIn("moved from `a` to `b`", self.page())
        self.assertIn(f"| fast | {moved} |", self.page())

    def test_with_a_release_only_its_claims_are_needed(self):
        self.commit(claim(), claim("sound"))
        self.commit(claim("sound"))
        self.git("tag", "v1")
        self.check_passes()
        self.commit()
        self.check_fails("claim 'sound' stood in v1")

    def test_one_that_a_branch_lost_is_lost_after_the_merge(self):
        self.commit(claim(), claim("sound"))
        self.git("checkout", "--quiet", "-b", "side")
        self.commit(claim("sound"))
        self.git("checkout", "--quiet", "main")
        self.commit(claim("other"), experiment="b")
        self.git("merge", "--quiet", "--no-edit", "side")
        self.check_fails("claim 'fast'")


class Renamed(Repository):
    def test_needs_to_say_what_it_supersedes(self):
        self.commit(claim())
        self.write(claim("faster"))
        self.check_fails("claim 'fast' once stood")
        self.write(claim("faster", more='supersedes = "fast"\nreason = "It was too vague."\n'))
        self.check_passes()
        self.assertIn("| `fast` | superseded by `faster` | It is fast. (a; at least 0.98) | It was too vague. |",
                      self.page())

    def test_names_that_two_experiments_shared_are_distinguished(self):
        self.commit(claim())
        self.commit(claim(), experiment="b")
        self.write(claim("faster", more='supersedes = "b:fast"\nreason = "Two had the name."\n'), experiment="b")
        self.check_passes()
        self.assertIn("| `b:fast` | superseded by `faster` |", self.page())
        self.write(experiment="a")
        self.check_fails("claim 'a:fast' once stood")

    def test_what_never_stood_is_not_superseded(self):
        self.commit(claim())
        self.write(claim(), claim("sound", more='supersedes = "quick"\nreason = "So."\n'))
        self.check_fails("claim 'sound' supersedes 'quick', which never stood")

    def test_what_does_not_stand_supersedes_nothing(self):
        self.commit(claim())
        self.write(withdrawn(more='superseded_by = "faster"\n'))
        self.check_fails("withdrawn claim 'fast': there is no claim 'faster'")


class Weakened(Repository):
    def check_needs_a_reason(self, words, **change):
        self.commit(claim())
        self.write(claim(**change))
        self.check_fails("claim 'fast' asks for less than it did, without a reason", words)
        self.write(claim(**change, more='reason = "It was out of reach."\n'))
        self.check_passes()

    def test_a_loosened_bound_needs_a_reason(self):
        self.check_needs_a_reason("at_least loosened from 0.98 to 0.9735", at_least=0.9735)
        self.assertIn("loosened to at least 0.9735", self.page())

    def test_a_size_that_is_no_longer_judged_needs_a_reason(self):
        self.check_needs_a_reason("trials no longer has 3M", trials='["1M"]')

    def test_a_value_of_a_list_that_is_no_longer_judged_needs_a_reason(self):
        self.check_needs_a_reason("where threads no longer has 2", where="{threads = [1]}")

    def test_a_stricter_claim_needs_none(self):
        self.commit(claim())
        self.write(claim(at_least=0.99, trials='["10M", "3M", "1M"]', where="{threads = [1, 2, 4]}"))
        self.check_passes()

    def test_a_restored_bound_needs_none_and_the_page_lists_it(self):
        self.commit(claim())
        loosened = self.commit(claim(at_least=0.9))
        self.commit(claim())
        self.check_passes()
        self.assertIn("loosened to at least 0.9, restored", self.page())
        self.assertIn(f"| fast | {loosened} | ", self.page())

    def test_bounds_of_different_values_are_listed_and_not_compared(self):
        before, = definitions.read(claim(), "a")[0]
        after, = definitions.read(claim(at_least=0.5).replace("seconds", "cells"), "a")[0]
        self.assertEqual(definitions.loosened(before, after), [])
        self.assertEqual(definitions.changed_measure(before, after), [("value", "seconds", "cells")])


class Page(Repository):
    def test_is_right_before_and_after_it_is_committed_with_the_change(self):
        self.commit(claim())
        self.write(claim(at_least=0.99))
        self.assertIn("| fast | this commit |  | at_least: 0.98 → 0.99 |", self.page())
        self.git("add", "experiments")
        self.git("commit", "--quiet", "-m", "both")
        self.assertEqual(self.call("--check").returncode, 0)
        self.assertNotIn("this commit |", self.page())

    def test_that_is_old_edited_or_absent_fails(self):
        self.commit(claim())
        self.assertEqual(self.call("--check").returncode, 1)
        made = self.page()
        path = self.root / "experiments" / "claims-history.md"
        for text in (made + "More.\n", made.replace("id for life", "name")):
            path.write_text(text)
            done = self.call("--check")
            self.assertEqual(done.returncode, 1)
            self.assertIn("experiments/claims-history.md", done.stdout)
        path.write_text(made)
        self.write(claim(at_least=0.99))
        self.assertEqual(self.call("--check").returncode, 1)


class WithoutHistory(Repository):
    def test_nothing_is_checked_and_the_reason_is_given(self):
        self.write(claim())
        self.assertEqual(self.call("--check").stdout, "not checked: there is no commit yet\n")
        self.commit(claim())
        self.commit(claim(at_least=0.99))
        shallow = self.root / "shallow"
        self.git("clone", "--quiet", "--depth", "1", f"file://{self.root}", shallow)
        for root, words in ((shallow, "shallow clone"), (self.root / "experiments", "top folder")):
            done = subprocess.run([paths.SCRIPTS / "claims_history", "--root", root, "--check"], capture_output=True,
                                  text=True, check=False)
            self.assertEqual(done.returncode, 0)
            self.assertTrue(done.stdout.startswith("not checked: "), done.stdout)
            self.assertIn(words, done.stdout)

    def test_no_page_is_made(self):
        self.write(claim())
        done = self.call()
        self.assertEqual((done.returncode, done.stderr), (2, "claims_history: there is no commit yet\n"))


if __name__ == "__main__":
    unittest.main()
