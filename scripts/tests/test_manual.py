"""Tests that manual pages and shell completions of the built programs match --help, and that shells can use them."""
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import paths  # noqa: F401  # scripts/ on the path
from manual import help_text

BUILD = Path(os.environ["PODM_BUILD"])
PROGRAMS = [path for path in (BUILD / "bin" / name for name in ("podm", "podm-mpi", "podm-verify", "podm-verify-mpi",
                                                        "podm-bench"))
            if path.exists()]

# Calls the shell's completion function with the given words; the last word may be incomplete.
COMPLETED_BY = {
    "bash": ["bash", "-c", 'source "$1"; shift; function=$1; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); '
                           '$function; printf "%s\\n" "${COMPREPLY[@]}"', "bash"],
    "zsh": ["zsh", "-fc", 'autoload -U compinit bashcompinit; compinit -uD; bashcompinit; source "$1"; shift; '
                          'function=$1; shift; setopt kshglob noshglob bareglobqual ksharrays shwordsplit; '
                          'COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); $function; printf "%s\\n" "${COMPREPLY[@]}"',
            "zsh"],
}


def printed_by(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def helps_of(program):
    """Returns for the program and each of its commands the words that call it and the output of --help."""
    text = printed_by(program, "--help")
    commands = re.findall(r"^  (\w+)  ", text.partition("Subcommands:")[2], re.MULTILINE)
    return [([], text), *(([command], printed_by(program, command, "--help")) for command in commands)]


def options_in(text):
    return re.findall(r"^  (?:-\w,)?(--[\w-]+)", text, re.MULTILINE)


def plain(page):
    """Returns the text of a page without groff's escapes."""
    return re.sub(r"\\f.|\\&", "", page).replace(r"\-", "-")


class Pages(unittest.TestCase):
    def page(self, program):
        return (BUILD / "share/man/man1" / f"{program.name}.1").read_text()

    def test_all_that_help_prints_is_in_them(self):
        for program in PROGRAMS:
            page = plain(self.page(program)).lower()
            for called, text in helps_of(program):
                for word in re.findall(r"\S+", re.sub(r"^(Usage: .*|[A-Z].*:)$", "", text, flags=re.MULTILINE)):
                    if word not in ("Exit", "codes:"):
                        for name in word.split(","):
                            self.assertIn(name.rstrip(".").lower(), page, f"{program.name} {called}")

    def test_they_state_one_version(self):
        versions = {printed_by(program, "--version").splitlines()[0].split()[-1] for program in PROGRAMS}
        self.assertEqual(len(versions), 1)
        for program in PROGRAMS:
            self.assertIn(f'"podm {versions.copy().pop()}"', self.page(program).splitlines()[0])

    def test_groff_finds_no_fault(self):
        for program in PROGRAMS:
            process = subprocess.run(["groff", "-man", "-Tutf8", "-ww"], input=self.page(program),
                                     capture_output=True, text=True)
            self.assertEqual((process.returncode, process.stderr), (0, ""), program.name)


class Completions(unittest.TestCase):
    def complete(self, shell, *words, folder="/"):
        file = BUILD / "share/bash-completion/completions" / words[0]
        function = "_" + words[0].replace("-", "_")
        process = subprocess.run([*COMPLETED_BY[shell], file, function, *words], cwd=folder,
                                 capture_output=True, text=True)
        self.assertEqual((process.returncode, process.stderr), (0, ""), words)
        offered = process.stdout.splitlines()
        return {word for word in offered if word and word.startswith(words[-1])}  # as zsh does by itself

    def test_every_option_and_command_is_offered(self):
        for program in PROGRAMS:
            for called, text in helps_of(program):
                offered = self.complete("bash", program.name, *called, "--")
                self.assertEqual(offered, set(options_in(text)), (program.name, called))
                if called == ["mesh"]:
                    self.assertEqual(self.complete("zsh", program.name, *called, "--"), offered)
        for shell in COMPLETED_BY:
            self.assertEqual(self.complete(shell, "podm", "m"), {"mesh"})

    def test_what_an_option_takes(self):
        for shell in COMPLETED_BY:
            pdr = {"pdr", "pdr-podm"}
            self.assertEqual(self.complete(shell, "podm", "mesh", "--algorithm", "pd"), pdr)
            self.assertEqual(self.complete(shell, "podm", "mesh", "--algorithm", "=", "pd"), pdr)
            self.assertEqual(self.complete(shell, "podm", "phantom", "t"), {"torus"})
            self.assertEqual(self.complete(shell, "podm", "mesh", "--radius", ""), set())

    def test_files_are_offered_where_files_are_taken(self):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "my liver.nii").touch()
            for shell in COMPLETED_BY:
                for words in (["podm", "mesh", "my"], ["podm", "mesh", "--record", "my"], ["podm-verify", "my"],
                              ["podm", "mesh", "-o", "my"], ["podm", "mesh", "--record", "=", "my"]):
                    self.assertEqual(self.complete(shell, *words, folder=folder), {"my liver.nii"}, (shell, words))
                self.assertEqual(self.complete(shell, "podm", "mesh", "--threads", "", folder=folder), set())


class HelpText(unittest.TestCase):
    def test_what_is_no_help_is_refused_with_the_line(self):
        for text, fault in (("Segmentation fault\n", "Segmentation fault"),
                            ("what\nUsage: p\n\nOptions:\n   --lost\n", "--lost"),
                            ("what\nUsage: p\n\nOptions:\n  --in, in two words\n", "in two words")):
            with self.assertRaisesRegex(help_text.HelpError, fault):
                help_text.parse(text)

    def test_entries(self):
        parsed = help_text.parse("what it does\nUsage: p [OPTIONS]\n\nSome:\n  -o,--output MESH    a file\n"
                               "                      of tets\n  --way a|b\n                      one\n  --flag\n\n"
                               "The end,\nin two lines.\n\nExit codes: 0 ok.\n")
        output, way, flag = parsed.group("Some").entries
        self.assertEqual((output.names, output.type, output.text), (["-o", "--output"], "MESH", "a file of tets"))
        self.assertEqual((way.choices, way.text, flag.type), (["a", "b"], "one", ""))
        self.assertEqual(parsed.end, ["The end, in two lines.", "Exit codes: 0 ok."])


if __name__ == "__main__":
    unittest.main()
