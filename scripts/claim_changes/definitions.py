"""What a file of an experiment claims, and how two definitions of one claim differ."""
import tomllib
from dataclasses import dataclass, field

AT_LEAST, AT_MOST, FACTOR = "at_least", "at_most", "factor_per_doubling"
BOUNDS = (AT_LEAST, AT_MOST, FACTOR)
SERIES = ("of", "over", "above", "below", "across", "along", "direction")
FIELDS = ("statement", "basis", "kind", "value", *BOUNDS, "where", "trials", "extent", "needs_cores", *SERIES)
WHAT_IS_JUDGED = ("kind", "value", "along", "direction")  # a bound of another of these is another bound


@dataclass(frozen=True)
class Claim:
    """`definition`: the fields that stand in the file. `supersedes`: claims whose place it takes."""

    experiment: str
    name: str
    definition: dict = field(hash=False)
    supersedes: tuple = ()
    reason: str = ""


@dataclass(frozen=True)
class Withdrawn:
    """`name` may be that of a claim of another experiment, as "experiment:name"."""

    experiment: str
    name: str
    statement: str
    reason: str
    superseded_by: str = ""


def read(text, experiment):
    """The claims of a file and those that it withdraws."""
    document = tomllib.loads(text)
    claims = [Claim(experiment, entry["name"], {key: entry[key] for key in FIELDS if key in entry},
                    tuple(_listed(entry.get("supersedes", []))), entry.get("reason", ""))
              for entry in document.get("claims", [])]
    withdrawn = [Withdrawn(experiment, entry["name"], entry["statement"], entry.get("reason", ""),
                           entry.get("superseded_by", "")) for entry in document.get("withdrawn", [])]
    return claims, withdrawn


def differences(before, after):
    """(field, old, new) of each field in which two claims differ; None stands for an absent one."""
    found = [("experiment", before.experiment, after.experiment)] if before.experiment != after.experiment else []
    return found + [(key, before.definition.get(key), after.definition.get(key)) for key in FIELDS
                    if before.definition.get(key) != after.definition.get(key)]


def is_comparable(one, other):
    """Whether a bound of the one means the same for the other."""
    return all(one.definition.get(key) == other.definition.get(key) for key in WHAT_IS_JUDGED)


def loosened(before, after):
    """The bounds of `after` that ask for less than those of `before`: (field, old, new)."""
    if not is_comparable(before, after):
        return []
    pairs = [(key, before.definition.get(key), after.definition.get(key)) for key in BOUNDS]
    return [(key, old, new) for key, old, new in pairs
            if old is not None and (new is None or (new > old if key == AT_MOST else new < old))]


def narrowed(before, after):
    """The listed values and the patterns of trials that `before` was judged on and `after` is not: (field, lost)."""
    found = [("trials", set(_listed(before.definition.get("trials", []))) -
              set(_listed(after.definition.get("trials", []))))] if "trials" in after.definition else []
    old, new = before.definition.get("where", {}), after.definition.get("where", {})
    found += [(f"where {key}", set(_values(old[key])) - set(_values(new[key]))) for key in old if key in new]
    return [(name, sorted(lost, key=str)) for name, lost in found if lost]


def changed_measure(before, after):
    """The fields of what is judged in which they differ: (field, old, new)."""
    return [one for one in differences(before, after) if one[0] in WHAT_IS_JUDGED]


def bound_in_words(claim):
    words = {AT_LEAST: "at least", AT_MOST: "at most", FACTOR: "a factor per doubling of at least"}
    return " and ".join(f"{words[key]} {claim.definition[key]}" for key in BOUNDS if key in claim.definition)


def _values(condition):
    """The values that a condition lists; none of a range."""
    return [] if isinstance(condition, dict) else _listed(condition)


def _listed(value):
    return value if isinstance(value, list) else [value]
