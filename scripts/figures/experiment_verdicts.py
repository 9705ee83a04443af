"""Verdicts on the claims of our experiments, as `podm-bench verdicts --json` writes them."""
import json

import pandas

SCHEMA = "podm-bench-verdicts/1"
WORDS = ("holds", "does_not_hold", "cannot_be_decided")
HOW = ("No verdicts of experiments were given. `build/bin/podm-bench verdicts --json FILE experiments/*.toml` makes "
       "them, `--experiment-verdicts FILE` shows them.")
COLUMNS = ["experiment", "claim", "basis", "verdict", "value", "bound", "n", "reason", "statement"]


class VerdictsError(Exception):
    """Verdicts that cannot be read; the text names file, place and fault."""


def read_experiment_verdicts(path):
    """Raises VerdictsError."""
    try:
        found = json.loads(path.read_text())
    except (OSError, ValueError) as error:
        raise VerdictsError(f"{path}: {error}") from None
    if not isinstance(found, dict) or found.get("schema") != SCHEMA:
        raise VerdictsError(f"{path}: not verdicts of schema {SCHEMA}")
    for experiment in found["experiments"]:
        for claim in experiment["claims"]:
            if claim.get("verdict") not in WORDS:
                raise VerdictsError(f"{path}: {experiment['experiment']}: {claim.get('name')}: verdict "
                                    f"{claim.get('verdict')!r}; one of {', '.join(WORDS)} is expected")
    return found


def table(found):
    """One line a claim: those that do not hold first, then those that hold; `found` may be None."""
    lines = [{**claim, "claim": claim["name"], "experiment": experiment["experiment"]}
             for experiment in (found or {"experiments": []})["experiments"] for claim in experiment["claims"]]
    made = pandas.DataFrame(lines, columns=COLUMNS, dtype=object)
    rank = made["verdict"].map(["does_not_hold", "holds", "cannot_be_decided"].index)
    return made.assign(rank=rank).sort_values("rank", kind="stable", ignore_index=True).drop(columns="rank")


def counts(found):
    """"12 hold, 3 do not, 5 cannot be decided here"; empty without verdicts."""
    verdicts = list(table(found)["verdict"])
    hold, fail, open_ones = (verdicts.count(word) for word in WORDS)
    return f"{hold} hold, {fail} do not, {open_ones} cannot be decided here" if verdicts else ""
