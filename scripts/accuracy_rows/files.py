"""Records in files, and plans of studies."""

import os
import tempfile

import mpmath
import numpy as np
import scipy.io
import scipy.stats.qmc

from .common import MJCF, Row, ask, mpf, read_csv

FILES = "Files"
PLANS = "Plans"
NUMBERS = 4000


def hard_numbers():
    """Of all sizes, with all bits in use, and the smallest and largest."""
    random = np.random.default_rng(1)
    x = random.standard_normal(NUMBERS) * 2.0 ** random.integers(-1000, 1000, NUMBERS)
    x[:8] = (5e-324, 2.2250738585072014e-308, 1.7976931348623157e308, -0.0, 0.1,
             1 + 2.0 ** -52, 1e23, 9007199254740993.0)
    return x


def round_trips():
    import mjdiag
    x = hard_numbers()
    written = mjdiag.Record({"x": x, "u": x[::-1].copy()}, {"x": "m", "u": "N"}, 1e-3)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for ending, reader, name in (
                (".csv", lambda file: read_csv(file)["x"], "Python's float of every cell"),
                (".mat", lambda file: scipy.io.loadmat(file)["x"].ravel(),
                 "scipy.io.loadmat")):
            file = os.path.join(folder, "record" + ending)
            written.write(file)
            rows.append(Row(FILES, f"{ending}: what is written", f"`Record.write`: {ending}",
                            name, reader(file), x, 1.0, "to the last bit: no rounding",
                            scale=bits(x)))
            rows.append(Row(FILES, f"{ending}: what is read back",
                            f"`Record.read`: {ending}", "the numbers written",
                            mjdiag.Record.read(file)["x"], x, 1.0,
                            "to the last bit: no rounding", scale=bits(x)))
        for kind in ("csv", "mat73"):
            ask("simulate", "--setup", MJCF / "ab383", "--linear", "--duration", 0.05,
                "--format", kind, "--out", os.path.join(folder, kind))
        run = read_csv(os.path.join(folder, "csv", "record.csv"))
        again = mjdiag.Record.read(os.path.join(folder, "mat73", "record.mat"))
        names = [name for name in run if name != "time"]
        rows.append(Row(FILES, ".mat (v7.3): a run, beside the same run as .csv",
                        "`simulate --format mat73`, `Record.read`",
                        "Python's float of every cell", [again[name] for name in names],
                        [run[name] for name in names], 1.0, "to the last bit: no rounding",
                        scale=[bits(run[name]) for name in names]))
        # Digits that Python prints, more and less than it takes, read by mjdiag.
        file = os.path.join(folder, "printed.csv")
        texts = [format(v, f".{digits}e") for v, digits in
                 zip(x[8:], np.tile([3, 9, 15, 16, 17, 20, 25, 40], NUMBERS))]
        with open(file, "w", encoding="utf-8") as out:
            out.write("time [s],x [m]\n")
            out.writelines(f"{k / 1000!r},{text}\n" for k, text in enumerate(texts))
        rows.append(Row(FILES, ".csv with 4 to 41 digits", "`Record.read`", "Python's float",
                        mjdiag.Record.read(file)["x"], [float(t) for t in texts], 1.0,
                        "to the last bit: no rounding",
                        scale=bits(np.array([float(t) for t in texts]))))
    y = np.random.default_rng(2).standard_normal(500)
    units = (("um", 6), ("mm", 3), ("nm", 9))
    ours, theirs = [], []
    for unit, power in units:
        record = mjdiag.Record({"x": y}, {"x": unit}, 1.0)
        ours.append(record["x"])
        theirs.append([mpf(v) / mpf(10) ** power for v in y])
    record = mjdiag.Record({"x": y}, {"x": "deg"}, 1.0)
    ours.append(record["x"])
    theirs.append([mpf(v) * mpmath.pi / 180 for v in y])
    rows.append(Row(FILES, "units converted: nm, um, mm, deg", "`Record(units=...)`",
                    "mpmath", ours, theirs, 2.0, "a rounded factor and a product"))
    return rows


