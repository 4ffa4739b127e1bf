"""Checks the documentation. Says every fault in a line; status 1 if there is one.

    check.py commands <mjdiag>   every command in README.md and docs/ names a subcommand,
                                 options and scripts that exist
    check.py sources             every formula of docs/theory.md says which name in which file
                                 has it, and it is there; so is every source that the texts
                                 name
    check.py folders             the table of docs/house.md has a row for every folder, and for
                                 none that is not there; the site's index has every page
    check.py links <folder>      every link of the built site that stays inside leads
                                 somewhere, anchors included, and nothing is loaded from
                                 elsewhere
"""

import re
import shlex
import sys
from fnmatch import fnmatch
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "app/manual"))

import command_help  # noqa: E402
import equations  # noqa: E402


def command_lines(text):
    """Commands in blocks of code, indented or fenced, with lines that go on joined."""
    fenced, joined = None, ""
    for line in text.splitlines():
        fence = re.match(r"\s*(`{3,})\s*(\w*)", line)
        if fence:
            fenced = None if fenced is not None else fence[2]
            continue
        code = line if fenced in ("sh", "bash", "console", "") else (
            line if fenced is None and line.startswith("    ") else "")
        joined += code.strip().removesuffix("\\")
        if code.rstrip().endswith("\\"):
            continue
        if joined:
            yield joined
        joined = ""


def check_commands(program, helps=None):
    """@param helps  what command_help.commands(program) gave, if it is known."""
    whole, known = helps or command_help.commands(program)
    faults, count = [], 0
    texts = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")),
             ROOT / "docs/site/gallery.toml"]
    for path in texts:
        text = path.read_text(encoding="utf-8")
        if path.suffix == ".toml":
            import tomllib
            lines = [line for example in tomllib.loads(text)["example"]
                     for line in command_lines("```sh\n" + example["command"] + "\n```")]
        else:
            lines = command_lines(text)
        for line in lines:
            try:
                words = shlex.split(line, comments=True)
            except ValueError:  # no command: prose, a formula, half a program
                continue
            for k, word in enumerate(words):
                where = f"{path.relative_to(ROOT)}: {line[:60]}"
                if re.fullmatch(r"scripts/[\w-]+", word) and k == 0:
                    count += 1
                    if not (ROOT / word).exists():
                        faults.append(f"{where}: no {word}")
                if Path(word).name != "mjdiag" or k + 1 >= len(words):
                    continue
                if k > 0 and words[k - 1] not in ("&&", "|", ";", "sudo", "time"):
                    continue
                name = words[k + 1]
                if name.startswith("-"):
                    faults += [f"{where}: no option {name}"] * (name not in whole.names())
                    continue
                if not re.fullmatch(r"[a-z]+", name):
                    continue  # <command>, or prose
                count += 1
                if name not in known:
                    faults.append(f"{where}: no command {name}")
                    continue
                for option in words[k + 2:]:
                    if option in ("&&", "|", ";", "&"):
                        break
                    option = option.split("=")[0]
                    if re.fullmatch(r"--?[a-z][a-z-]*", option) and (
                            option not in known[name].names()):
                        faults.append(f"{where}: mjdiag {name} has no {option}")
    if count < 20:
        faults.append(f"only {count} commands found: they are not read any more")
    print(f"{count} commands")
    return faults


def check_sources():
    theory = (ROOT / "docs/theory.md").read_text(encoding="utf-8")
    count = len(equations.equations(theory))
    faults = [f"docs/theory.md: {fault}" for fault in equations.faults(theory, ROOT)]
    if count < 30:
        faults.append(f"only {count} equations found: they are not read any more")
    for path in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]:
        for name in re.findall(r"`([a-z_]+/[\w/]+\.(?:h|cc|py))`",
                               path.read_text(encoding="utf-8")):
            if name.startswith(("out/", "your/")):
                continue
            if not (ROOT / name.removeprefix("mjdiag/")).exists():
                faults.append(f"{path.relative_to(ROOT)}: no {name}")
    print(f"{count} equations")
    return faults


def folders_of(parent, ignored=()):
    """Names of its folders with a file in them; what tools leave behind is none."""
    return [path.name for path in sorted(parent.iterdir())
            if path.is_dir() and not path.name.startswith((".", "__"))
            and not any(fnmatch(path.name, pattern) for pattern in ignored)
            and any(file.is_file() and "__pycache__" not in file.parts
                    for file in path.rglob("*"))]


def check_folders():
    """Rows are the folders of the sources, of plugin/ those in it; pages are in the index."""
    house = (ROOT / "docs/house.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `([\w/]+)/` \| (.*) \|$", house, re.MULTILINE))
    ignored = re.findall(r"^/(.+)/$", (ROOT / ".gitignore").read_text(encoding="utf-8"),
                         re.MULTILINE)
    there = [name for name in folders_of(ROOT, ignored) if name != "plugin"]
    there += [f"plugin/{name}" for name in folders_of(ROOT / "plugin")]
    faults = [f"docs/house.md: no row for {name}/" for name in there if name not in rows]
    for name, text in rows.items():
        if name not in there:
            faults.append(f"docs/house.md: no folder {name}/")
        faults += [f"docs/house.md: no folder {name}/{room}/"
                   for room in re.findall(r"`(\w+)/`", text)
                   if not (ROOT / name / room).is_dir()]
    index = (ROOT / "docs/site/index.md").read_text(encoding="utf-8").splitlines()
    faults += [f"docs/site/index.md: no line /{page.stem}" for page in (ROOT / "docs").glob("*.md")
               if f"/{page.stem}" not in index]
    print(f"{len(rows)} folders")
    return faults


class Page(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.links, self.loads, self.anchors = [], [], set()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        self.anchors |= {attrs[key] for key in ("id", "name") if attrs.get(key)}
        if tag == "a" and attrs.get("href"):
            self.links.append(attrs["href"])
        if tag in ("img", "script", "source", "video", "iframe") and attrs.get("src"):
            self.loads.append(attrs["src"])
        if tag == "link" and attrs.get("href"):
            self.loads.append(attrs["href"])


def check_links(folder):
    pages = {path: Page(path.read_text(encoding="utf-8", errors="replace"))
             for path in folder.rglob("*.html")}
    faults, count = [], 0
    for path, page in pages.items():
        where = path.relative_to(folder)
        for link in page.links + page.loads:
            if re.match(r"[a-z]+:|//", link):
                if link in page.loads and not link.startswith("data:"):
                    faults.append(f"{where}: loads {link}")
                continue
            count += 1
            file, _, anchor = link.partition("#")
            file = unquote(file.split("?")[0])
            target = (path.parent / file).resolve() if file else path
            if not target.exists():
                faults.append(f"{where}: no {link}")
            elif anchor and target in pages and unquote(anchor) not in pages[target].anchors:
                faults.append(f"{where}: no anchor {link}")
    if count < 100:
        faults.append(f"only {count} links found in {folder}")
    print(f"{count} links on {len(pages)} pages")
    return faults


def main():
    checks = {"commands": check_commands, "folders": check_folders, "links": check_links,
              "sources": check_sources}
    arguments = sys.argv[1:]
    if not arguments or arguments[0] not in checks or len(arguments) != (
            1 if arguments[0] in ("folders", "sources") else 2):
        sys.exit(__doc__)
    faults = checks[arguments[0]](*(Path(path).resolve() for path in arguments[1:]))
    for fault in faults:
        print(fault, file=sys.stderr)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
