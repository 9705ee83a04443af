"""Completion for bash, and for zsh by its bashcompinit: commands, options, and the values of options."""

import shlex

FILES = {"FILE", "N|FILE", "FOLDER", "MESH", "PAGE", "PICTURE"}

SCRIPT = """\
# Completes {name} in bash; in zsh after `autoload -U +X bashcompinit && bashcompinit`. Made by scripts/make_manual.
{function}() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} command=
  [ "$current" != = ] || current=
  [ "$before" != = ] || before=${{COMP_WORDS[COMP_CWORD - 2]}}  # --option=value
{find_command}
  local offered= files=
  case "$command $before" in
{values}
    *) case "$command" in
{offered}
      esac ;;
  esac
  COMPREPLY=($(compgen -W "$offered" -- "$current"))
  local IFS=$'\n'  # names of files may have blanks
  [ -z "$files" ] || [ "${{current#-}}" != "$current" ] || COMPREPLY+=($(compgen -f -- "$current"))
}}
complete -o filenames -F {function} {name}
"""

FIND_COMMAND = """\
  [ "$COMP_CWORD" -lt 2 ] || case "${{COMP_WORDS[1]}}" in {commands}) command=${{COMP_WORDS[1]}} ;; esac"""


def action_of(entry):
    if entry.choices:
        return f"offered={shlex.quote(' '.join(entry.choices))}"
    return "files=yes" if entry.type in FILES else ":"  # no completion for a number or a name


def value_cases(helps):
    """Returns the cases of the values of options; options with the same values share a case."""
    patterns = {}
    for command, parsed in helps.items():
        for entry in parsed.entries:
            if entry.is_option and entry.type:
                names = [shlex.quote(f"{command} {name}") for name in entry.names]
                patterns.setdefault(action_of(entry), []).extend(names)
    return [f"    {'|'.join(names)}) {action} ;;" for action, names in patterns.items()]


def word_case(command, help_text, commands=()):
    """Returns the case of the other words: commands, options, and arguments."""
    words = [*commands, *(name for entry in help_text.entries if entry.is_option for name in entry.names)]
    arguments = help_text.group("Positionals").entries
    words += [word for entry in arguments for word in entry.choices]
    files = " files=yes" if any(not entry.choices for entry in arguments) else ""
    return f"      {shlex.quote(command)}) offered={shlex.quote(' '.join(words))}{files} ;;"


def script(program):
    """Returns the text of the file that bash reads for the program."""
    helps = {"": program.help, **program.commands}
    return SCRIPT.format(
        name=program.name, function="_" + program.name.replace("-", "_"),
        find_command=FIND_COMMAND.format(commands="|".join(program.commands)) if program.commands else "",
        values="\n".join(value_cases(helps)),
        offered="\n".join(word_case(command, parsed, program.commands if not command else ())
                        for command, parsed in helps.items()))
