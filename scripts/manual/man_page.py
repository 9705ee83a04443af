"""A manual page in the macros of man(7), for section 1."""

import re

from .program import COMMANDS

EXIT_CODES = "Exit codes: "


def escaped(text):
    """Returns the text escaped for groff: no commands, hyphens as typed."""
    text = text.replace("\\", r"\e").replace("-", r"\-")
    return r"\&" + text if text[:1] in ("'", ".") else text


def heading(macro, title):
    return f'.{macro} "{escaped(title)}"'


def entry_lines(entry):
    names = ", ".join(rf"\fB{escaped(name)}\fR" for name in entry.names)
    if entry.type:
        names += " " + escaped(entry.type) if entry.choices else rf" \fI{escaped(entry.type)}\fR"
    return [".TP", names, escaped(entry.text) or r"\&"]


def entries_lines(help_text):
    """Returns the groups of arguments and options, each under its title."""
    lines = []
    for group in help_text.groups:
        if group.title != COMMANDS and group.entries:
            lines += [".PP", rf"\fI{escaped(group.title)}\fR"]
            lines += [line for entry in group.entries for line in entry_lines(entry)]
    return lines


def paragraphs(help_text):
    return [line for text in help_text.end if not text.startswith(EXIT_CODES) for line in (".PP", escaped(text))]


def usages(program):
    return [parsed.usage for parsed in program.commands.values()] or [program.help.usage]


def synopsis(program):
    lines = []
    for usage in usages(program):
        words = usage.split(" ", 1 if not program.commands else 2)
        called, rest = words[:-1], words[-1]
        lines += [rf"\fB{escaped(' '.join(called))}\fR {escaped(rest)}", ".br"]
    return lines[:-1]


def exit_codes(program):
    """Returns "0 success, 1 ..." as a list."""
    text = next((text for text in program.help.end if text.startswith(EXIT_CODES)), None)
    if text is None:
        return []
    codes = re.split(r", (?=\d )", text.removeprefix(EXIT_CODES).rstrip("."))
    lines = [heading("SH", "EXIT STATUS")]
    for code, meaning in (entry.split(" ", 1) for entry in codes):
        lines += [".TP", rf"\fB{code}\fR", escaped(meaning)]
    return lines


def page(program, all_names):
    """Returns the page. `all_names`: the programs to refer to; its own name is left out."""
    about = program.help.description.rstrip(".")
    lines = [f'.TH {program.name.upper()} 1 "" "podm {program.version}" "User Commands"',
             heading("SH", "NAME"),
             rf"{escaped(program.name)} \- {escaped(about[:1].lower() + about[1:])}",
             heading("SH", "SYNOPSIS"), *synopsis(program),
             heading("SH", "OPTIONS"), *entries_lines(program.help), *paragraphs(program.help)]
    if program.commands:
        lines += [heading("SH", "COMMANDS")]
    for name, parsed in program.commands.items():
        lines += [heading("SS", f"{program.name} {name}"), escaped(parsed.description),
                  *entries_lines(parsed), *paragraphs(parsed)]
    lines += exit_codes(program)
    others = [name for name in all_names if name != program.name]
    if others:
        lines += [heading("SH", "SEE ALSO"), ", ".join(rf"\fB{escaped(name)}\fR(1)" for name in others)]
    return "\n".join(lines) + "\n"
