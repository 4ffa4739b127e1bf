"""The table, and docs/accuracy.md around it."""

import importlib
import re
import sys
import time

from .common import BUILD

# Modules in the order of the document.
PARTS = ("linear", "runs", "filters", "prefilters", "spectra", "tones", "estimation", "twins", "statistics",
         "features", "files")

# Sections of docs/theory.md, or other pages, that have the formula of an entry.
SECTIONS = {
    "bonder_matrices": "Linear equations of motion",
    "modes": "Modes",
    "tick": "One control tick",
    "closed_loop": "Fault-tolerant control",
    "linear_runs": "One control tick; Control",
    "voice_coil": "One control tick",
    "pendulum": "The machine; One control tick",
    "applied": "The exact tick in delta form",
    "denominators": "Relations of unit noise, and which becomes the residual; Disturbances",
    "nulling": "Null space, minimal degree, unknown inputs; Relations of unit noise, and "
               "which becomes the residual",
    "derivatives": "Prefilters",
    "limits": "Detection",
    "spectra": "Disturbances",
    "tones": "Disturbances",
    "from_residuals": "Estimation from residuals",
    "bound": "Estimation from residuals; The information bound",
    "voice_coil_twin": "Estimation by a twin",
    "bonder_twin": "Estimation by a twin",
    "false_alarms": "Detection",
    "intervals": "[datasets](datasets.md)",
    "usual_estimates": "Estimation from residuals",
    "mismatch": "Comparing with a measurement",
    "table": "The data-driven method",
    "round_trips": "[python](python.md), Records",
    "sobol": "[datasets](datasets.md), The plan",
    "grids": "[datasets](datasets.md), The plan",
}

# Why an entry fails, for as long as it does.
CAUSES = {
    "largest eigenvalue of the closed loop": """
  The loop's matrix has metres, radians and their speeds side by side, and `SpectralRadius`
  (`signals/decompositions.cc`) takes its eigenvalues as it stands. LAPACK, which balances
  the matrix first, is off by 6e-14 on the same one.""",
    "frequencies of three tones": """
  `LineFrequency` (`diagnosis/disturbance/line_frequency.cc`) ends after three steps. Of a
  tone beside one that is a hundred times as strong each step leaves 1/270 of what the one
  before was off by, so that three are too few. The standard deviation of this frequency is
  thirty thousand times larger.""",
    "standard deviations of faults from residuals": """
  `FaultEstimator` (`diagnosis/residuals/fault_estimator.cc`) takes the noise behind filters
  that began at rest for stationary as soon as its variance is within 1e-6 of that
  (`kBuiltUp`), and keeps what it has then. With this rule the second computation agrees to
  2e-10.""",
}

HEAD = """# How exact the numbers are

The numbers that mjdiag reports, computed a second time: by SciPy, by numbers of 50 digits
(mpmath), and by programs of our own that share no line with it. Written by
`scripts/accuracy`, which takes two minutes and ends with status 1 if an entry fails.

## What is allowed

A double has a rounding of 1.1e-16, and a problem makes more of it: a difference of numbers
that are nearly equal, a matrix that is nearly singular, a long sum. By how much is its
*condition number*, and ten times that many roundings are allowed; ten, because there is
more than one operation. It is found in one of two ways, which the last column names:

- *Moving every number on the way by a rounding*: the second computation, which has digits to
  spare, is made four more times, with every number that goes in, and every one that a
  computer would keep on the way (states after a step, entries of a matrix, sums), moved by
  one rounding up or down, at random. The largest change of a result is its condition number
  (D. S. Parker, *Monte Carlo Arithmetic*, UCLA CSD-970002, 1997).
- By a formula, where there is one: the norm of a matrix and its eigenvectors, the weights of
  a difference quotient, sizes of summands over the size of their sum.

An error is the largest of the values of an entry: relative to the value itself, or to the
largest of its kind where values pass through zero (samples of a signal, entries of a
matrix in coordinates of unit mass, bins of a spectrum). The condition number is that of the
value that has the largest. What stands in files is compared to the last bit.

No bound is made wider for an entry that fails: it stays in the table, with its cause below.

## The table

"""

TAIL = """
## What is not in the table

- Discovery: its probabilities are sums over what a search has met, which nobody makes a
  second time.
- The twin of the nonlinear machine and `mjdiag calibrate`: their passes go where the
  record takes them. The voice coil and the linear bonder stand for the sums that they make;
  how good estimates are says [studies](studies.md).
- The dry friction of MuJoCo is a constraint that is solved to 1e-12 by iteration; runs with
  it are as exact as that.
- Naming has prices of chi-squared that no document shows; those of a normal variable, of F
  and of t are in limits, alarms and probabilities of the table.
- Tables that are printed to four digits are compared in these.
"""


def computed(parts):
    """All entries of some parts, printed as they come."""
    sys.path.insert(0, str(BUILD / "python"))
    rows = []
    began = time.monotonic()
    for part in parts:
        for function in importlib.import_module(f"accuracy_rows.{part}").ROWS:
            for row in function():
                row.section = SECTIONS[function.__name__]
                rows.append(row)
                print(f"{'passes' if row.passed else 'FAILS':7} {row.error:8.1e} of "
                      f"{row.allowed:8.1e}  {row.what}", flush=True)
    print(f"{time.monotonic() - began:.0f} s")
    return rows


def plain(text):
    """1e-09 as 1e-9, 2e+03 as 2e3."""
    return re.sub(r"e([-+])0*", lambda found: "e" + found[1].replace("+", ""), text)


def line(row):
    cells = (row.what, row.source, row.reference, row.section, row.count,
             plain(f"{row.error:.1e}") if row.error else "0",
             plain(f"{row.condition:.2g}"), plain(f"{row.allowed:.1e}"),
             "passes" if row.passed else "**fails**", row.how)
    return "| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |"


def document(rows):
    text = [HEAD]
    for part in dict.fromkeys(row.part for row in rows):
        text.append(f"### {part}\n\n"
                    "| what | where from | beside | formula | values | largest error "
                    "| condition number | allowed | | how the condition was found |\n"
                    "|---|---|---|---|---|---|---|---|---|---|\n")
        text += [line(row) + "\n" for row in rows if row.part == part]
        text.append("\n")
    failed = [row for row in rows if not row.passed]
    text.append("Formulas are in the section of that name of [theory](theory.md), if no "
                "other page is named.\n\n## What fails, and why\n\n")
    text += [f"- *{row.what}*.{CAUSES.get(row.what, ' Not known yet.')}\n"
             for row in failed] or ["Nothing.\n"]
    return "".join(text) + TAIL