def bits(x):
    """So that a last bit is far more than is allowed: there is no rounding to allow."""
    return np.maximum(np.abs(x), 5e-324) * 2.0 ** -8


def shares(values, axis):
    """From 0 to 1 along a range, by the definition of docs/datasets.md."""
    a, b, healthy = (mpf(axis[key]) for key in ("from", "to", "healthy"))
    if axis["scale"] == "log":
        return [mpmath.log((mpf(v) - healthy) / (a - healthy))
                / mpmath.log((b - healthy) / (a - healthy)) for v in values]
    return [(mpf(v) - a) / (b - a) for v in values]


def sobol():
    """Points of a plan beside scipy's Sobol sequence. The plan shifts all of them, modulo 1,
    by what its seed draws; that is taken out by the first."""
    import mjdiag
    axes = [{"fault": "zeta_x", "from": 1.001, "to": 2.0, "scale": "log"},
            {"fault": "zeta_y", "from": 0.5, "to": 1.5, "scale": "linear"},
            {"fault": "eta_x", "from": 0.999, "to": 0.9, "scale": "log"},
            {"fault": "eta_y", "from": 0.9, "to": 1.1, "scale": "linear"},
            {"fault": "gamma", "from": 0.01, "to": 1.0, "scale": "log"}]
    points = 256
    study = mjdiag.Study({"setup": str(MJCF / "ab383"), "linear": True, "method": "sobol",
                          "points": points, "duration": 0.1, "axis": axes,
                          "keep": {"verdicts": True}})
    drawn = [study.describe(i)["values"] for i in range(points)]
    theirs = scipy.stats.qmc.Sobol(len(axes), scramble=False, bits=53).random_base2(8)
    ours, exact, condition = [], [], 1.0
    for j, axis in enumerate(axes):
        axis = {**axis, "healthy": 0.0 if axis["fault"] == "gamma" else 1.0}
        values = [point[axis["fault"]] for point in drawn]
        u = shares(values, axis)
        for k in range(1, points):
            change = mpf(theirs[k, j]) - mpf(theirs[0, j])
            apart = u[k] - u[0] - change
            ours.append(change + apart - mpmath.nint(apart))
            exact.append(change)
        # A value is rounded once, and its place in the range is told from it.
        span = abs(mpf(axis["to"]) - axis["from"])
        if axis["scale"] == "log":
            least = min(abs(v - axis["healthy"]) for v in values)
            moved = max(map(abs, values)) / least / abs(mpmath.log(
                (mpf(axis["to"]) - axis["healthy"]) / (mpf(axis["from"]) - axis["healthy"])))
        else:
            moved = max(map(abs, values)) / span
        condition = max(condition, float(2 * moved))
    return [Row(PLANS, "Sobol points in five axes, evenly and in logarithms",
                "`Study.describe(i)[\"values\"]`", "scipy.stats.qmc.Sobol", ours, exact,
                condition, "size of a value over its slope along the range, of two points",
                scale=1)]


def grids():
    import mjdiag
    axes = [{"fault": "zeta_x", "from": 1.0000001, "to": 1.00001, "scale": "log",
             "points": 33},
            {"fault": "eta_x", "from": 0.9, "to": 1.1, "points": 17}]
    study = mjdiag.Study({"setup": str(MJCF / "ab383"), "linear": True, "duration": 0.1,
                          "axis": axes, "keep": {"verdicts": True}})
    drawn = [study.describe(i)["values"] for i in range(study.runs)]
    ours = [sorted({point[axis["fault"]] for point in drawn}) for axis in axes]
    first, last = (mpf(axes[0][key]) - 1 for key in ("from", "to"))
    wanted = [[1 + first * (last / first) ** (mpf(i) / 32) for i in range(33)],
              [mpf(0.9) + (mpf(1.1) - mpf(0.9)) * i / 16 for i in range(17)]]
    return [Row(PLANS, "grids, evenly and in logarithms of the deviation",
                "`Study.describe(i)[\"values\"]`", "mpmath", ours, wanted, 2.0,
                "a deviation and its sum with what is healthy")]


ROWS = [round_trips, sobol, grids]
