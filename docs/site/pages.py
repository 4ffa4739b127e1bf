"""Makes the pages that Sphinx builds the site from: the README as the first one, the texts of
docs/, every command from its --help and --fields, every Python name from its stub and
docstring, the sources that the theory names, the notebooks with what they put out, and a
gallery.

Checks the commands in the texts, too.

    pages.py --program <mjdiag> --python <folder of the package> [--quick] <out>

--quick leaves out what takes long: the notebooks are not run, the gallery is empty, of
sources there are the headers.
"""

import argparse
import ast
import base64
import inspect
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent.parent / "app/manual"))

import check  # noqa: E402
import command_help  # noqa: E402
import equations  # noqa: E402
import formula  # noqa: E402

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
TEXTS = sorted(text.stem for text in (ROOT / "docs").glob("*.md"))
# "### Prefilters (`diagnosis/residuals/residual_bank.h`)"
FILES_OF_HEADING = re.compile(r"^(#+ .*?) \(((?:\[?`[^`]+`(?:\]\([^)]*\))?(?:, )?)+)\)$",
                              re.MULTILINE)
FENCE = re.compile(r"^ *(```+).*?^ *\1\s*$", re.MULTILINE | re.DOTALL)


class Site:
    def __init__(self, out):
        self.out = out
        self.sources = set()  # files of the repository that pages link to
        # Of the headings of the theory, which lose their files here.
        self.anchors = {slug(heading[0]): slug(heading[1]) for heading in
                        FILES_OF_HEADING.finditer((ROOT / "docs/theory.md").read_text())}
        self.equations = {}  # of each such file, the names that have some, with their numbers

    def write(self, name, text):
        path = self.out / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def source(self, path):
        """The page of a file or folder of the repository, or None if there is none."""
        path = os.path.normpath(path)
        if path.startswith("..") or not (ROOT / path).exists() or path == ".":
            return None
        self.sources.add(path)
        return f"/source/{path.replace('/', '.')}.md"

    def equation(self, number, name, path):
        """The place of a name in the page of its file."""
        self.source(path)
        self.equations.setdefault(path, {}).setdefault(name, []).append(number)
        return label(path, name)


def slug(heading):
    return re.sub(r"[^\w -]", "", heading.lstrip("# ").lower()).replace(" ", "-")


def label(path, name):
    return re.sub(r"\W+", "-", f"{path} {name}").lower()


def outside_fences(text, change):
    """`change` of every part of a text that is in no fenced block."""
    parts, at = [], 0
    for fence in FENCE.finditer(text):
        parts += [change(text[at:fence.start()]), fence[0]]
        at = fence.end()
    return "".join(parts + [change(text[at:])])


def link_files(site, text, folder):
    """Links into the repository lead to pages of the site."""
    def target(match):
        link, _, anchor = match[2].partition("#")
        if re.match(r"[a-z]+:|/", match[2]) or not link:
            return match[0]
        path = os.path.normpath(os.path.join(folder, link))
        if path == "docs/notebooks":
            page = "/notebooks/index.md"
        elif path == "README.md":
            page = "/index.md"
        elif path.startswith("docs/") and path[5:].removesuffix(".md") in TEXTS:
            page = f"/{path[5:]}"
        elif path.startswith("docs/") and path.endswith(".png"):
            (site.out / path[5:]).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / path, site.out / path[5:])
            page = f"/{path[5:]}"
        else:
            page = site.source(path)
            if page is None:
                raise SystemExit(f"{folder}: links to {match[2]}, which is not there")
        if page == "/theory.md":
            anchor = site.anchors.get(anchor, anchor)
        # Relative, as all texts stand at the top: MyST finds no anchor behind a slash.
        return f"{match[1]}({page.lstrip('/')}{'#' + anchor if anchor else ''})"
    return re.sub(r"(\[[^\]]*\])\(([^)\s]+)\)", target, text)


