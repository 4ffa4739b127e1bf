"""Rows of the table, rounding, and how mjdiag is asked."""

import json
import os
import pathlib
import subprocess

import mpmath
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = pathlib.Path(os.environ.get("MJDIAG_BUILD") or ROOT / "build" / "release")
PROGRAM = os.environ.get("MJDIAG_COMMAND") or BUILD / "app" / "mjdiag"
MJCF = ROOT / "mjcf"
ROUNDING = 2.0 ** -53  # the largest of one operation
LONG = np.longdouble
DRAWS = 4  # of a shaken computation

mpmath.mp.dps = 50
mpf = mpmath.mpf


class Row:
    """Values of mjdiag beside those of another implementation.

    An error is relative to `scale`: each value's own size if None. `condition` is what one
    rounding of what goes in, or on the way, does to a value, in roundings of it."""

    def __init__(self, part, what, source, reference, ours, theirs, condition, how,
                 scale=None):
        ours, theirs = flat(ours), flat(theirs)
        if len(ours) != len(theirs) or not ours:
            raise SystemExit(f"accuracy: {what}: {len(ours)} values beside {len(theirs)}")
        scales = flat(scale) if scale is not None else [abs(x) for x in theirs]
        if len(scales) == 1:
            scales = scales * len(ours)
        self.part, self.what, self.source, self.reference = part, what, source, reference
        self.count, self.how = len(ours), how
        self.error = max(relative(a, b, s) for a, b, s in zip(ours, theirs, scales))
        self.condition = float(condition)
        self.allowed = 10.0 * max(1.0, self.condition) * ROUNDING
        self.passed = self.error <= self.allowed  # False for NaN


def relative(ours, theirs, scale):
    if ours == theirs:
        return 0.0
    return float(abs(mpf_of(ours) - mpf_of(theirs)) / mpf_of(scale)) if scale else np.inf


def mpf_of(x):
    """Exact, for a long double too; complex numbers of mpmath are what they are."""
    if isinstance(x, mpmath.mpc):
        return x
    if isinstance(x, np.longdouble):
        high = float(x)
        return mpf(high) + mpf(float(x - LONG(high)))
    return mpf(x)


def long_of(x):
    """A number of mpmath, or an array of such, as long doubles."""
    if isinstance(x, mpmath.matrix):
        return np.array([[long_of(x[i, j]) for j in range(x.cols)]
                         for i in range(x.rows)], dtype=LONG)
    x = mpf(x)
    high = float(x)
    return LONG(high) + LONG(float(x - high))


def flat(values):
    if isinstance(values, mpmath.matrix):
        return list(values)
    if isinstance(values, np.ndarray):
        return list(values.ravel())
    if isinstance(values, (list, tuple)):
        return [x for part in values for x in flat(part)]
    return [values]


def matrix(rows):
    return mpmath.matrix([[mpf(x) for x in row] for row in np.asarray(rows).tolist()])


class Shaker:
    """Moves numbers by up to a rounding, at random but the same every time. What that does
    to a computation in high precision is what rounding does to it in double (D. S. Parker,
    Monte Carlo Arithmetic, UCLA CSD-970002, 1997)."""

    def __init__(self, seed):
        self.random = np.random.default_rng(seed)

    def __call__(self, x):
        if isinstance(x, mpmath.matrix):
            moved = x.copy()
            for i in range(x.rows):
                for j in range(x.cols):
                    if x[i, j]:
                        moved[i, j] = self(x[i, j])
            return moved
        if isinstance(x, np.ndarray):
            return x * (1 + LONG(ROUNDING) * self.random.choice([-1, 1], x.shape))
        return x * (1 + ROUNDING * int(self.random.choice([-1, 1])))


def still(x):
    """In the place of a Shaker: the computation itself."""
    return x


def condition_of(compute, exact, scale=None):
    """In roundings, the largest change of `compute(shaker)` over some draws."""
    return spread_of([compute(Shaker(seed)) for seed in range(DRAWS)], exact, scale)


def spread_of(shaken, exact, scale=None):
    """The same of results that are there."""
    exact = flat(exact)
    scales = flat(scale) if scale is not None else [abs(x) for x in exact]
    if len(scales) == 1:
        scales = scales * len(exact)
    return max(relative(a, b, s) for one in shaken
               for a, b, s in zip(flat(one), exact, scales)) / ROUNDING


SHAKEN = "moving every number on the way by a rounding"


def ask(*words, status=(0,)):
    """The JSON document of a command."""
    done = subprocess.run([str(PROGRAM), *map(str, words), "--json"], text=True,
                          capture_output=True)
    if done.returncode not in status:
        raise SystemExit(f"accuracy: mjdiag {' '.join(map(str, words))}: {done.stderr}")
    return json.loads(done.stdout)


def diagnosed(design, record, *options):
    """What the command says of a record of the bonder with filters that are there."""
    filters = pathlib.Path(record).parent / "filters.json"
    filters.write_text(json.dumps(design), encoding="utf-8")
    return ask("diagnose", "--setup", MJCF / "ab383", "--linear", *options, "--filters",
               filters, "--record", record, status=(0, 1))


def read_csv(file):
    """Channels of a record, by Python's own reading of numbers."""
    with open(file, encoding="utf-8") as lines:
        names = [cell.split(" [")[0] for cell in next(lines).rstrip("\n").split(",")]
        rows = [[float(cell) for cell in line.split(",")] for line in lines]
    return dict(zip(names, np.array(rows).T))


def setup_of(machine):
    import tomllib
    with open(MJCF / machine / "setup.toml", "rb") as file:
        return tomllib.load(file)
