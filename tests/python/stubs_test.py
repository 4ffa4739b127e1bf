"""The stubs say what the package has, and everything in it is documented."""

import ast
import inspect
import os
import re
import unittest

import mjdiag

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

    def test_properties_are_documented(self):
        for name in mjdiag.__all__:
            for key, value in vars(getattr(mjdiag, name)).items():
                if isinstance(value, property):
                    self.assertTrue(value.__doc__, f"{name}.{key}")


if __name__ == "__main__":
    unittest.main()