def theory(site, text):
    """Equations typeset, each with what has it in the sources, and paths as links."""
    found, lines, out, at = equations.equations(text), text.split("\n"), [], 0
    for number, equation in enumerate(found, 1):
        out += lines[at:equation.first]
        at = equation.end
        links = {}  # of every file
        for name, path in equation.code:
            links.setdefault(path, []).append(
                f"{{ref}}`{name} <{site.equation(number, name, path)}>`")
        block = ["```{math}", f":label: equation-{number}", "",
                 formula.block(equation.lines), "```", "", ":::{container} where",
                 "; ".join(", ".join(names) + f" in [{path}]({site.source(path)})"
                           for path, names in links.items()), ":::", ""]
        out += [equation.indent + line if line else "" for line in
                "\n".join(block).split("\n")]
    out += lines[at:]

    def code(match):
        inner = match[1]
        page = site.source(inner) if "/" in inner and " " not in inner else None
        if page:
            return f"[`{inner}`]({page})"
        return f"${formula.tex(inner)}$" if formula.is_formula(inner) else match[0]

    def paragraph(match):
        return re.sub(r"(?<![\[}])`([^`]+)`", lambda m: code(re.match(
            "`([^`]+)`", m[0].replace("\n", " "))), match[0])

    # Paragraph by paragraph: a line break may cut code in two.
    text = outside_fences("\n".join(out), lambda part: re.sub(
        r"(?:[^\n]+\n?)+", paragraph, part))
    # Files of a section stand below its heading.
    return re.sub(FILES_OF_HEADING, r"\1\n\n:::{container} files\n\2\n:::\n", text), len(found)


def commands(site, program):
    whole, parts = helps = command_help.commands(program)
    faults = check.check_commands(program, helps)  # of the texts
    if faults:
        raise SystemExit("\n".join(faults))
    lines = ["# Commands\n", "Made from what `mjdiag --help` says.\n"]
    for name, command in parts.items():
        lines.append(f"[`mjdiag {name}`]({name}.md)\n: {command.summary}\n")
    lines += [whole.ends, "\n```{toctree}\n:hidden:\n", *parts, "```"]
    site.write("commands/index.md", "\n".join(lines))
    for name, command in parts.items():
        lines = [f"# mjdiag {name}\n", f"{command.summary}.\n",
                 f"```text\n{command.usage}\n```\n"]
        for option in command.positionals + command.options:
            shown = ", ".join(option.names) + (f" {option.value}" if option.value else "")
            words = option.words or "(no description)"
            lines.append(f"`````{{option}} {shown}\n{escape(words)}\n`````\n")
        if "--fields" in command.names():
            lines += fields(program, name)
        lines.append(command.ends)
        site.write(f"commands/{name}.md",
                   f"```{{program}} mjdiag {name}\n```\n" + "\n".join(lines))


def fields(program, name):
    """A table of what `mjdiag <name> --fields` says of the JSON document."""
    said = subprocess.run([program, name, "--fields"], check=True, text=True,
                          stdout=subprocess.PIPE).stdout
    rows = [re.fullmatch(r"(\S+)(?: \[(.*?)\])?: (.*)", line).groups("")
            for line in said.splitlines()]
    return ["## What `--json` has\n", "| field | unit | |", "|---|---|---|",
            *(f"| `{field}` | {escape(unit)} | {escape(text).replace('|', chr(92) + '|')} |"
              for field, unit, text in rows), ""]


def escape(words):
    return re.sub(r"([<*_\[\]`$])", r"\\\1", words)


def docstring(thing):
    text = inspect.getdoc(thing) or ""
    lines = text.split("\n")
    # pybind11 begins with the signature, which the stub has better.
    if lines and re.match(r"\w+\(.*\)( -> .*)?$", lines[0]):
        lines = lines[1:]
    return "\n".join(lines).strip()


