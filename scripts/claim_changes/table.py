"""Writes experiments/claims-history.md: the fate of each claim, and each change of a claim."""
from . import definitions
from .weakened import was_loosened

PENDING = "this commit"  # for a change that is committed together with the table
TITLE = """# History of the claims

<!--not measured page: statements and bounds of claims-->

The name of a claim is its id for life. `scripts/claims_history` makes this page from the commits that touched
`experiments/*.toml` and from the claims that these files list as superseded and withdrawn.
`scripts/claims_history --check`, a part of `make test`, fails if a claim is gone without a reason, if a bound is
loosened without a reason, or if this page differs from the output of the command. A name that several experiments used
at the same time is listed with its experiment, `experiment:name`. `podm-bench verdicts` prints the verdicts on the
present claims."""
GONE = """## Claims that were withdrawn, superseded, moved or loosened

| claim | change | last statement, or statement before the change | reason |
| --- | --- | --- | --- |"""
CHANGES = """## Changes

A change that is committed together with this page has no commit here yet.

| claim | commit | date | change |
| --- | --- | --- | --- |"""


def page(history):
    lives = [history.lives[id_] for id_ in sorted(history.lives)]
    fates = [line for life in lives if (line := _fate(history, life))]
    changes = [_line(life.id, change.commit or PENDING, change.date, _change_in_words(history, life, change))
               for life in lives for change in life.changes[1:]]
    return "\n".join([TITLE, "", GONE, *fates, "", CHANGES, *changes]) + "\n"


def _fate(history, life):
    """Returns the line of a claim that differs from its first publication; None for any other claim."""
    claim, successor, withdrawal = history.claim_of(life), history.successor(life), history.withdrawal(life)
    if claim is None:
        what = (f"superseded by `{successor.name}`" if successor else
                _withdrawn_in_words(withdrawal) if withdrawal else "**gone**")
        reason = successor.reason if successor else withdrawal.reason if withdrawal else ""
        return _line(f"`{life.id}`", what, _statement(life.last()), reason)
    before = life.changes[0].after
    parts = []
    if before.experiment != claim.experiment:
        parts.append(f"moved from `{before.experiment}` to `{claim.experiment}`")
    if pair := was_loosened(life):
        before = pair[0]
        is_restored = not any(definitions.loosened(one, claim) for one in life.definitions())
        parts.append(f"loosened to {definitions.bound_in_words(pair[1])}" + (", restored" if is_restored else ""))
    return _line(f"`{life.id}`", "; ".join(parts), _statement(before), claim.reason) if parts else None


def _withdrawn_in_words(entry):
    return "withdrawn" + (f", superseded by `{entry.superseded_by}`" if entry.superseded_by else "")


def _statement(claim):
    bound = definitions.bound_in_words(claim)
    return claim.definition["statement"] + (f" ({claim.experiment}; {bound})" if bound else f" ({claim.experiment})")


def _change_in_words(history, life, change):
    if change.after is None:
        successor = history.successor(life)
        return f"superseded by `{successor.name}`" if successor else "no longer claimed"
    if change.before is None:
        return "claimed again"
    return "; ".join(f"{name}: {_value(old)} → {_value(new)}"
                     for name, old, new in definitions.differences(change.before, change.after))


def _value(value):
    if isinstance(value, dict):
        return ", ".join(f"{key} {_value(of_key)}" for key, of_key in value.items())
    if isinstance(value, list):
        return ", ".join(map(_value, value))
    return "none" if value is None else str(value)


def _line(*cells):
    return f"| {' | '.join(str(cell).replace('|', chr(92) + '|') for cell in cells)} |"
