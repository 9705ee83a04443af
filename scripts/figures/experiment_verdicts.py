"""Verdicts on the claims of the project's experiments, as written by `podm-bench verdicts --json`."""
import json

import pandas

SCHEMA = "podm-bench-verdicts/2"
WORDS = {"does_not_hold": "do not", "not_resolved": "not resolved", "holds": "hold",
         "cannot_be_decided": "cannot be decided here"}  # the words for each verdict, in the order of display
WITHDRAWN = "withdrawn"
HOW = ("No verdicts of experiments were given. `build/bin/podm-bench verdicts --json FILE experiments/*.toml` makes "
       "them, `--experiment-verdicts FILE` shows them.")
COLUMNS = ["experiment", "claim", "basis", "verdict", "value", "interval", "bound", "n", "reason", "statement"]


class VerdictsError(Exception):
    """Verdicts that cannot be read; the text names the file, the place and the fault."""


def read_experiment_verdicts(path):
    """Reads and checks a file of verdicts. Raises VerdictsError."""
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
    """One line per claim: first those that do not hold, then those of the other verdicts, then claims that were
    withdrawn. `found` may be None."""
    lines = [{**claim, "claim": claim["name"], "experiment": experiment["experiment"], "interval": _interval(claim),
              "reason": _reason(claim)}
             for experiment in (found or {"experiments": []})["experiments"]
             for claim in (*experiment["claims"], *experiment["withdrawn"])]
    made = pandas.DataFrame(lines, columns=COLUMNS, dtype=object)
    rank = made["verdict"].map([*WORDS, WITHDRAWN].index)
    return made.assign(rank=rank).sort_values("rank", kind="stable", ignore_index=True).drop(columns="rank")


def counts(found):
    """Returns "12 hold, 3 do not, 1 not resolved, 5 cannot be decided here"; empty without verdicts."""
    verdicts = list(table(found)["verdict"])
    words = [f"{verdicts.count(word)} {WORDS[word]}" for word in ("holds", "does_not_hold", "not_resolved",
                                                                  "cannot_be_decided")]
    withdrawn = verdicts.count(WITHDRAWN)
    return ", ".join(words) + (f"; {withdrawn} withdrawn or superseded" if withdrawn else "") if verdicts else ""


def _interval(claim):
    """Returns "0.98 to 1.14, 96.9 % of 6 rounds"; empty without an interval."""
    interval = claim.get("interval")
    if not interval or interval["rounds"] < 2:
        return ""
    low, high = (f"{bound:.3g}" if bound is not None else "infinite" for bound in (interval["low"], interval["high"]))
    return f"{low} to {high}, {100 * interval['coverage']:.1f} % of {interval['rounds']} rounds"


def _reason(claim):
    successor = claim.get("superseded_by")
    return f"superseded by {successor}: {claim['reason']}" if successor else claim["reason"]
