"""Manual pages and the completion of bash, from what `mjdiag --help` says.

    manual.py <mjdiag> <folder>   writes man1/*.1 and completions/mjdiag
"""

import re
import subprocess
import sys
from pathlib import Path

import command_help


def roff(text):
    text = text.replace("\\", r"\e").replace("-", r"\-")
    return re.sub(r"^([.'])", r"\\&\1", text)


def page(title, version, command, summary, see, listed=()):
    named = summary  # M, D, K keep their case
    if summary[1:2].islower():
        named = summary[0].lower() + summary[1:]
    lines = [f'.TH {title.upper()} 1 "" "mjdiag {version}" "User Commands"', ".SH NAME",
             f"{roff(title)} \\- {roff(named)}",
             ".SH SYNOPSIS", f".B {roff(command.usage)}"]
    if listed:
        lines.append(".SH COMMANDS")
        for name, one in listed:
            lines += [".TP", f".BR {roff('mjdiag-' + name)} (1)", roff(one.summary)]
    lines.append(".SH OPTIONS")
    for option in command.positionals + command.options:
        value = f" \\fI{roff(option.value)}\\fR" if option.value else ""
        names = ", ".join(f"\\fB{roff(name)}\\fR" for name in option.names)
        lines += [".TP", names + value, roff(option.words or "See the documentation.")]
    if command.ends:
        lines += [".SH EXIT STATUS", roff(command.ends.removeprefix("Exit status: "))]
    lines += [".SH SEE ALSO", ",\n".join(f".BR {roff(name)} (1)" for name in see)]
    return "\n".join(lines).replace(",\n.BR", "\n.BR") + "\n"


def completion(whole, parts):
    """A function for bash: commands, options of each, words where there is a choice."""
    cases, choices = [], {}
    for name, command in parts.items():
        cases.append(f"    {name}) options='{' '.join(command.names())}' ;;")
        for option in command.options:
            choice = re.search(r"\{([^}]*)\}", option.value)
            if choice:
                words = choice[1].replace(",", " ")
                choices.setdefault(words, []).append(f"{name}:{option.names[-1]}")
    chosen = [f"    {'|'.join(where)}) words='{words}' ;;" for words, where in choices.items()]
    return "\n".join([
        "# Completion of mjdiag for bash, made from its own --help.",
        "_mjdiag() {",
        "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}",
        "  local options= words=",
        "  COMPREPLY=()",
        "  if [ \"$COMP_CWORD\" -eq 1 ]; then",
        f"    COMPREPLY=($(compgen -W '{' '.join(list(parts) + whole.names())}' -- \"$word\"))",
        "    return",
        "  fi",
        "  case ${COMP_WORDS[1]}:$before in", *chosen, "  esac",
        "  case ${COMP_WORDS[1]} in", *cases, "  esac",
        "  if [ -n \"$words\" ]; then",
        "    COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))",
        "  elif [[ $word == -* ]]; then",
        "    COMPREPLY=($(compgen -W \"$options\" -- \"$word\"))",
        "  fi",
        "}",
        "complete -o default -F _mjdiag mjdiag", ""])


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    program = Path(sys.argv[1]).resolve()
    version = subprocess.run([program, "--version"], check=True, text=True,
                             stdout=subprocess.PIPE).stdout.split()[-1]
    write(*command_help.commands(program), version, Path(sys.argv[2]))


def write(whole, parts, version, out):
    (out / "man1").mkdir(parents=True, exist_ok=True)
    (out / "completions").mkdir(exist_ok=True)
    pages = {"mjdiag": page("mjdiag", version, whole, whole.summary,
                            [f"mjdiag-{name}" for name in parts], parts.items())}
    for name, command in parts.items():
        pages[f"mjdiag-{name}"] = page(f"mjdiag-{name}", version, command, command.summary,
                                       ["mjdiag"])
    for name, text in pages.items():
        (out / "man1" / f"{name}.1").write_text(text, encoding="utf-8")
    (out / "completions/mjdiag").write_text(completion(whole, parts), encoding="utf-8")


if __name__ == "__main__":
    main()
