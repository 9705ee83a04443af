"""help(podm) describes the actual interface."""

import ast
import inspect
import json
import pathlib
import pydoc
import typing
import unittest

import numpy as np
import numpy.typing

import podm
from podm import _podm

OF_THE_IMAGE = {"labels", "affine", "spacing", "progress"}  # not options of the program


OPTIONS = [option for option in json.loads(_podm.options()) if "python" in option["uses"]]


def option_keywords():
    return {option["keyword"] for option in OPTIONS}


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

    def test_flags_default_to_false_and_nothing_else_does(self):
        flags = {option["keyword"] for option in OPTIONS if option["kind"] == "flag"}
        self.assertTrue(flags)
        parameters = inspect.signature(podm.mesh).parameters.values()
        self.assertEqual({parameter.name for parameter in parameters if parameter.default is False}, flags)

    def test_plan_has_the_options_that_a_plan_depends_on(self):
        keywords = set(inspect.signature(podm.plan).parameters) - OF_THE_IMAGE
        of_plan = {option["keyword"] for option in OPTIONS if "plan" in option["uses"] or option["group"] == "Labels"}
        self.assertEqual(keywords, of_plan)

    def test_help_lists_every_option_with_its_default(self):
        text = podm.mesh.__doc__
        for keyword in option_keywords():
            self.assertRegex(text, rf"(?m)^ +{keyword}( |$)")
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
        names = {"npt": numpy.typing, "StrPath": str}
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

    def test_the_generated_stub_has_the_keywords_of_both_functions(self):
        stub = ast.parse(pathlib.Path(podm.__file__).with_name("meshing.pyi").read_text())
        declared = {node.name: node for node in stub.body if isinstance(node, ast.FunctionDef)}
        for function in podm.mesh, podm.plan:
            names = {parameter.arg for parameter in declared[function.__name__].args.kwonlyargs}
            self.assertEqual(names | {"labels"}, set(inspect.signature(function).parameters))

    def test_properties_have_the_types_that_the_stub_tells(self):
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


if __name__ == "__main__":
    unittest.main()
