"""Quantiles and probabilities, as far as documents show them."""

import pathlib
import tempfile

import mpmath
import numpy as np
import scipy.signal
import scipy.stats

from .common import (LONG, MJCF, SHAKEN, Row, ask, condition_of, mpf, read_csv, still)
from .estimation import regression, solve_normal
from .runs import wave
from .spectra import BONDER, SHORT

PART = "Distributions"


def normal_quantile(two_sided):
    """Exceeded by |x| with this probability, of mpmath."""
    return mpmath.sqrt(2) * mpmath.erfinv(1 - mpf(two_sided))


def false_alarms():
    """Limits by a wanted probability: mean -+ k sd with P(|X| > k) = P / samples."""
    ours, theirs = [], []
    for probability in (0.5, 1e-3, 1e-8, 1e-15):
        limits = ask("design", "--setup", BONDER, "--linear", "--nominal-runs", 2, *SHORT,
                     "--set", f"diagnosis.thresholds.false_alarms={probability}")["limits"]
        mean, sd = mpf(limits["fit"]["mean"]), mpf(limits["fit"]["sd"])
        reach = normal_quantile(mpf(probability) / 3200) * sd
        ours.append(limits["residual"])
        theirs.append([mean - reach, mean + reach])
    return [Row(PART, "normal quantiles of 1.6e-4 to 3e-19, as limits of the residual",
                "`design` with `false_alarms`: `limits.residual`", "mpmath.erfinv", ours,
                theirs, 2.0, "a product and a sum")]


def intervals():
    """95 % intervals and the table of errors of a small study, and intervals of counts."""
    import mjdiag
    study = mjdiag.Study({
        "setup": str(BONDER), "linear": True, "trajectories": ["xyz"], "duration": 0.26,
        "method": "random", "points": 10,
        "axis": [{"fault": "zeta_x", "from": 1.0000005, "to": 1.00001, "scale": "log"}],
        "keep": {"verdicts": True, "estimates": True}})
    with tempfile.TemporaryDirectory() as folder:
        done = study.run(folder)
        truth = np.ones(done.estimates.shape)
        truth[:, done.fault_names.index("zeta_x")] = done.runs["zeta_x"]
        errors, sds = done.estimates - truth, np.array(done.estimate_sd)
        tables, names = done.tables, done.fault_names
    ours, theirs, said, wanted = [], [], [], []
    for table in tables:
        columns = table.get("columns") or []
        for row in table.get("rows") or []:
            cell = dict(zip(columns, row))
            if table["title"] == "Errors of the estimates":
                i = names.index(cell["fault"])
                e = [mpf(float(x)) for x in errors[:, i]]
                s = [mpf(float(x)) for x in sds[:, i]]
                inside = sum(abs(x) <= normal_quantile(0.05) * y for x, y in zip(e, s))
                ours.append([cell["mean error"], cell["rms error"],
                             cell["sd claimed, rms"], cell["inside 95 % interval [%]"]])
                root = mpmath.sqrt(sum(x * x for x in e) / len(e))
                theirs.append([sum(e) / len(e), root,
                               mpmath.sqrt(sum(x * x for x in s) / len(s)),
                               mpf(100 * inside) / len(e)])
                counted = (inside, len(e), cell["95 % interval of that [%]"])
            elif "95 % interval [%]" in cell:
                share = cell.get("[%]", cell.get("named [%]"))
                n = int(cell["runs"])
                counted = (round(share * n / 100), n, cell["95 % interval [%]"])
            else:
                continue
            said += [float(x) for x in counted[2].split(" to ")]
            wanted += printed(clopper_pearson(*counted[:2]))
    mean_condition = max(float(sum(abs(x) for x in column) / abs(sum(column)))
                         for column in errors.T[:len(ours)])
    return [Row(PART, "errors of estimates: mean, rms, sd, share inside 95 %",
                "`Study.run().tables`", "sums over `estimates` in 50 digits", ours, theirs,
                1 + mean_condition, "sum of the sizes over the size of the sum"),
            Row(PART, "Clopper and Pearson's intervals, to the four digits printed",
                "`Study.run().tables`", "scipy.stats.beta", said, wanted, 1.0,
                "digits are compared")]


def clopper_pearson(k, n):
    return (scipy.stats.beta.ppf(0.025, k, n - k + 1) if k else 0.0,
            scipy.stats.beta.isf(0.025, k + 1, n - k) if k < n else 1.0)


def printed(values):
    return [float(f"{100 * x:.4g}") for x in values]


