"""The command line of scripts/make_manual."""

import argparse
import pathlib
import sys

from . import bash_completion, man_page
from .help_text import HelpError
from .program import Program


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="make_manual", description=__doc__)
    parser.description = ("Writes, for each program, FOLDER/man/man1/NAME.1 and "
                          "FOLDER/bash-completion/completions/NAME, of what it prints for --help.")
    parser.add_argument("programs", metavar="PROGRAM", nargs="+", type=pathlib.Path)
    parser.add_argument("-o", "--output", metavar="FOLDER", type=pathlib.Path, required=True,
                        help="share/ of a prefix")
    options = parser.parse_args(arguments)
    try:
        programs = [Program.asked(path.resolve()) for path in options.programs]
    except HelpError as error:
        print(f"make_manual: {error}", file=sys.stderr)
        return 2
    names = [program.name for program in programs]
    for program in programs:
        write(options.output / "man/man1" / f"{program.name}.1", man_page.page(program, names))
        write(options.output / "bash-completion/completions" / program.name, bash_completion.script(program))
    return 0


if __name__ == "__main__":
    sys.exit(main())