def python_reference(site, folder):
    sys.path.insert(0, str(folder))
    import mjdiag
    tree = ast.parse((folder / "mjdiag/__init__.pyi").read_text())
    lines = ["# Python reference\n",
             "Names and types from the stubs, words from the docstrings.\n"]
    lines += [f"- `{node.targets[0].id}` stands for `{ast.unparse(node.value)}`"
              for node in tree.body if isinstance(node, ast.Assign)
              and node.targets[0].id.startswith("_")] + [""]
    missing = []

    def words(thing, indent=""):
        text = docstring(thing)
        return f"\n````text\n{text}\n````\n" if text else ""

    def entry(kind, node, owner, fence):
        signature = node.name
        if isinstance(node, ast.FunctionDef):
            static = any(getattr(d, "id", "") in ("staticmethod", "property")
                         for d in node.decorator_list)
            arguments = ast.unparse(node.args)
            if owner is not mjdiag and not static:
                arguments = re.sub(r"^self(, )?(/, )?", "", arguments)
            signature += f"({arguments})"
            if node.returns:
                signature += f" -> {ast.unparse(node.returns)}"
        if kind == "attribute":
            signature = node.name
        return f"{fence}{{py:{kind}}} {signature}"

    for node in tree.body:
        if getattr(node, "name", "_").startswith("_"):
            continue
        thing = getattr(mjdiag, node.name, None)
        if thing is None:
            missing.append(node.name)
            continue
        if isinstance(node, ast.FunctionDef):
            lines += [f"## {node.name}\n", entry("function", node, mjdiag, "`````"),
                      words(thing), "`````\n"]
            continue
        lines += [f"## {node.name}\n", f"```````{{py:class}} {node.name}", words(thing)]
        for member in node.body:
            if isinstance(member, ast.AnnAssign):
                kind = ast.unparse(member.annotation)
                lines.append(f"`````{{py:attribute}} {member.target.id}\n:type: {kind}\n`````\n")
            elif isinstance(member, ast.FunctionDef):
                if member.name.startswith("_") and member.name != "__init__":
                    continue
                live = inspect.getattr_static(thing, member.name, None)
                if isinstance(live, staticmethod):
                    live = live.__func__
                decorators = [getattr(d, "id", "") for d in member.decorator_list]
                kind = "attribute" if "property" in decorators else (
                    "staticmethod" if "staticmethod" in decorators else "method")
                lines += [entry(kind, member, thing, "`````")]
                if kind == "attribute" and member.returns:
                    lines.append(f":type: {ast.unparse(member.returns)}")
                lines += [words(live), "`````\n"]
        lines.append("```````\n")
    if missing:
        raise SystemExit(f"the stubs have names that the package lacks: {missing}")
    site.write("python-reference.md",
               "```{py:module} mjdiag\n```\n" + "\n".join(lines))


def notebooks(site, python, quick):
    names = sorted(path.stem for path in (ROOT / "docs/notebooks").glob("*.ipynb"))
    site.write("notebooks/index.md", "# Notebooks\n\nRun when this site was made; what they "
               "put out is what they put out then.\n\n```{toctree}\n" + "\n".join(names) + "\n```\n")
    for name in names:
        text = (ROOT / f"docs/notebooks/{name}.ipynb").read_text(encoding="utf-8")
        book = json.loads(text) if quick else run_notebook(text, python)
        lines, pictures = [], 0
        for cell in book["cells"]:
            text = "".join(cell["source"])
            if cell["cell_type"] == "markdown":
                lines.append(text + "\n")
                continue
            lines.append(f"```python\n{text}\n```\n")
            for output in cell.get("outputs", []):
                data = output.get("data", {})
                if "image/png" in data:
                    pictures += 1
                    picture = f"notebooks/{name}-{pictures}.png"
                    (site.out / picture).write_bytes(base64.b64decode(data["image/png"]))
                    lines.append(f"![what the cell above draws](/{picture})\n")
                elif "text/html" in data:
                    html = "".join(data["text/html"])
                    lines.append(f"`````{{raw}} html\n<div class=\"output\">{html}</div>\n`````\n")
                else:
                    shown = "".join(output.get("text", data.get("text/plain", "")))
                    if output.get("name") != "stderr" and shown.strip():
                        lines.append(f"`````text\n{shown}\n`````\n")
        site.write(f"notebooks/{name}.md", "\n".join(lines))