def usual_estimates():
    """Intervals of healthy estimates of the nonlinear machine: Student's t, 1e-3."""
    runs = 3
    design = ask("design", "--setup", BONDER, "--nominal-runs", runs, *SHORT)
    records = []
    for seed in range(1001, 1001 + runs):
        with tempfile.TemporaryDirectory() as folder:
            ask("simulate", "--setup", BONDER, *SHORT, "--seed", seed, "--out", folder)
            records.append(read_csv(pathlib.Path(folder) / "record.csv"))

    def interval(shake=still):
        values = []
        for record in records:
            residual, regressors = regression(design, record, shake)
            values.append(solve_normal(regressors, residual, shake))
        out = []
        # 2 degrees of freedom: the quantile has a formula.
        p = mpf(0.5) * mpf(1e-3)
        t = (1 - 2 * p) / mpmath.sqrt(2 * p * (1 - p))
        for column in zip(*values):
            mean = sum(column) / runs
            sd = mpmath.sqrt(sum((x - mean) ** 2 for x in column) / (runs - 1))
            reach = t * sd * mpmath.sqrt(1 + mpf(1) / runs)
            out.append([mean - reach, mean + reach])
        return out

    exact = interval()
    scale = [[b - a] * 2 for a, b in exact]
    return [Row(PART, "Student's t: where healthy estimates lie",
                "`design`: `limits.estimates`", "own least squares, formula of t for two "
                "degrees of freedom", design["limits"]["estimates"], exact,
                condition_of(interval, exact, scale), SHAKEN, scale=scale)]


def mismatch():
    """Whether a record has more than noise: Fisher's F and Student's t."""
    import mjdiag
    machine = mjdiag.Machine(str(MJCF / "voice_coil"))
    current = 0.2 * wave(6000, 5000)
    push = mjdiag.Record({"i": current}, {"i": "A"}, 1 / 5000)
    clean = machine.simulate(replay=push, noise=0.0)["x"]
    noisy = [machine.simulate(replay=push, seed=seed)["x"] for seed in range(1, 9)]
    records = [machine.simulate(replay=push, seed=seed)["x"]
               + extra * np.sin(np.arange(6000) / 50)
               for seed, extra in ((21, 0.0), (22, 2e-9), (23, 4e-9), (24, 7e-9))]
    channels = []
    for measured in records:
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "measured.csv"
            mjdiag.Record({"i": current, "x": measured}, {"i": "A", "x": "m"},
                          1 / 5000).write(file)
            channels.append(ask("compare", "--setup", MJCF / "voice_coil", "--record", file,
                                status=(0, 1))["channels"]["x"])
    keys = ("rms", "mae", "peak", "fit_percent", "relative_error_percent")

    def figures(shake=still):
        return [figures_of(y.astype(LONG), shake(y.astype(LONG) - clean)) for y in records]

    def probabilities(shake=still):
        draws = [np.asarray(shake(y.astype(LONG)) - shake(clean.astype(LONG)), float)
                 for y in noisy]
        return [noise_probability(float(row[0]), channel["noise_floor"], draws)
                for row, channel in zip(figures(), channels)]

    return [Row(PART, "mismatch: rms, mean, peak, fit, relative error",
                "`compare`: `channels`", "numpy, of the same simulation",
                [[channel[key] for key in keys] for channel in channels], figures(),
                condition_of(figures, figures()), SHAKEN),
            Row(PART, "probabilities that a mismatch is noise: F and t",
                "`compare`: `p_value`", "scipy.stats.f, scipy.stats.t, eight own draws",
                [channel["p_value"] for channel in channels], probabilities(),
                condition_of(probabilities, probabilities()), SHAKEN)]


def figures_of(y, e):
    size = np.sqrt(np.sum(e ** 2))
    return [np.sqrt(np.mean(e ** 2)), np.mean(abs(e)), abs(e).max(),
            100 * (1 - size / np.sqrt(np.sum((y - y.mean()) ** 2))),
            100 * size / np.sqrt(np.sum(y ** 2))]


def noise_probability(rms, floor, noise):
    """Of the size of the record's own noise, by its floor; eight draws, from seed 1 on."""
    draws = np.array([np.sqrt(np.mean(x ** 2)) for x in noise])
    draws *= floor / np.sqrt(np.mean(draws ** 2))
    n, segment = len(noise[0]), 4096
    while segment > 64 and 8 * segment > n:
        segment //= 2
    density = sum(scipy.signal.welch(x, 5000, "hann", segment)[1] for x in noise)
    freedom = max(1.0, n * density.sum() ** 2 / (len(density) * (density ** 2).sum()))
    level = n / (2 * 1.2 ** 2 * 6)
    of_floor = 1 / (1 / (8 * freedom) + 1 / level)
    f = scipy.stats.f.sf((rms / floor) ** 2, freedom, of_floor)
    logs = np.log(draws ** 2)
    t = (np.log(rms ** 2) - logs.mean()) / (logs.std(ddof=1) * np.sqrt(1 + 1 / 8))
    return max(f, scipy.stats.t.sf(t, 7))


ROWS = [false_alarms, intervals, usual_estimates, mismatch]
