"""The claims in a file of an experiment, and the differences between two definitions of one claim."""
import tomllib
from dataclasses import dataclass, field

AT_LEAST, AT_MOST, FACTOR = "at_least", "at_most", "factor_per_doubling"
BOUNDS = (AT_LEAST, AT_MOST, FACTOR)
SERIES = ("of", "over", "above", "below", "across", "along", "direction")
FIELDS = ("statement", "basis", "kind", "value", *BOUNDS, "where", "trials", "extent", "needs_cores", *SERIES)
WHAT_IS_JUDGED = ("kind", "value", "along", "direction")  # bounds are comparable only if these are equal


@dataclass(frozen=True)
class Claim:
    """`definition`: the fields given in the file. `supersedes`: the claims that this claim replaces."""

    experiment: str
    name: str
    definition: dict = field(hash=False)
    supersedes: tuple = ()
    reason: str = ""


@dataclass(frozen=True)
class Withdrawn:
    """`name` may name a claim of another experiment, as "experiment:name"."""

    experiment: str
    name: str
    statement: str
    reason: str
    superseded_by: str = ""


def read(text, experiment):
    """Returns the claims of a file and the claims that it withdraws."""
    document = tomllib.loads(text)
    claims = [Claim(experiment, entry["name"], {key: entry[key] for key in FIELDS if key in entry},
                    tuple(_listed(entry.get("supersedes", []))), entry.get("reason", ""))
              for entry in document.get("claims", [])]
    withdrawn = [Withdrawn(experiment, entry["name"], entry["statement"], entry.get("reason", ""),
                           entry.get("superseded_by", "")) for entry in document.get("withdrawn", [])]
    return claims, withdrawn


def differences(before, after):
    """Returns (field, old, new) for each field in which two claims differ; None stands for an absent field."""
    found = [("experiment", before.experiment, after.experiment)] if before.experiment != after.experiment else []
    return found + [(key, before.definition.get(key), after.definition.get(key)) for key in FIELDS
                    if before.definition.get(key) != after.definition.get(key)]


def is_comparable(one, other):
    """True if a bound of one claim means the same for the other."""
    return all(one.definition.get(key) == other.definition.get(key) for key in WHAT_IS_JUDGED)


def loosened(before, after):
    """Returns (field, old, new) for each bound of `after` that is weaker than the bound of `before`."""
    if not is_comparable(before, after):
        return []
    pairs = [(key, before.definition.get(key), after.definition.get(key)) for key in BOUNDS]
    return [(key, old, new) for key, old, new in pairs
            if old is not None and (new is None or (new > old if key == AT_MOST else new < old))]


def narrowed(before, after):
    """Returns (field, lost): the listed values and trial patterns on which `before` was judged and `after` is not."""
    found = [("trials", set(_listed(before.definition.get("trials", []))) -
              set(_listed(after.definition.get("trials", []))))] if "trials" in after.definition else []
    old, new = before.definition.get("where", {}), after.definition.get("where", {})
    found += [(f"where {key}", set(_values(old[key])) - set(_values(new[key]))) for key in old if key in new]
    return [(name, sorted(lost, key=str)) for name, lost in found if lost]


def changed_measure(before, after):
    """Returns (field, old, new) for each judged field in which the two claims differ."""
    return [one for one in differences(before, after) if one[0] in WHAT_IS_JUDGED]


def bound_in_words(claim):
    words = {AT_LEAST: "at least", AT_MOST: "at most", FACTOR: "a factor per doubling of at least"}
    return " and ".join(f"{words[key]} {claim.definition[key]}" for key in BOUNDS if key in claim.definition)


def _values(condition):
    """Returns the values that a condition lists; an empty list for a range."""
    return [] if isinstance(condition, dict) else _listed(condition)


def _listed(value):
    return value if isinstance(value, list) else [value]
