"""A page of a program's options, made of what it prints for --help."""
from manual.program import COMMANDS


def cell(text):
    """Text as it shows in a cell of a table."""
    return text.replace("\\", "\\\\").replace("|", "\\|").replace("<", "&lt;").replace("*", "\\*").replace("_", "\\_")


def page(program):
    """`program`: of manual.Program.asked."""
    about = program.help.description.rstrip(".")
    lines = [f"# Options of {program.name}", "", f"{about}. Version {program.version}.", ""]
    lines += _help(program.help)
    for name, one in program.commands.items():
        about = one.description[:1].upper() + one.description[1:].rstrip(".")
        lines += [f"## {program.name} {name}", "", f"{about}.", "", *_help(one)]
    return "\n".join(lines)


def _help(one):
    lines = ["```text", one.usage, "```", ""]
    for group in one.groups:
        if group.entries and group.title != COMMANDS:
            lines += [f"**{group.title}**", "", "| option | meaning |", "| --- | --- |",
                      *(f"| {_names(entry)} | {cell(entry.text)} |" for entry in group.entries), ""]
    for text in one.end:
        lines += [cell(text), ""]
    return lines


def _names(entry):
    kind = f" `{entry.type}`".replace("|", "\\|") if entry.type else ""
    return ", ".join(f"`{name}`" for name in entry.names) + kind
