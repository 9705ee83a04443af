"""Parses the output of --help, in CLI11's format:

    what the program does
    Usage: podm mesh [OPTIONS] IMAGE

    Positionals:
      IMAGE                       what it is

    Size of the cells:
      -o,--output MESH            what it does
                                  and more of it

    What remains is the end.
"""

import dataclasses
import re

# An entry is indented by two columns, its text further.
ENTRY = re.compile(r"^  (?P<names>\S+)(?: (?P<type>\S+))?(?:  +(?P<text>.*))?$")
MORE = re.compile(r"^ {3,}(?P<text>\S.*)$")
TITLE = re.compile(r"^(?P<title>\S.*):$")


class HelpError(Exception):
    """The output of a program does not have that format."""


@dataclasses.dataclass
class Entry:
    """An option, an argument or a command."""
    names: list  # "-o", "--output"; of an argument or command its own
    type: str    # "MESH"; "a|b" where it is one of these; empty of a flag
    text: str

    @property
    def is_option(self):
        return self.names[0].startswith("-")

    @property
    def choices(self):
        """Returns the words that it takes, if it takes only these."""
        words = self.type.split("|")
        return words if len(words) > 1 and "FILE" not in words else []


@dataclasses.dataclass
class Group:
    title: str
    entries: list


@dataclasses.dataclass
class HelpText:
    description: str
    usage: str     # without "Usage: "
    groups: list
    end: list      # paragraphs

    @property
    def entries(self):
        return [entry for group in self.groups for entry in group.entries]

    def group(self, title):
        return next((group for group in self.groups if group.title == title), Group(title, []))


def parse(text):
    """Returns the parsed HelpText. Raises HelpError, which names the line that does not fit."""
    lines = text.rstrip("\n").split("\n")
    if len(lines) < 2 or not lines[1].startswith("Usage: "):
        raise HelpError(f"not the help of a program: {lines[0]!r}")
    parsed = HelpText(lines[0], lines[1].removeprefix("Usage: "), [], [])
    end = []
    for number, line in enumerate(lines[2:], start=2):
        follows = lines[number + 1] if number + 1 < len(lines) else ""
        if title := TITLE.match(line) if follows.startswith("  ") else None:
            parsed.groups.append(Group(title["title"], []))
        elif parsed.groups and (entry := ENTRY.match(line)):
            parsed.groups[-1].entries.append(
                Entry(entry["names"].split(","), entry["type"] or "", entry["text"] or ""))
        elif more := MORE.match(line):
            if not parsed.entries:
                raise HelpError(f"a text before the first option: {line!r}")
            last = parsed.groups[-1].entries[-1]
            last.text = f"{last.text} {more['text']}".strip()
        elif line.startswith(" "):
            raise HelpError(f"neither an option nor a text: {line!r}")
        else:
            end.append(line)
    parsed.end = [" ".join(lines.split("\n")) for lines in re.split(r"\n{2,}", "\n".join(end).strip("\n")) if lines]
    return parsed
