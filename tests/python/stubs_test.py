"""The stubs say what the package has, and everything in it is documented."""

import ast
import inspect
import os
import re
import subprocess
import unittest

import mjdiag
from support import COMMAND

STUB = os.path.join(os.path.dirname(mjdiag.__file__), "__init__.pyi")


def stub_classes():
    with open(STUB) as file:
        tree = ast.parse(file.read())
    return {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}


def arguments_of(function):
    """Names in a stub, self left out."""
    names = [arg.arg for arg in function.args.args + function.args.kwonlyargs]
    return [name for name in names if name != "self"]


def bound_arguments(member, doc):
    """Names in the first line that pybind11 writes."""
    if inspect.isfunction(member):
        return list(inspect.signature(member).parameters)[1:]
    inside = doc.split("\n", 1)[0]
    inside = inside[inside.index("(") + 1:inside.rindex(")")]
    names = re.findall(r"(?:^|, )(\w+)(?=: )", inside)
    return [name for name in names if name != "self"]


class StubsTest(unittest.TestCase):
    def test_have_every_public_name(self):
        public = set(mjdiag.__all__)
        self.assertEqual(set(stub_classes()), public)
        for name in public:
            self.assertEqual(getattr(mjdiag, name).__module__, "mjdiag")
            self.assertTrue(inspect.getdoc(getattr(mjdiag, name)), name)

    def test_have_every_member_and_argument(self):
        for name, stub in stub_classes().items():
            bound = getattr(mjdiag, name)
            if bound.__mro__[1] is not object and not issubclass(bound, mjdiag.Record):
                continue  # tuples and errors
            members = {node.name: node for node in stub.body
                       if isinstance(node, ast.FunctionDef)}
            own = {key for key in vars(bound) if not key.startswith("_")}
            self.assertEqual({key for key in members if not key.startswith("_")}, own,
                             name)
            for key in own:
                doc = inspect.getdoc(getattr(bound, key))
                if isinstance(vars(bound)[key], property):
                    continue
                self.assertIn("\n", doc, f"{name}.{key} says nothing")
                self.assertNotIn("::", doc.split("\n")[0])
                self.assertEqual(arguments_of(members[key]), bound_arguments(getattr(bound, key), doc),
                                 f"{name}.{key}")

    @unittest.skipUnless(COMMAND, "needs the command, $MJDIAG_COMMAND")
    def test_have_the_figures_of_an_answer_as_the_command_describes_them(self):
        for command, path, name in [("compare", "channels.<name>.", "Mismatch"),
                                    ("discover", "causes[].parameters.<name>.", "Parameter"),
                                    ("diagnose", "faults[].", "Fault")]:
            said = subprocess.run([COMMAND, command, "--fields"], check=True,
                                  capture_output=True, text=True).stdout
            stub = {node.name: ast.unparse(node.returns) for node in stub_classes()[name].body}
            rows = [row.removeprefix(path) for row in said.splitlines() if row.startswith(path)]
            described = [row for row in rows if "." not in row.split(" ")[0].rstrip(":")]
            self.assertGreater(len(described), 3)
            for row in described:
                field, unit, words = re.fullmatch(r"(\w+)( \[.*?\])?: (.*)", row).groups("")
                self.assertIn(field, stub)
                if field != "worst_window":  # a tuple in Python
                    doc = getattr(mjdiag, name).__dict__[field].__doc__
                    self.assertEqual(" ".join(doc.split()), words + unit)

    def test_properties_are_documented(self):
        for name in mjdiag.__all__:
            for key, value in vars(getattr(mjdiag, name)).items():
                if isinstance(value, property):
                    self.assertTrue(value.__doc__, f"{name}.{key}")


if __name__ == "__main__":
    unittest.main()
