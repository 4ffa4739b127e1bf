"""Formulas as docs/theory.md writes them, `Cov f^ = (G^T G)^-1 M`, as TeX.

The text keeps them readable where nothing typesets, in an editor and beside the code; the
site shows them as a book does. What the notation does not know stays code.
"""

import re

GREEK = ("alpha beta gamma delta zeta eta theta lambda mu nu xi pi rho phi psi Gamma Delta "
         "Phi Psi").split()
FUNCTIONS = dict(ln=r"\ln", log=r"\log", exp=r"\exp", sin=r"\sin", cos=r"\cos",
                 max=r"\max", min=r"\min", argmax=r"\operatorname*{arg\,max}",
                 sum=r"\sum", prod=r"\prod", sqrt=r"\sqrt")
OPERATORS = "rank diag mean Cov median var".split()
# Names of more than one letter that are one symbol.
SYMBOLS = dict(yp=r"y_p", xt=r"\tilde x", y_hat=r"\hat y", nf=r"n_f", nv=r"n_v", ff=r"ff",
               sd=r"\mathrm{sd}", Re=r"\operatorname{Re}", zeta=r"\zeta")
RELATIONS = {"||": r"\Vert ", ">=": r"\ge ", "<=": r"\le ", "->": r"\to ", "+=": r"\mathrel{+}=",
             "-=": r"\mathrel{-}=", "+-": r"\pm ", "-+": r"\mp ", "...": r"\dots ",
             "~": r"\sim ", "|": r"\vert ", "{": r"\{", "}": r"\}", "*": r"\cdot ",
             "%": r"\%", "#": r"\#", "&": r"\&"}
TOKEN = re.compile(r"""(?P<space>\s+)|(?P<number>\d+(?:\.\d+)?(?:e-?\d+)?)
    |(?P<name>[A-Za-z]+\d*(?:_hat)?)|(?P<other>\.\.\.|\|\||>=|<=|->|\+=|-=|\+-|-\+|.)""",
                   re.VERBOSE)


def _name(name):
    """TeX of a name without its indices, or None where it is no symbol."""
    if name in SYMBOLS:
        return SYMBOLS[name]
    stem, digits = re.fullmatch(r"(.*?)(\d*)", name).groups()
    index = f"_{{{digits}}}" if digits else ""
    if stem in GREEK:
        return f"\\{stem}{index}"
    if stem in FUNCTIONS and not digits:
        return FUNCTIONS[stem]
    if stem in OPERATORS and not digits:
        return rf"\operatorname{{{stem}}}"
    if len(stem) == 1:
        return stem + index
    bar = re.fullmatch(r"([A-Z])bar", name)
    if bar:
        return rf"\bar {bar[1]}"
    if stem[0] == "d" and (inner := _name(name[1:])) is not None and len(stem) != 3:
        return rf"\mathrm{{d}}{inner}"
    return None


def is_formula(text):
    """Whether all of it is in the notation: what is not is the name of a thing."""
    if re.search(r"--|@|\w/\w\w|\.\w|[\"\\:;`]|\w-\w\w|^[+'-]$", text):
        return False
    plain = re.sub(r"_[A-Za-z]+\b", "", text)
    words = re.findall(r"[A-Za-z]+\d*", plain)
    return bool(words) and all(_name(word) is not None for word in words)


def _closing(text, at):
    depth = 0
    for k in range(at, len(text)):
        depth += text[k] in "({["
        depth -= text[k] in ")}]"
        if depth == 0:
            return k
    return len(text) - 1


def _index(text, at):
    """What stands behind _ or ^ at `at`: its TeX, and where the rest begins."""
    if at < len(text) and text[at] in "({":
        end = _closing(text, at)
        return tex(text[at + 1:end]), end + 1
    match = re.compile(r"[A-Za-z0-9]+(?:,[A-Za-z0-9]+)?").match(text, at)
    if text[at - 1] == "^":
        match = re.compile(r"[-+]?(?:\d+|[A-Za-z](?:_[A-Za-z])?)|[+*]").match(text, at)
    if not match:
        return "", at
    word = match[0]
    parts = [(_name(part) if _name(part) and part not in FUNCTIONS and part not in OPERATORS
              else rf"\mathrm{{{part}}}") if part[:1].isalpha() and "_" not in part else part
             for part in word.split(",")]
    return ",".join(parts), match.end()


def tex(text):
    """A line of the notation as TeX; words in it stay words."""
    out, at = [], 0
    while at < len(text):
        if text[at] in "_^":
            sign = text[at]
            inner, after = _index(text, at + 1)
            if inner:
                out.append(f"{sign}{{{inner}}}")
            elif sign == "^" and out:  # f^: an estimate
                out[-1] = rf"\hat{{{out[-1]}}}"
            at = max(after, at + 1)
            if re.match(r"\*(\s|$)", text[at:]):  # g_j*: the conjugate
                out.append("^{*}")
                at += 1
            continue
        match = TOKEN.match(text, at)
        kind, token = match.lastgroup, match[0]
        at = match.end()
        if kind == "space":
            aligned = text[at:at + 1] == "="  # spaces that align lines
            out.append(r" \quad " if len(token) > 1 and not aligned else " ")
        elif kind == "number":
            size, _, power = token.partition("e")
            out.append(rf"{size}\cdot 10^{{{power}}}" if power else token)
        elif kind == "name":
            symbol = _name(token)
            if token == "sqrt" and text[at:at + 1] == "(":
                end = _closing(text, at)
                symbol, at = rf"\sqrt{{{tex(text[at + 1:end])}}}", end + 1
            elif symbol is None:
                symbol = rf"\text{{{token}}}"
            # x+: x one step later
            if re.match(r"\+(\s|\^|$)", text[at:]):
                symbol, at = f"{{{symbol}^{{+}}}}", at + 1
            out.append(symbol)
        else:
            out.append(RELATIONS.get(token, token))
    line = "".join(out)
    # A space in text mode, where words follow each other.
    return re.sub(r"(\\text\{\w+\}) (?! )", r"\1\\ ",
                  re.sub(r" (?=\\text\{)", r"\\ ", line))


def block(lines):
    """Lines of one formula, set below each other; a long one, where it has gaps."""
    lines = [part for line in lines
             for part in (re.split(r"\s{2,}", line.strip()) if len(line.strip()) > 70
                          else [line])]
    body = " \\\\\n".join("& " + tex(line.strip()) for line in lines if line.strip())
    return f"\\begin{{aligned}}\n{body}\n\\end{{aligned}}"
