"""Where the equations of docs/theory.md are in the sources. Below each of them stands

    Code: [`TickModel`](../diagnosis/model/mechanical_model.h)

the names that have it, each with its file.
"""

import re
from dataclasses import dataclass

LINK = re.compile(r"\[`([\w:]+)`\]\(\.\./([^)\s]+)\)")
COMMENT = re.compile(r"//[^\n]*")


@dataclass
class Equation:
    first: int  # line of the text, from 0
    lines: list
    indent: str  # of the list that it stands in
    code: list  # (name, file) of what has it
    end: int  # line behind it and its code


def equations(text):
    """All equations of a text: indented blocks, with the line of code that follows."""
    lines, found, at, before, fenced = text.split("\n"), [], 0, "", False
    while at < len(lines):
        line = lines[at]
        fenced ^= line.lstrip().startswith("```")
        if fenced or not line.startswith("    ") or at == 0 or lines[at - 1].strip():
            before = line if line.strip() else before
            at += 1
            continue
        first = at
        while at < len(lines) and (lines[at].startswith("    ") or not lines[at].strip()):
            at += 1
        block = "\n".join(lines[first:at]).rstrip().split("\n")
        code = []
        if at < len(lines) and lines[at].lstrip().startswith("Code: "):
            while at < len(lines) and lines[at].strip():
                code += LINK.findall(lines[at])
                at += 1
        found.append(Equation(first, block, re.match(" *", before)[0], code, at))
    return found


def declaration(source, name):
    """Where a source has a name, as lines from 0: the comment before it, its first line and
    the last one of what is declared. None if it has not, outside of comments."""
    lines = source.split("\n")
    plain = [COMMENT.sub("", line) for line in lines]
    scope, _, own = name.rpartition("::")
    begin, end = 0, len(lines)
    if scope and not any(re.search(rf"\b{re.escape(name)}\(", line) for line in plain):
        begin = next((k for k, line in enumerate(plain)
                      if re.match(rf"\s*(class|struct) {scope}\b", line)), None)
        if begin is None:
            return None
        end = next((k for k in range(begin, len(lines)) if lines[k].startswith("};")), end)
    elif scope:
        own = name  # its definition
    kind = re.compile(rf"(^|[^.>:\w])(?<!return ){re.escape(own)}\(|"
                      rf"^\s*(class|struct) {re.escape(own)}\b(?!;)")
    at = next((k for k in range(begin, end) if kind.search(plain[k])), None)
    if at is None:
        return None
    # A result may stand on the line before.
    start = at
    while start > 0 and plain[start - 1].strip() and not re.search(
            r"[;{}]\s*$|^#|^ *(public|private|protected):", plain[start - 1]):
        start -= 1
    last = at
    while last < len(lines) - 1 and not re.search(r"[;{}]\s*$", plain[last].rstrip()):
        last += 1
    words = start
    while words > 0 and lines[words - 1].lstrip().startswith("//"):
        words -= 1
    return words, start, last


def faults(text, root):
    """What is wrong with the code of the equations of a text, a line each."""
    found = []
    for number, equation in enumerate(equations(text), 1):
        where = f"equation {number}, line {equation.first + 1}"
        if not equation.code:
            found.append(f"{where}: no line of code")
        for name, path in equation.code:
            if not (root / path).is_file():
                found.append(f"{where}: no {path}")
            elif declaration((root / path).read_text(encoding="utf-8"), name) is None:
                found.append(f"{where}: {path} has no {name}")
    return found
