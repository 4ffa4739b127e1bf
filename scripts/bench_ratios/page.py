"""docs/performance.md."""

import statistics

from . import ratios
from .reasons import REASONS

SHOWN = 6  # commits of the history

HEAD = """# What it costs

What mjdiag costs, as ratios, each measured five times. Written by `scripts/bench`, which
takes ten minutes on a quiet computer, keeps the five values in `docs/performance.json`, and
ends with status 1 if a ratio got worse: if all five values are worse than all five of the
last commit that was measured on such a computer. Without a change that happens once in 252
times, whatever the noise is like.

No absolute times: both sides of a ratio are measured in turn, in short slices, and so meet
the same computer. Bold is a target that is missed; the reasons are below the table. An empty
field was not measured at that commit. What is faster below the line makes a ratio larger: a
tick in Python costs half of a faster tick in C++ more.

"""


def number(value, ratio):
    return f"{value:.{ratio.digits if value < 100 else 0}f}"


def line(ratio, entries):
    values = entries[0].values.get(ratio.name)
    target = "" if ratio.target is None else (
        ("at most " if ratio.less_is_better else "at least ") + f"{ratio.target:g}")
    cells = [f"`{ratio.name}`<br>{ratio.what}, over {ratio.over}", target]
    if values is None:
        cells += ["", ""]
    else:
        median = statistics.median(values)
        missed = ratio.target is not None and (
            median > ratio.target if ratio.less_is_better else median < ratio.target)
        text = number(median, ratio)
        cells += [f"**{text}**" if missed else text,
                  f"{number(min(values), ratio)} to {number(max(values), ratio)}"]
    for entry in entries[1:SHOWN]:
        earlier = entry.values.get(ratio.name)
        cells.append("" if earlier is None else number(statistics.median(earlier), ratio))
    return "| " + " | ".join(cells) + " |\n"


def document(entries):
    """Of entries, the latest first."""
    now = entries[0]
    titles = ["ratio", "target", f"median, {now.commit}", "the five values"]
    titles += [entry.commit for entry in entries[1:SHOWN]]
    text = [HEAD, f"Commit {now.commit}, {now.computer}. A + is a commit with changes. The "
            "columns after the values are medians of earlier ones, the latest first, some of "
            "other computers.\n\n",
            "| " + " | ".join(titles) + " |\n", "|---" * len(titles) + "|\n"]
    text += [line(ratio, entries) for ratio in ratios.RATIOS]
    return "".join(text) + REASONS