def run_notebook(text, python):
    import nbformat
    from nbclient import NotebookClient
    book = nbformat.reads(text, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        os.symlink(ROOT / "mjcf", os.path.join(folder, "mjcf"))
        os.environ["PYTHONPATH"] = str(python)
        NotebookClient(book, timeout=600, kernel_name="python3",
                       resources={"metadata": {"path": folder}}).execute()
    return book


def gallery(site, program, quick):
    lines = ["# Gallery\n", "Every picture and every figure here was made by the command above "
             "it when this site was built.\n"]
    examples = tomllib.loads((HERE / "gallery.toml").read_text())["example"]
    with tempfile.TemporaryDirectory() as folder:
        os.symlink(ROOT / "mjcf", os.path.join(folder, "mjcf"))
        bin_folder = Path(folder, "bin")
        bin_folder.mkdir()
        (bin_folder / "mjdiag").symlink_to(program)
        environment = {**os.environ, "PATH": f"{bin_folder}:{os.environ['PATH']}"}
        for number, example in enumerate(examples, 1):
            lines += [f"## {example['title']}\n", example["text"] + "\n",
                      f"```sh\n{example['command'].strip()}\n```\n"]
            if quick:
                continue
            run = subprocess.run(["bash", "-ec", example["command"]], cwd=folder, text=True,
                                 env=environment, stdout=subprocess.PIPE)
            if run.returncode != example.get("status", 0):
                raise SystemExit(f"gallery, {example['title']}: status {run.returncode}")
            if run.stdout.strip() and example.get("output", True):
                lines.append(f"```text\n{run.stdout.rstrip()}\n```\n")
            if "picture" in example:
                made = Path(folder, example["picture"])
                name = f"gallery-{number}.png"
                if made.suffix == ".html":
                    picture_of_page(made, site.out / name)
                else:
                    shutil.copy(made, site.out / name)
                lines.append(f"![{example['title']}](/{name})\n")
    site.write("gallery.md", "\n".join(lines))


def picture_of_page(page, picture):
    with tempfile.TemporaryDirectory() as profile:
        subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu",
                        f"--user-data-dir={profile}", "--hide-scrollbars",
                        "--window-size=1100,1500", "--virtual-time-budget=5000",
                        f"--screenshot={picture}", page.as_uri()],
                       check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def sources(site, quick):
    kinds = (".h", ".xml", ".toml", ".py") if quick else (".h", ".xml", ".toml", ".py", ".cc")
    done = set()
    while site.sources - done:
        for path in sorted(site.sources - done):
            done.add(path)
            page = f"---\norphan: true\n---\n# {path}\n\n"
            if (ROOT / path).is_dir():
                files = [p for p in sorted((ROOT / path).iterdir())
                         if p.suffix in kinds and p.is_file()]
                page += "\n".join(f"- [{p.name}]({site.source(p.relative_to(ROOT))})"
                                  for p in files)
            else:
                page += source_page(site, path, quick)
            site.write(f"source/{path.replace('/', '.')}.md", page)


def source_page(site, path, quick):
    """A file as it is, its links from the theory leading to where a name is declared."""
    text = (ROOT / path).read_text(encoding="utf-8").rstrip("\n")
    language = {".h": "cpp", ".cc": "cpp", ".py": "python", ".xml": "xml",
                ".toml": "toml"}.get(Path(path).suffix, "text")
    parts, marks = [], {}  # marks: a line at which a part begins, its labels and names
    for name, numbers in site.equations.get(path, {}).items():
        words, first, last = equations.declaration(text, name)
        marks.setdefault(words, []).append((name, first, last))
        of = ", ".join(f"{{eq}}`equation-{number}`" for number in numbers)
        parts.append(f"- {{ref}}`{name} <{label(path, name)}>`: equation {of} of the "
                     "[theory](/theory.md)")
    parts.append("")
    other = Path(path).with_suffix({".h": ".cc", ".cc": ".h"}.get(Path(path).suffix, ".none"))
    if parts[:-1] and (ROOT / other).exists() and not quick:
        parts.append(f"[{other}]({site.source(other)})\n")
    lines = text.split("\n")
    starts = sorted({0, *marks})
    for start, end in zip(starts, starts[1:] + [len(lines)]):
        names = marks.get(start, [])
        parts += [f"({label(path, name)})=" for name, _, _ in names]
        parts.append(f"``````{{code-block}} {language}")
        if marks:
            parts += [":linenos:", f":lineno-start: {start + 1}"]
        if names:
            shown = ",".join(f"{first - start + 1}-{last - start + 1}"
                             for _, first, last in names)
            parts.append(f":emphasize-lines: {shown}")
        parts += ["", *lines[start:end], "``````", ""]
    return "\n".join(parts)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--python", type=Path, required=True)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("out", type=Path)
    options = parser.parse_args()
    program, python = options.program.resolve(), options.python.resolve()
    if options.out.exists():
        shutil.rmtree(options.out)
    site = Site(options.out)
    for name in TEXTS:
        text = (ROOT / f"docs/{name}.md").read_text()
        if name == "theory":
            text, count = theory(site, text)
            print(f"theory: {count} equations")
        site.write(f"{name}.md", link_files(site, text, "docs"))
    site.write("index.md", link_files(site, (ROOT / "README.md").read_text(), ".") +
               (HERE / "index.md").read_text())
    commands(site, program)
    python_reference(site, python)
    notebooks(site, python, options.quick)
    gallery(site, program, options.quick)
    sources(site, options.quick)


if __name__ == "__main__":
    main()
