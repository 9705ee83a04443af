"""The rows that queries name, and their files.

A source is a file below results/reference (`paper/...`: below results/) with JSON lines, JSON or CSV. A row of a trial
also has the values that tables and figures derive from it (`figures.load.derived`), so that no measure is defined
twice.
"""
import csv
import json
from functools import lru_cache
from pathlib import Path

from figures import load

from .errors import DocsError

ROOT = Path(__file__).resolve().parents[2]


class Sources:
    """Files of the tree at `root`, each read once."""

    def __init__(self, root=ROOT):
        self.root = Path(root)
        self.results = self.root / "results"
        self.reference = self.results / "reference"
        self.rows = lru_cache(maxsize=None)(self._rows)
        self.frame = lru_cache(maxsize=None)(self._frame)

    def path(self, name):
        """Returns the path of a file or folder that a query or table names. Raises DocsError if it does not exist."""
        place = (self.results if name.startswith("paper/") else self.reference) / name
        if not place.exists():
            raise DocsError(f"{place.relative_to(self.root)}: no such file")
        return place

    def files(self, name):
        """Returns the names of the row files that `name`, a file or a folder, stands for."""
        place = self.path(name)
        found = sorted(place.rglob("*.jsonl")) if place.is_dir() else [place]
        return [str(one.relative_to(self.reference)) for one in found if one.name != "radii.jsonl"]

    def release_folder(self, name):
        """Returns RELEASE/WHAT of a file of reference rows; None for published values."""
        parts = Path(name).parts
        return None if parts[0] == "paper" or len(parts) < 3 else Path(*parts[:2])

    def _frame(self, names):
        """Returns the table from which figures are made, with the rows of files or folders."""
        return load.load([self.path(name) for name in names]).frame

    def _rows(self, name):
        path = self.path(name)
        text = path.read_text()
        try:
            if path.suffix == ".csv":
                return [{key: _number(value) for key, value in line.items()}
                        for line in csv.DictReader(text.splitlines())]
            if path.suffix == ".jsonl":
                return [_with_measures(json.loads(line)) for line in text.splitlines() if line.strip()]
            found = json.loads(text)
        except ValueError as error:
            raise DocsError(f"{path.relative_to(self.root)}: {error}") from None
        return found if isinstance(found, list) else [found]


def _with_measures(row):
    return {**row, **load.derived(row)} if "schema" in row and "experiment" in row else row


def _number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return text
