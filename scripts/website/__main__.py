"""Builds the documentation as a site that needs no network: pages of the tree, of the programs' options, of the
schemas, and of both APIs.

Needs Debian's mkdocs, mkdocs-material and doxygen. Exit codes: 0 made, 1 a step failed, 2 bad usage or input.
"""
import argparse
import json
import shutil
import subprocess
import sys
from pathlib import Path

from docs.audit import pages_of
from manual.program import HelpError, Program

from . import options_page, python_api, schema_page
from .mirror import mirror

ROOT = Path(__file__).resolve().parents[2]
PROGRAMS = ("podm", "podm-mpi", "podm-verify", "podm-verify-mpi", "podm-bench")
STYLE = "docs/site.css"
SCHEMAS = ("podm-bench-row", "podm-verify")


def generated_pages(programs):
    """{path below the root: text} of the pages that are not in the tree."""
    pages = {"docs/reference/python_api.md": python_api.page(ROOT / "mesher" / "python" / "podm")}
    for name in SCHEMAS:
        schema = json.loads((ROOT / "results" / "schema" / f"{name}.schema.json").read_text(encoding="utf-8"))
        pages[f"docs/reference/schema_{name}.md"] = schema_page.page(schema)
    for name in PROGRAMS:
        pages[f"docs/reference/options_{name}.md"] = options_page.page(Program.asked(programs / name))
    return pages


def doxygen(folder):
    """The C++ API into FOLDER/cpp."""
    settings = (ROOT / "docs" / "Doxyfile").read_text(encoding="utf-8")
    subprocess.run(["doxygen", "-"], input=f"{settings}\nOUTPUT_DIRECTORY = {folder}\n", text=True, cwd=ROOT,
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="make_docs", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", type=Path, default=ROOT / "build" / "bin",
                        help="folder of the programs whose options are shown (default: build/bin)")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "build" / "docs",
                        help="folder for pages/ and site/ (default: build/docs)")
    options = parser.parse_args(arguments)
    for tool in ("mkdocs", "doxygen"):
        if shutil.which(tool) is None:
            print(f"make_docs: {tool} is not installed; scripts/setup docs installs it", file=sys.stderr)
            return 2
    pages, site = options.output.resolve() / "pages", options.output.resolve() / "site"
    shutil.rmtree(pages, ignore_errors=True)
    try:
        mirror(ROOT, pages_of(ROOT), pages)
        shutil.copyfile(ROOT / STYLE, pages / STYLE)
        for name, text in generated_pages(options.programs).items():
            (pages / name).write_text(text, encoding="utf-8")
        doxygen(pages)
        configuration = (ROOT / "docs" / "mkdocs.yml").read_text(encoding="utf-8")
        (options.output / "mkdocs.yml").write_text(configuration, encoding="utf-8")
        subprocess.run(["mkdocs", "build", "--quiet", "--strict", "--clean", "--config-file",
                        options.output.resolve() / "mkdocs.yml", "--site-dir", site], check=True)
    except (HelpError, OSError) as error:
        print(f"make_docs: {error}", file=sys.stderr)
        return 2
    except subprocess.CalledProcessError as error:
        print(f"make_docs: {error.cmd[0]} failed with exit code {error.returncode}", file=sys.stderr)
        return 1
    print(f"make_docs: {site / 'index.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
