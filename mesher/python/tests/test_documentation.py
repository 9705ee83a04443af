"""help(podm) describes the actual interface."""

import ast
import inspect
import pathlib
import pydoc
import re
import typing
import unittest

import numpy as np
import numpy.typing

import podm
from podm import _podm, arguments

OF_THE_IMAGE = {"labels", "affine", "spacing", "progress"}  # not options of the program


def option_keywords():
    options = set(re.findall(r"^  --([a-z-]+)", _podm.options_help(), re.MULTILINE))
    return {_podm.in_python_terms("--" + option) for option in options}


def documented_signature(function):
    """Returns the definition in the first line of pybind11's docstring."""
    return ast.parse(f"def {function.__doc__.splitlines()[0]}: ...").body[0]


def signature_of(definition):
    """Returns the names of parameters, the number of defaults, and the outermost return type: list for List[str]."""
    given = definition.args
    names = [parameter.arg for parameter in given.posonlyargs + given.args + given.kwonlyargs]
    return names, len(given.defaults), ast.unparse(definition.returns).partition("[")[0].lower()


class DocumentationTest(unittest.TestCase):
    def test_every_option_is_a_keyword_and_every_keyword_an_option(self):
        self.assertEqual(set(inspect.signature(podm.mesh).parameters) - OF_THE_IMAGE, option_keywords())

    def test_no_default_is_stated_twice(self):
        """The program has the defaults: a keyword's own default only means that it was not given."""
        defaults = {parameter.default for parameter in inspect.signature(podm.mesh).parameters.values()}
        self.assertEqual(defaults, {inspect.Parameter.empty, None, False})

    def test_flags_are_the_options_without_a_value(self):
        flags = re.findall(r"^  --([a-z-]+)(?:  |$)", _podm.options_help(), re.MULTILINE)
        self.assertEqual({_podm.in_python_terms("--" + flag) for flag in flags} - {"help"}, arguments.FLAGS)
        parameters = inspect.signature(podm.mesh).parameters.values()
        self.assertEqual({parameter.name for parameter in parameters if parameter.default is False}, arguments.FLAGS)

    def test_help_lists_every_option_with_its_default(self):
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
        names = {"npt": numpy.typing, "StrPath": str, "LabelValues": int}
        self.assertEqual(typing.get_type_hints(podm.mesh, localns=names)["return"], podm.Mesh)

    def test_the_stub_declares_what_the_extension_module_has(self):
        stub = ast.parse(pathlib.Path(podm.__file__).with_name("_podm.pyi").read_text())
        self.assert_declared(stub, _podm)

    def assert_declared(self, tree, owner):
        """Checks that names, signatures and properties are those of the module or class."""
        declared = {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
        members = {name: member for name, member in vars(owner).items() if not name.startswith("_")}
        self.assertEqual(set(declared), set(members))
        for name, node in declared.items():
            if isinstance(node, ast.ClassDef):
                self.assert_declared(node, members[name])
            elif node.decorator_list:
                self.assertEqual([decorator.id for decorator in node.decorator_list], ["property"], name)
                self.assertIsInstance(members[name], property, name)
            else:
                self.assertEqual(signature_of(node), signature_of(documented_signature(members[name])), name)

    def test_properties_have_the_types_that_the_stub_declares(self):
        stub = ast.parse(pathlib.Path(podm.__file__).with_name("_podm.pyi").read_text())
        made = podm.mesh("phantom:spheres@24", radius=5)._made
        names = {"np": np, "npt": np.typing}
        [mesh_in_memory] = [node for node in stub.body if getattr(node, "name", None) == "MeshInMemory"]
        for node in mesh_in_memory.body:
            if node.decorator_list:
                declared = eval(ast.unparse(node.returns), names)
                value = getattr(made, node.name)
                self.assertIsInstance(value, typing.get_origin(declared) or declared, node.name)
                if isinstance(value, np.ndarray):
                    self.assertEqual(np.dtype(typing.get_args(typing.get_args(declared)[1])[0]), value.dtype, node.name)

    def test_options_in_messages_are_keywords(self):
        for message, expected in (("--radius-of liver: '0'", "radius_of liver: '0'"),
                                  ("use --max-memory-gib\nSee 'podm mesh --help'.", "use max_memory_gib"),
                                  ("--labels and --label-names", "keep and names"),
                                  ("a--b.nii: no, and a/--c.nii", "a--b.nii: no, and a/--c.nii")):
            self.assertEqual(_podm.in_python_terms(message), expected)


if __name__ == "__main__":
    unittest.main()
