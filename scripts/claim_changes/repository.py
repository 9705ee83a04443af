"""The claims of each commit, read with git."""
import subprocess
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from . import definitions

FOLDER = "experiments"
SHORT = 7  # digits of a commit's hash


class NoHistory(Exception):
    """There are no commits to read; the text gives the reason."""


@dataclass(frozen=True)
class State:
    """The claims of one commit by (experiment, name), and the claims that it withdraws."""

    claims: dict
    withdrawn: tuple


@dataclass(frozen=True)
class Commit:
    """`name` and `date` are empty for the working tree. `parents`: the states of the parents."""

    name: str
    date: str
    state: State
    parents: tuple


class Repository:
    """Raises NoHistory if `root` is not a complete repository."""

    def __init__(self, root):
        self.root = Path(root)
        self._state_of_tree = lru_cache(maxsize=None)(self._read_tree)
        self._claims_of_blob = lru_cache(maxsize=None)(self._read_blob)
        if self._git("rev-parse", "--show-prefix", may_fail=True) != "":
            raise NoHistory("this is not the top folder of a git repository")
        if not self._git("rev-parse", "--verify", "--quiet", "HEAD", may_fail=True):
            raise NoHistory("there is no commit yet")
        if self._git("rev-parse", "--is-shallow-repository") == "true":
            raise NoHistory("the repository is a shallow clone, without its older commits")

    def commits(self):
        """Yields all commits that touch experiments, parents first, then the working tree."""
        log = self._git("log", "--full-history", "--topo-order", "--reverse", "--format=%H %cs %P", "HEAD", "--",
                        FOLDER)
        for line in log.splitlines():
            commit, date, *parents = line.split()
            yield Commit(commit[:SHORT], date, self.state(commit), tuple(self.state(parent) for parent in parents))
        yield Commit("", "", self.working_tree(), (self.state("HEAD"),))

    def last_tag(self):
        """Returns the newest tag before HEAD, or None."""
        return self._git("describe", "--tags", "--abbrev=0", may_fail=True) or None

    def state(self, commit):
        tree = self._git("rev-parse", "--verify", "--quiet", f"{commit}:{FOLDER}", may_fail=True)
        return self._state_of_tree(tree) if tree else State({}, ())

    def working_tree(self):
        return _state_of(definitions.read(path.read_text(), path.stem)
                         for path in sorted((self.root / FOLDER).glob("*.toml")))

    def _read_tree(self, tree):
        entries = (line.split(maxsplit=3) for line in self._git("ls-tree", tree).splitlines())
        return _state_of(self._claims_of_blob(blob, name) for _, _, blob, name in entries if name.endswith(".toml"))

    def _read_blob(self, blob, name):
        return definitions.read(self._git("cat-file", "blob", blob), name.removesuffix(".toml"))

    def _git(self, *arguments, may_fail=False):
        """Returns the output of git; None if git fails and may_fail is set."""
        try:
            done = subprocess.run(["git", "-C", str(self.root), *arguments], capture_output=True, text=True,
                                  check=False)
        except FileNotFoundError:
            raise NoHistory("git is not installed") from None
        if done.returncode != 0:
            if may_fail:
                return None
            raise NoHistory(f"git {arguments[0]} failed: {done.stderr.strip()}")
        return done.stdout.rstrip("\n")


def _state_of(files):
    claims, withdrawn = {}, []
    for claims_of_file, withdrawn_of_file in files:
        claims.update({(claim.experiment, claim.name): claim for claim in claims_of_file})
        withdrawn += withdrawn_of_file
    return State(claims, tuple(withdrawn))
