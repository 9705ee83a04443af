"""Checks the current claims against earlier claims."""
from .history import by_id
from .table import PENDING, page
from .weakened import weakened


def faults(history, repository, committed_page):
    """Returns one text per fault, with the claim's name. `committed_page`: None if there is no page."""
    return (_lost(history, repository) + _weakened(history) + _unknown(history) + _page_fault(history, committed_page))


def _lost(history, repository):
    """After a release, the claims of that release must exist. Before the first release, all earlier claims must
    exist."""
    tag = repository.last_tag()
    needed = by_id(repository.state(tag), history.shared_names) if tag else history.lives
    since = f"stood in {tag}" if tag else "once stood"
    return [f"claim '{id_}' {since} and is neither present, withdrawn nor superseded with a reason"
            for id_ in sorted(needed) if not _is_accounted_for(history, history.lives[id_])]


def _is_accounted_for(history, life):
    if history.is_current(life):
        return True
    successor, withdrawal = history.successor(life), history.withdrawal(life)
    return bool(successor and successor.reason) or bool(withdrawal and withdrawal.reason)


def _weakened(history):
    found = []
    for life in history.lives.values():
        claim = history.claim_of(life)
        if claim is not None and not claim.reason:
            found += [f"claim '{life.id}' asks for less than it did, without a reason: {how}"
                      for how in weakened(life, claim)]
    return found


def _unknown(history):
    """Finds names of claims that never existed, or do not exist now."""
    named = [(claim.name, name) for claim in history.current.claims.values() for name in claim.supersedes]
    found = [f"claim '{by}' supersedes '{name}', which never stood" for by, name in named if name not in history.lives]
    names = {name for _, name in history.current.claims}
    return found + [f"withdrawn claim '{entry.name}': there is no claim '{entry.superseded_by}'"
                    for entry in history.current.withdrawn if entry.superseded_by and entry.superseded_by not in names]


def _page_fault(history, committed_page):
    made = page(history).splitlines()
    committed = (committed_page or "").splitlines()
    for number, (line, expected) in enumerate(zip(committed, made), 1):
        if not _agree(line, expected):
            return [f"experiments/claims-history.md:{number}: is not what scripts/claims_history makes: {expected}"]
    if len(committed) != len(made):
        return [f"experiments/claims-history.md: has {len(committed)} lines, scripts/claims_history makes {len(made)}"]
    return []


def _agree(line, expected):
    """True if the lines are equal. A change committed together with the page has no commit name in it yet; the name is
    then ignored."""
    cells, made = line.split(" | "), expected.split(" | ")
    is_pending = len(cells) > 3 and len(made) > 3 and cells[1] == PENDING
    return line == expected or (is_pending and cells[:1] + cells[3:] == made[:1] + made[3:])
