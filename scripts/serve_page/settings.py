"""The settings of the page, as arguments of podm, as a command line and as lines of Python."""
import json
import shlex
import subprocess
from dataclasses import dataclass
from functools import cached_property
from pathlib import PurePath

from .faults import Fault

SLIDERS = ("radius", "delta", "smooth", "min-dihedral")
OF_LABELS = "drop-islands"
LONGEST_NAME = 80


class Declared:
    """The options of podm mesh, as `podm options` prints them."""

    def __init__(self, podm):
        printed = subprocess.run([podm, "options"], capture_output=True, check=True).stdout
        self._options = {option["name"]: option for option in json.loads(printed)}

    def __getitem__(self, name):
        return self._options[name]

    @cached_property
    def extensions(self):
        """The formats of meshes and surfaces, as the help of the two options lists them: {".vtu": ...}."""
        words = " ".join(self[name]["help"] for name in ("output", "surface")).replace(",", " ").split()
        return [word for word in words if word.startswith(".")]

    def sliders(self):
        return [{key: self[name][key] for key in ("name", "help", "unset", "quantity", "type", "most")
                 if key in self[name]} for name in (*SLIDERS, OF_LABELS)]


@dataclass(frozen=True)
class Settings:
    """`keep`: label values, or None for all. `merges`: (name, values). `numbers`: by option."""

    keep: tuple | None
    merges: tuple
    numbers: dict

    @classmethod
    def of(cls, sent, declared):
        """Checks what the page has sent. Raises Fault."""
        try:
            keep = None if sent["keep"] is None else tuple(map(_value, sent["keep"]))
            merges = tuple((_name(one["name"]), tuple(map(_value, one["values"]))) for one in sent["merges"])
            numbers = {name: _number(name, sent["numbers"][name], declared[name])
                       for name in (*SLIDERS, OF_LABELS) if sent["numbers"].get(name) is not None}
        except (KeyError, TypeError, ValueError, AttributeError, OverflowError):
            raise Fault("The settings are not those of this page.") from None
        if keep == ():
            raise Fault("No label is ticked.")
        return cls(keep, merges, numbers)

    def of_labels(self):
        arguments = [] if self.keep is None else ["--labels", ranges_text(self.keep)]
        for name, values in self.merges:
            arguments += ["--merge", f"{','.join(map(str, values))}={name}"]
        return arguments + self._arguments([OF_LABELS])

    def of_cells(self):
        return self._arguments(SLIDERS)

    def command_line(self, image, table):
        named = ["--label-names", table] if table else []
        return shlex.join(["podm", "mesh", image, *named, *self.of_labels(), *self.of_cells(), "--verify", "-o",
                           f"{stem_of(image)}.vtu"])

    def python_lines(self, image, table, declared):
        keywords = {"names": table} if table else {}
        if self.keep is not None:
            keywords[declared["labels"]["keyword"]] = ranges_text(self.keep)
        if self.merges:
            keywords[declared["merge"]["keyword"]] = {name: list(values) for name, values in self.merges}
        keywords |= {declared[name]["keyword"]: value for name, value in self.numbers.items()}
        arguments = ", ".join([repr(image), *(f"{key}={value!r}" for key, value in keywords.items())])
        return (f"import podm\n\nmesh = podm.mesh({arguments})\nprint(mesh.verify())\n"
                f"mesh.save({stem_of(image) + '.vtu'!r})\n")

    def _arguments(self, names):
        return [word for name in names if name in self.numbers
                for word in (f"--{name}", repr(self.numbers[name]))]


def stem_of(image):
    return PurePath(image.removesuffix(".gz")).stem


def ranges_text(values):
    """Returns "1,3-7" for sorted values."""
    ranges = []
    for value in sorted(set(values)):
        if ranges and ranges[-1][1] == value - 1:
            ranges[-1][1] = value
        else:
            ranges.append([value, value])
    return ",".join(str(first) if first == last else f"{first}-{last}" for first, last in ranges)


def _value(value):
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 2**32:
        raise ValueError(value)
    return value


def _name(name):
    if not name.strip() or len(name) > LONGEST_NAME or not name.isprintable():
        raise Fault("A name of a label has 1 to 80 characters, all printable.")
    return name.strip()


def _number(name, value, declared):
    """Returns a number in the range of its option; an integer where it is whole."""
    number = float(value)
    if not declared["least"] <= number <= declared.get("most", 1e6):
        raise Fault(f"--{name}: {value} is not a {declared['quantity']} in its range.")
    return int(number) if number == int(number) else number
