"""What was measured at earlier commits, and what got worse since."""

import dataclasses
import json
import math
import os
import pathlib
import statistics
import subprocess

from . import ratios

ROUNDS = 5
KEPT = 20  # entries


def computer():
    """Cores, and which processor they are of: a twin's vectors and MuJoCo's steps do not
    become faster by the same factor from one to the next."""
    cores = len(os.sched_getaffinity(0))
    said = {}
    try:
        for line in pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            name, _, value = line.partition(":")
            said.setdefault(name.strip(), value.strip())
    except OSError:  # not Linux
        pass
    names = [said["model name"]] if "model name" in said else []
    names += [f"{name.removeprefix('cpu ')} {said[name]}" for name in ("cpu family", "model")
              if name in said]
    return (f"{cores} core" + "s" * (cores != 1)
            + (" of " + ", ".join(names) if names else ""))


@dataclasses.dataclass
class Entry:
    commit: str
    computer: str
    values: dict  # name of a ratio -> one of every round

    @staticmethod
    def of_now(root):
        def git(*words):
            return subprocess.run(["git", "-C", str(root), *words], check=True,
                                  capture_output=True, text=True).stdout.strip()

        # What this script writes is no change of what it measures.
        changed = git("status", "--porcelain", "--untracked-files=no", "--", ".",
                      ":!docs/performance.md", ":!docs/performance.json")
        commit = git("rev-parse", "--short=8", "HEAD") + ("+" if changed else "")
        return Entry(commit, computer(), {})


def read(path):
    """The latest first; none if there is no file."""
    if not path.exists():
        return []
    return [Entry(**entry) for entry in json.loads(path.read_text(encoding="utf-8"))]


def write(path, entries):
    # A line an entry and ratio: so a difference of two versions can be read.
    lines = []
    for entry in entries:
        values = ",\n    ".join(
            f"{json.dumps(name)}: {json.dumps([float(f'{x:.5g}') for x in found])}"
            for name, found in entry.values.items())
        lines.append(f'  {{"commit": {json.dumps(entry.commit)}, '
                     f'"computer": {json.dumps(entry.computer)}, "values": {{\n'
                     f"    {values}}}}}")
    path.write_text("[\n" + ",\n".join(lines) + "\n]\n", encoding="utf-8")


def with_entry(entries, new):
    """A commit that is measured again has its last values."""
    others = [entry for entry in entries
              if (entry.commit, entry.computer) != (new.commit, new.computer)]
    return [new, *others][:KEPT]


def last_before(entries, new):
    """Of another commit, on such a computer; None if there is none."""
    return next((entry for entry in entries if entry.commit != new.commit
                 and entry.computer == new.computer), None)


def verdict(new, old, less_is_better):
    """"worse" or "better" if all new values are on one side of all old ones."""
    if min(new) > max(old):
        return "worse" if less_is_better else "better"
    if max(new) < min(old):
        return "better" if less_is_better else "worse"
    return "same"


def chance(new, old):
    """That so many values are all worse than those, if nothing has changed."""
    return 1 / math.comb(len(new) + len(old), len(new))


def report(new, old, quick):
    """Prints a line a ratio; the names of those that got worse."""
    worse = []
    for name, found in new.values.items():
        ratio = ratios.named(name)
        text = (f"{name:26} {statistics.median(found):8.{ratio.digits}f}  "
                f"{min(found):.{ratio.digits}f} to {max(found):.{ratio.digits}f}")
        before = old.values.get(name) if old else None
        if before is None:
            said = "not measured before"
        elif quick or not ratio.judged:
            said = "not judged"
        else:
            said = verdict(found, before, ratio.less_is_better)
        if said == "worse":
            worse.append(name)
        if before is not None:
            text += f"  ({old.commit}: {statistics.median(before):.{ratio.digits}f})"
        print(f"{text}  {said}")
    if worse:
        print(f"worse: {', '.join(worse)}; if nothing has changed one in "
              f"{1 / chance(new.values[worse[0]], old.values[worse[0]]):.0f} looks so. "
              f"Measure again: scripts/bench {' '.join(worse)}")
    return worse
