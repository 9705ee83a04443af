"""Reads the fenced blocks of a Markdown page, and runs its commands in the order of the page.

    ```sh             commands for bash, which stops at the first that fails
    ```python         a script
    ```text           what the block before prints on standard output; `text stderr`: on standard error
    ```toml, cmake    a file, which is not run
    <!-- no-run: WHY -->   before a block of commands: it is not run

In a shown output `...` stands for any characters of a line, and alone on a line for any lines.
"""
import itertools
import os
import re
import subprocess
import sys
from dataclasses import dataclass

COMMANDS, SHOWN, FILES = ("sh", "python"), ("text", "text stderr"), ("toml", "cmake", "cpp", "json", "bibtex")
FENCE = re.compile(r"^ {0,3}```(.*)$")
NO_RUN = re.compile(r"^<!-- no-run: (\S.*) -->$")
TIMEOUT_S = 300


class PageError(Exception):
    """A page that cannot be read; the text names line and fault."""


@dataclass(frozen=True)
class Block:
    """`line`: that of its fence, from 1. `reason`: why it is not run, or empty."""

    line: int
    kind: str
    text: str
    reason: str = ""


def read_blocks(text):
    """The blocks of a page, in its order. Raises PageError."""
    blocks, lines = [], text.split("\n")
    start = reason = None
    for number, line in enumerate(lines, 1):
        if start is None:
            if found := FENCE.match(line):
                start, kind = number, found[1].strip()
                _check_kind(number, kind, reason)
            elif found := NO_RUN.match(line):
                reason = found[1]
            elif line.strip() and reason:
                raise PageError(f"{number}: a mark 'no-run' without a block behind it")
        elif line.strip() == "```":
            blocks.append(Block(start, kind, "\n".join(lines[start:number - 1]), reason or ""))
            start = reason = None
    if start is not None:
        raise PageError(f"{start}: a block without an end")
    _check_order(blocks)
    return blocks


def _check_kind(number, kind, reason):
    if kind not in (*COMMANDS, *SHOWN, *FILES):
        raise PageError(f"{number}: a block of kind '{kind}': {', '.join((*COMMANDS, *SHOWN, *FILES))}")
    if reason and kind not in COMMANDS:
        raise PageError(f"{number}: a mark 'no-run' before a block that holds no commands")


def _check_order(blocks):
    for before, block in itertools.pairwise([Block(0, "", ""), *blocks]):
        if block.kind in SHOWN and (before.kind not in (*COMMANDS, *SHOWN) or before.reason):
            raise PageError(f"{block.line}: a shown output without commands that run before it")


def run_page(text, folder, environment):
    """Runs a page in `folder`, an empty one. Returns its faults: "line: words"."""
    try:
        blocks = read_blocks(text)
    except PageError as error:
        return [str(error)]
    faults, printed = [], {}
    for block in blocks:
        if block.kind in SHOWN:
            output = printed["stderr" if block.kind.endswith("stderr") else "stdout"]
            if not matches(block.text, output):
                faults.append(f"{block.line}: the output is not what the page shows:\n{output}")
        elif block.kind in COMMANDS and not block.reason:
            printed, fault = _run(block, folder, environment)
            if fault:  # what follows on the page needs what this block makes
                return [*faults, f"{block.line}: {fault}:\n{printed['stderr'][-2000:]}"]
    return faults


def _run(block, folder, environment):
    """({"stdout", "stderr"}, what went wrong or None)."""
    shell = ["bash", "-e", "-u", "-o", "pipefail", "-c"]
    command = [*shell, block.text] if block.kind == "sh" else [sys.executable, "-B", "-c", block.text]
    try:
        process = subprocess.run(command, cwd=folder, env={**os.environ, **environment}, stdin=subprocess.DEVNULL,
                                 capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
    except subprocess.TimeoutExpired:
        return {"stdout": "", "stderr": ""}, f"it takes more than {TIMEOUT_S} s"
    fault = f"it ends with exit code {process.returncode}" if process.returncode else None
    return {"stdout": process.stdout, "stderr": process.stderr}, fault


def matches(shown, output):
    """True if the output is the shown one; spaces at ends of lines do not count."""
    pattern = ""
    for line in shown.rstrip().split("\n"):
        if line.strip() == "...":
            pattern += r"(?:[^\n]*\n)*"
        else:
            pattern += r"[^\n]*".join(map(re.escape, line.rstrip().split("..."))) + r"\n"
    lines = [line.rstrip() for line in output.rstrip().split("\n")]
    return re.fullmatch(pattern, "\n".join(lines) + "\n") is not None
