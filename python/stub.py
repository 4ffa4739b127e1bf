"""Makes the stub of the package: mjdiag/__init__.pyi.in, which has what types alone do not
say, and in every class of it the properties that it leaves out, typed as pybind11 has them.

    stub.py <folder of the built package> <__init__.pyi.in>
"""

import ast
import os
import re
import sys

sys.path[0] = sys.argv[1]  # the folder of this file has a mjdiag, too, with no module in it

import mjdiag  # noqa: E402

AS_PYTHON_WRITES = [("numpy.ndarray[numpy.float64]", "_Array"), ("mjdiag._mjdiag.", ""),
                    ("List[", "list["), ("Dict[", "dict["), ("Tuple[", "tuple[")]
SAYS_TOO_LITTLE = re.compile(r"\b(object|dict|list|tuple|handle)\b(?!\[)|::|numpy")


def type_of(name, getter):
    """What the signature of a getter, "(self: mjdiag._mjdiag.Kind) -> str", ends with."""
    written = (getter.__doc__ or "").strip().rpartition(" -> ")[2]
    for bound, python in AS_PYTHON_WRITES:
        written = written.replace(bound, python)
    if not written or SAYS_TOO_LITTLE.search(written):
        raise SystemExit(f"{name}: pybind11 has the type '{written}'; expected one in "
                         "__init__.pyi.in, or a C++ type that says more")
    return written


def properties(node):
    """Lines of those that a class has and its node lacks."""
    there = {member.name for member in node.body if isinstance(member, ast.FunctionDef)}
    lines = []
    for name, member in vars(getattr(mjdiag, node.name)).items():
        if isinstance(member, property) and name not in there:
            kind = type_of(f"{node.name}.{name}", member.fget)
            lines += ["    @property", f"    def {name}(self) -> {kind}: ..."]
    return lines


def stub(text):
    lines = text.splitlines()
    for node in reversed(ast.parse(text).body):
        made = properties(node) if isinstance(node, ast.ClassDef) else []
        if made:
            lines[node.end_lineno - 1] = re.sub(r"^(class .*:) \.\.\.$", r"\1",
                                                lines[node.end_lineno - 1])
            lines[node.end_lineno:node.end_lineno] = made
    return "\n".join(lines) + "\n"


def main():
    target = os.path.join(os.path.dirname(mjdiag.__file__), "__init__.pyi")
    with open(sys.argv[2], encoding="utf-8") as file:
        made = stub(file.read())
    with open(target + ".part", "w", encoding="utf-8") as file:
        file.write(made)
    os.replace(target + ".part", target)


if __name__ == "__main__":
    main()
