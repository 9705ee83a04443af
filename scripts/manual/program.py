"""A program as described by its help."""

import dataclasses
import subprocess

from . import help_text
from .help_text import HelpError

COMMANDS = "Subcommands"


def printed_by(*command):
    process = subprocess.run(command, capture_output=True, text=True)
    if process.returncode != 0 or not process.stdout:
        raise HelpError(f"{' '.join(map(str, command))}: exit code {process.returncode}: {process.stderr.strip()}")
    return process.stdout


@dataclasses.dataclass
class Program:
    name: str
    version: str    # "0.1.0"
    help: help_text.HelpText
    commands: dict  # HelpText by name; empty for a program without commands

    @classmethod
    def asked(cls, path):
        """Asks the program at `path`. Raises HelpError if it does not answer as expected."""
        parsed = help_text.parse(printed_by(path, "--help"))
        names = [entry.names[0] for entry in parsed.group(COMMANDS).entries]
        return cls(name=path.name,
                   version=printed_by(path, "--version").split("\n")[0].split()[-1],
                   help=parsed,
                   commands={name: help_text.parse(printed_by(path, name, "--help")) for name in names})
