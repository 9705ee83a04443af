"""What help(podm) says is what there is."""

import inspect
import pydoc
import re
import typing
import unittest

import podm
from podm import _podm

OF_THE_IMAGE = {"labels", "affine", "spacing", "progress"}  # no option of the program


def option_keywords():
    options = set(re.findall(r"^  --([a-z-]+)", _podm.options_help(), re.MULTILINE))
    return {_podm.in_python_terms("--" + option) for option in options}


class DocumentationTest(unittest.TestCase):
    def test_every_option_is_a_keyword_and_every_keyword_an_option(self):
        self.assertEqual(set(inspect.signature(podm.mesh).parameters) - OF_THE_IMAGE, option_keywords())

    def test_no_default_is_told_twice(self):
        """They are the program's: a keyword's own default only says that it was not given."""
        defaults = {parameter.default for parameter in inspect.signature(podm.mesh).parameters.values()}
        self.assertEqual(defaults, {inspect.Parameter.empty, None, False})

    def test_help_tells_of_every_option_with_its_default(self):
        text = podm.mesh.__doc__
        for keyword in option_keywords():
            self.assertRegex(text, rf"(?m)^ +{keyword} ")
        self.assertIn("[default: podm]", text)
        self.assertNotRegex(text, r"--[a-z]")

    def test_everything_public_says_what_it_is(self):
        for name in set(podm.__all__) - {"__version__"}:
            self.assertTrue(inspect.getdoc(getattr(podm, name)), name)
        for name, member in inspect.getmembers(podm.Mesh):
            if not name.startswith("_"):
                self.assertTrue(inspect.getdoc(member), name)

    def test_help_is_narrow(self):
        for text in (pydoc.plain(pydoc.render_doc(podm)), pydoc.plain(pydoc.render_doc(podm.Mesh))):
            lines = [line for line in text.splitlines() if "->" not in line]  # signatures are one line each
            self.assertLessEqual(max(map(len, lines)), 130)
        self.assertEqual(podm.Mesh.__module__, "podm")

    def test_hints_name_types_that_there_are(self):
        import numpy.typing
        names = {"npt": numpy.typing, "StrPath": str, "LabelValues": int}
        self.assertEqual(typing.get_type_hints(podm.mesh, localns=names)["return"], podm.Mesh)

    def test_the_stub_declares_what_the_extension_module_has(self):
        import ast
        import pathlib
        tree = ast.parse(pathlib.Path(podm.__file__).with_name("_podm.pyi").read_text())
        declared = {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
        self.assertEqual(set(declared), {name for name in vars(_podm) if not name.startswith("_")})
        for name in ("MeshInMemory", "Progress"):
            members = {node.name for node in declared[name].body if isinstance(node, ast.FunctionDef)}
            self.assertEqual(members, {member for member in vars(getattr(_podm, name)) if not member.startswith("_")})

    def test_options_in_messages_are_keywords(self):
        for message, expected in (("--radius-of liver: '0'", "radius_of liver: '0'"),
                                  ("use --max-memory-gib\nSee 'podm mesh --help'.", "use max_memory_gib"),
                                  ("--labels and --label-names", "keep and names"),
                                  ("a--b.nii: no, and a/--c.nii", "a--b.nii: no, and a/--c.nii")):
            self.assertEqual(_podm.in_python_terms(message), expected)


if __name__ == "__main__":
    unittest.main()
