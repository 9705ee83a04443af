"""The reader of command blocks, the checker of links, and the pages that are made of programs and sources."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import paths  # noqa: F401  (makes website importable)
from website import python_api, schema_page
from website.blocks import PageError, matches, read_blocks, run_page
from website.links import anchors_of, faults_of_links
from website.mirror import page_of


def fenced(kind, *lines):
    return "\n".join([f"```{kind}", *lines, "```", ""])


class ReadBlocks(unittest.TestCase):
    def test_knows_line_kind_text_and_reason(self):
        text = "# A\n\n" + fenced("sh", "a", "b") + "\n<!-- no-run: no cluster -->\n" + fenced("sh", "sbatch x")
        first, second = read_blocks(text)
        self.assertEqual((first.line, first.kind, first.text, first.reason), (3, "sh", "a\nb", ""))
        self.assertEqual((second.line, second.text, second.reason), (9, "sbatch x", "no cluster"))

    def test_refuses_what_it_would_pass_over(self):
        for text in (fenced("", "podm"), fenced("bash", "podm"), fenced("console", "podm"), "```sh\npodm\n",
                     fenced("text", "shown"), fenced("toml", "a = 1") + fenced("text", "shown"),
                     "<!-- no-run: why -->\nwords\n\n" + fenced("sh", "podm"),
                     "<!-- no-run: why -->\n" + fenced("text", "shown"),
                     "<!-- no-run: why -->\n" + fenced("sh", "podm") + fenced("text", "shown")):
            with self.subTest(text=text), self.assertRaises(PageError):
                read_blocks(text)


class Matches(unittest.TestCase):
    def test_dots_stand_for_characters_and_lines(self):
        output = "a 1\nb 22 c  \n\nd\n"
        for shown in ("a 1\nb 22 c\n\nd", "a ...\nb ... c\n...\nd", "...\nd", "a 1\n...", "...",
                      "a 1\nb 22 c\n\nd\n..."):
            with self.subTest(shown=shown):
                self.assertTrue(matches(shown, output))

    def test_anything_else_differs(self):
        for shown in ("a 1", "b 22 c\n\nd", "a 2\n...", "a 1\n...\nb", "a .\n...", "a 1\nb ...\nd"):
            with self.subTest(shown=shown):
                self.assertFalse(matches(shown, "a 1\nb 22 c\n\nd\n"))


class RunPage(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_text(self, *blocks):
        return run_page("\n".join(blocks), self.folder, {"NAME": "value"})

    def test_runs_in_order_in_one_folder_and_compares_what_is_shown(self):
        faults = self.run_text(fenced("sh", "echo 1 > file", "echo seen; echo warned >&2"), fenced("text", "seen"),
                               fenced("text stderr", "warned"), fenced("python", "print(open('file').read())"),
                               fenced("text", "1"), fenced("sh", "echo $NAME"), fenced("text", "value"))
        self.assertEqual(faults, [])

    def test_a_command_that_fails_is_a_fault_wherever_it_stands(self):
        for commands in ("no-such-program", "false\ntrue", "false | true", "echo $UNSET"):
            with self.subTest(commands=commands):
                self.assertRegex("\n".join(self.run_text(fenced("sh", commands))), "^1: it ends with exit code")
        self.assertRegex("\n".join(self.run_text(fenced("python", "import no_such_module"))), "^1: it ends")

    def test_what_follows_a_failure_is_not_run(self):
        self.assertEqual(len(self.run_text(fenced("sh", "false"), fenced("sh", "touch made"))), 1)
        self.assertFalse((self.folder / "made").exists())

    def test_a_wrong_output_is_a_fault(self):
        for kind in ("text", "text stderr"):
            with self.subTest(kind=kind):
                self.assertRegex("\n".join(self.run_text(fenced("sh", "echo a; echo a >&2"), fenced(kind, "b"))),
                                 "^5: the output is not what the page shows")

    def test_a_marked_block_is_not_run(self):
        self.assertEqual(self.run_text("<!-- no-run: it waits -->", fenced("sh", "touch made")), [])
        self.assertFalse((self.folder / "made").exists())


class Links(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name).resolve()
        (self.root / "docs").mkdir()
        (self.root / "README.md").write_text("# The *First* `page`, 1\n\n## Twice\n\n## Twice\n")
        (self.root / "a.png").write_text("")

    def faults(self, text):
        page = self.root / "docs" / "page.md"
        page.write_text(text)
        return faults_of_links(self.root, [page])

    def test_files_headings_and_pictures_that_are_there(self):
        text = ("## Here\n[a](../README.md) [b](../README.md#the-first-page-1) [c](../README.md#twice-1) [d](#here)\n"
                "![e](../a.png) [f](https://example.org) `[g](none.md)` [h](.)\n\n```text\n[i](none.md)\n```\n")
        self.assertEqual(self.faults(text), [])

    def test_those_that_are_not(self):
        for link in ("[a](none.md)", "![a](none.png)", "[a](../README.md#none)", "[a](#none)",
                     "[a](../README.md#twice-2)", "[a](../../../etc/passwd)", "[a](../a.png#heading)"):
            with self.subTest(link=link):
                fault, = self.faults(f"# Here\n\n{link}\n")
                self.assertTrue(fault.startswith("docs/page.md:3: "), fault)

    def test_anchors_are_those_of_github(self):
        self.assertEqual(anchors_of("# The way of `the` data\n## What's new?\n## A [link](b.md)\n"),
                         {"the-way-of-the-data", "whats-new", "a-link"})


class Pages(unittest.TestCase):
    def test_a_page_of_the_site_has_no_comments_and_links_to_files_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder).resolve()
            (root / "rooms").mkdir()
            (root / "code").mkdir()
            (root / "rooms" / "README.md").write_text("# Rooms\n")
            page = root / "a.md"
            page.write_text("# A\n\n7<!--q x; y--> [rooms](rooms) [code](code) [rooms](rooms/README.md)\n\n"
                            "```text\n<!-- kept -->\n```\n")
            text, files = page_of(root, page)
            self.assertEqual(text, "# A\n\n7 [rooms](rooms/README.md) code [rooms](rooms/README.md)\n\n"
                                   "```text\n<!-- kept -->\n```\n")
            self.assertEqual(files, [])

    def test_the_python_api_has_every_public_name_with_its_text(self):
        text = python_api.page(paths.SCRIPTS.parent / "mesher" / "python" / "podm")
        for words in ("## mesh", "## plan", "## Mesh", "### points", "### verify", "## Verification", "### holds",
                      "## Interrupted", "## Progress", "Meshes a label image into tetrahedra."):
            self.assertIn(words, text)
        self.assertNotIn("_made", text)
        self.assertIn("```python\ntry:\n    mesh = podm.mesh(labels, radius=0.5)\n", text)

    def test_a_schema_becomes_a_table_with_a_line_for_each_key(self):
        schema = {"title": "T", "required": ["a"], "$defs": {"n": {"type": "integer", "minimum": 1}}, "properties": {
            "a": {"type": "object", "properties": {"b": {"$ref": "#/$defs/n", "description": "one | two"}}},
            "c": {"type": "array", "items": {"enum": ["x", "y"]}}}}
        lines = schema_page.page(schema).splitlines()
        self.assertIn("| `a` | object |  | always |", lines)
        self.assertIn("| `a.b` | integer, at least 1 | one \\| two |  |", lines)
        self.assertIn('| `c[]` | `"x"`, `"y"` |  |  |', lines)


class Program(unittest.TestCase):
    def test_bad_usage(self):
        process = subprocess.run([sys.executable, "-B", paths.SCRIPTS / "make_docs", "--no-such"], capture_output=True,
                                 text=True, check=False)
        self.assertEqual(process.returncode, 2)
        self.assertIn("usage:", process.stderr)


if __name__ == "__main__":
    unittest.main()
