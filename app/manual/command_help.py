"""What `mjdiag --help` says, as data: the one list of commands and options that the
reference, the manual pages, the completion and the checks of the documentation read."""

import re
import subprocess
from dataclasses import dataclass, field


@dataclass
class Option:
    names: list  # "-h", "--help"; a positional has its name without dashes
    value: str   # as the help writes it: "TEXT REQUIRED", "" for a flag
    words: str


@dataclass
class Command:
    name: str
    summary: str
    usage: str
    options: list = field(default_factory=list)
    positionals: list = field(default_factory=list)
    ends: str = ""  # exit status

    def names(self):
        return [name for option in self.options for name in option.names]


def _rows(lines):
    """Rows of a list: two spaces, what it is, and its words, on the same line or below."""
    rows = []
    for line in lines:
        if re.match(r"  \S", line):
            left, _, words = line.strip().partition("  ")
            rows.append([left, words.strip()])
        elif rows and line.strip():
            rows[-1][1] = (rows[-1][1] + " " + line.strip()).strip()
    return rows


def _option(left, words):
    names, _, value = left.partition(" ")
    if not value and len(names) > 28 and not words:
        names, value = names, ""
    return Option(names.split(","), value.strip(), words)


def _help(program, *command):
    text = subprocess.run([program, *command, "--help"], check=True, text=True,
                          stdout=subprocess.PIPE).stdout
    return text.replace(str(program), "mjdiag")


def parse(name, text):
    sections, here = {"": []}, ""
    for line in text.splitlines():
        head = re.fullmatch(r"([A-Z][A-Za-z ]*):", line)
        if head:
            here = head[1]
            sections[here] = []
        elif line.startswith("Exit status:"):
            sections["end"], here = [line], "end"
        else:
            sections[here].append(line)
    top = [line for line in sections[""] if line.strip()]
    usage = next((line[7:] for line in top if line.startswith("Usage: ")), "")
    summary = " ".join(line for line in top if not line.startswith("Usage: "))
    command = Command(name, summary, usage, ends=" ".join(sections.get("end", [])).strip())
    command.positionals = [_option(*row) for row in _rows(sections.get("Positionals", []))]
    for section, lines in sections.items():
        if section not in ("", "end", "Positionals", "Subcommands"):
            command.options += [_option(*row) for row in _rows(lines)]
    command.subcommands = [row[0] for row in _rows(sections.get("Subcommands", []))]
    return command


def commands(program):
    """The command itself, and its subcommands by name."""
    whole = parse("mjdiag", _help(program))
    return whole, {name: parse(name, _help(program, name)) for name in whole.subcommands}
