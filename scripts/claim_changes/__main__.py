"""Writes the history of the experiments' claims as a page, or checks it."""
import argparse
import sys
import tomllib
from pathlib import Path

from .check import faults
from .history import history_of
from .repository import FOLDER, NoHistory, Repository
from .table import page

PAGE = f"{FOLDER}/claims-history.md"


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="claims_history",
        description=f"Writes {PAGE}: each claim that was withdrawn, superseded, moved or loosened, and each change of "
                    "one, from the commits of the repository.",
        epilog="Exit codes: 0 all is well, or nothing is checked as there is no history; 1 a fault was found; 2 bad "
               "usage or input.")
    parser.add_argument("--check", action="store_true",
                        help="write nothing; fail when a claim is gone or asks for less without a reason, or the page "
                             "is not what this command makes")
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parents[2], metavar="FOLDER",
                        help="the repository (default: the one of this script)")
    given = parser.parse_args(arguments)
    try:
        repository = Repository(given.root)
        history = history_of(repository)
    except NoHistory as why:
        print(f"not checked: {why}" if given.check else f"claims_history: {why}",
              file=sys.stdout if given.check else sys.stderr)
        return 0 if given.check else 2
    except tomllib.TOMLDecodeError as error:
        print(f"{given.root / FOLDER}: {error}", file=sys.stderr)
        return 2
    if given.check:
        return _check(history, repository, given.root / PAGE)
    (given.root / PAGE).write_text(page(history))
    return 0


def _check(history, repository, path):
    found = faults(history, repository, path.read_text() if path.exists() else None)
    print("\n".join(found) if found else f"{len(history.lives)} claims since the first commit, all accounted for")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
