"""The history of each claim: the changes of its definition, and its end."""
from dataclasses import dataclass, field

from . import definitions


@dataclass(frozen=True)
class Change:
    """`commit` is empty for an uncommitted change. `before` or `after` is None where the claim began or ended."""

    commit: str
    date: str
    before: definitions.Claim = None
    after: definitions.Claim = None


@dataclass
class Life:
    """`id`: the claim's name, or "experiment:name" if several experiments had a claim of this name at the same time."""

    id: str
    changes: list = field(default_factory=list)

    def definitions(self):
        """Returns all definitions that the claim ever had, oldest first."""
        return [change.after for change in self.changes if change.after]

    def last(self):
        return self.definitions()[-1]


@dataclass(frozen=True)
class History:
    """`lives`: by id. `current`: the state of the working tree."""

    lives: dict
    current: object
    shared_names: frozenset

    def id_of(self, claim):
        return _id(claim.experiment, claim.name, self.shared_names)

    def is_current(self, life):
        return any(self.id_of(claim) == life.id for claim in self.current.claims.values())

    def claim_of(self, life):
        """Returns the current claim, or None if it no longer exists."""
        return next((claim for claim in self.current.claims.values() if self.id_of(claim) == life.id), None)

    def successor(self, life):
        """Returns the claim that supersedes it, or None."""
        return next((claim for claim in self.current.claims.values() if life.id in claim.supersedes), None)

    def withdrawal(self, life):
        """Returns the entry that withdraws it, or None."""
        return next((entry for entry in self.current.withdrawn if self.id_of_withdrawn(entry) == life.id), None)

    def id_of_withdrawn(self, entry):
        return entry.name if ":" in entry.name else _id(entry.experiment, entry.name, self.shared_names)


def history_of(repository):
    commits = list(repository.commits())
    shared = frozenset(name for commit in commits for name in _shared_names(commit.state))
    lives = {}
    for commit in commits:
        for id_, before, after in _changes(commit, shared):
            lives.setdefault(id_, Life(id_)).changes.append(Change(commit.name, commit.date, before, after))
    return History(lives, commits[-1].state, shared)


def _shared_names(state):
    """Returns the names that several experiments have at the same time."""
    names = [name for _, name in state.claims]
    return {name for name in names if names.count(name) > 1}


def _id(experiment, name, shared):
    return f"{experiment}:{name}" if name in shared else name


def by_id(state, shared):
    return {_id(experiment, name, shared): claim for (experiment, name), claim in state.claims.items()}


def _changes(commit, shared):
    """Yields (id, before, after) of the claims that differ from every parent. In a merge, these exclude the changes
    that its branches made before."""
    after = by_id(commit.state, shared)
    parents = [by_id(parent, shared) for parent in commit.parents] or [{}]
    for id_ in sorted(set(after).union(*parents)):
        now = after.get(id_)
        if all(_differ(parent.get(id_), now) for parent in parents):
            yield id_, parents[0].get(id_), now


def _differ(before, after):
    if before is None or after is None:
        return before is not after
    return bool(definitions.differences(before, after))
