"""The residual filters of a design, as transfer functions in 60 digits."""

import functools
import pathlib
import tempfile

import mpmath
import numpy as np
import scipy.signal

from .common import (LONG, MJCF, SHAKEN, Row, ask, condition_of, diagnosed, long_of,
                     matrix, mpf, read_csv, still)
from .linear import model_of
from .mechanics import blocks, tick_map

PART = "Filters"
DELTA = mpf(1) / 2  # p = (z - 1) / DELTA (docs/theory.md, The exact tick in delta form)


@functools.lru_cache(maxsize=None)
def designed(*options):
    """A design of the bonder with thresholds of the linear plant: its filters.json."""
    return ask("design", "--setup", MJCF / "ab383", "--linear", *options)


class Bank:
    """Filters of filters.json: x_k+ = x_k + g (x_k-1 - a_k x_last) + (B z)_k."""

    def __init__(self, document):
        self.gain = mpf(document["gain"])
        self.feedback = [mpf(a) for a in document["feedback"]]
        self.D = np.array(document["D"])
        self.B = np.array(document["B"])
        self.order, self.outputs = len(self.feedback), len(self.D)

    def denominator(self):
        """det(z I - A), powers of z from the highest on."""
        # With q = (z - 1) / g: q^n + sum a_k q^k.
        return self.in_z([*self.feedback, mpf(1)])

    def in_z(self, coefficients):
        """g^n sum c_k ((z - 1) / g)^k."""
        total = [mpf(0)] * (self.order + 1)
        for k, c in enumerate(coefficients):
            for i in range(k + 1):
                total[self.order - i] += c * self.gain ** (self.order - k) \
                    * mpmath.binomial(k, i) * (-1) ** (k - i)
        return total

    def numerator(self, output, signal):
        """Of one output, powers of z from the highest on."""
        # Stage k of B adds B_k / g q^k to the numerator, D all of the denominator.
        c = [mpf(self.B[k * self.outputs + output, signal]) / self.gain
             for k in range(self.order)] + [mpf(0)]
        d = mpf(self.D[output, signal])
        return [x + d * y for x, y in zip(self.in_z(c), self.denominator())]

    def run(self, output, signals):
        """scipy's recursion on numbers of 60 digits, from rest."""
        with mpmath.workdps(60):
            total = None
            for i, signal in enumerate(signals):
                b = np.array(self.numerator(output, i), dtype=object)
                numbers = np.array([mpf(x) for x in signal], dtype=object)
                # The denominator is common: numerators first.
                part = scipy.signal.lfilter(b, np.array([mpf(1)], dtype=object), numbers)
                total = part if total is None else total + part
            return scipy.signal.lfilter(np.array([mpf(1)], dtype=object), np.array(
                self.denominator(), dtype=object), total)

    def chain(self, outputs, signals, shake=still):
        """The same as stages in long double: outputs x samples."""
        g = long_of(self.gain)
        feedback = shake(np.array([long_of(a) for a in self.feedback]))
        B = shake(self.B.astype(LONG)).reshape(self.order, self.outputs, -1)[:, outputs]
        D = shake(self.D.astype(LONG))[outputs]
        x = np.zeros((self.order, len(outputs)), LONG)
        out = []
        for z in np.asarray(signals, LONG).T:
            last = x[-1]
            out.append(last + D @ z)
            before = np.concatenate([np.zeros((1, len(outputs)), LONG), x[:-1]])
            x = shake(x + g * (before - feedback[:, None] * last) + B @ z)
        return np.array(out).T


def signals_of(design, record):
    z = [record[name] - offset for name, offset in zip(design["outputs"], design["offset"])]
    return np.array(z + [record[name] for name in design["inputs"]])


def applied():
    """The residual that a diagnosis shows, beside lfilter in 60 digits."""
    import mjdiag
    design = designed()
    with tempfile.TemporaryDirectory() as folder:
        ask("simulate", "--setup", MJCF / "ab383", "--linear", "--trajectory", "xyz",
            "--fault", "zeta_x=1.01", "--duration", 0.3, "--out", folder)
        file = pathlib.Path(folder) / "record.csv"
        said = diagnosed(design, file)["residual"]
        residual = mjdiag.Machine(str(MJCF / "ab383")).diagnose(
            str(file), linear=True, filters=str(file.parent / "filters.json")).residual
        record = read_csv(file)
    bank = Bank(design["filters"])
    z = signals_of(design, record)
    theirs = list(bank.run(0, z))
    largest = max(map(abs, theirs))
    condition = condition_of(lambda shake: bank.chain([0], z, shake), theirs, largest)
    return [Row(PART, "residual of a record", "`Machine.diagnose(record).residual`",
                "scipy.signal.lfilter in 60 digits", residual, theirs, condition, SHAKEN,
                scale=largest),
            Row(PART, "extremes of the residual", "`diagnose`: `residual.min`, `residual.max`",
                "scipy.signal.lfilter in 60 digits", [said["min"], said["max"]], [min(theirs), max(theirs)],
                condition, SHAKEN, scale=largest)]


def butterworth(order, cutoff, tick):
    """Coefficients of powers of p / corner, and the gain of the stages."""
    radius = 2 * mpmath.pi * mpf(cutoff)
    poles = [(mpmath.exp(radius * tick * mpmath.expjpi(mpf(2 * i + 1 + order) / (2 * order)))
              - 1) / DELTA for i in range(order)]
    d = [mpf(1)]
    for pole in poles:  # from the highest power on
        d = [a - pole * b for a, b in zip([*d, 0], [0, *d])]
    d = [mpmath.re(c) for c in reversed(d)]
    corner = abs(d[0]) ** (mpf(1) / order)
    return [c * corner ** (k - order) for k, c in enumerate(d[:-1])], DELTA * corner


def denominators():
    design = designed()
    tick = mpf(design["sample_time"])
    ours, theirs = [], []
    for filters, cutoff in ((design["filters"], 50), (design["disturbance"]["filters"], 750)):
        feedback, gain = butterworth(7, cutoff, tick)
        ours += [*filters["feedback"], filters["gain"]]
        theirs += [*feedback, gain]
    # exp(s T) - 1 of the slow poles keeps a part |s| T of its digits, in the gain and in
    # all powers of the corner.
    condition = float(7 / (2 * mpmath.pi * 50 * tick))
    rows = [Row(PART, "denominators: Butterworth poles at exp(s T)",
                "`design`: `feedback`, `gain`", "products of the poles in 50 digits",
                ours, theirs, condition,
                "seven poles, each a difference of exp(s T) from 1: 7 / (|s| T)")]
    return [*rows, high_pass(design["disturbance"]["high_pass"])]


def high_pass(sections):
    """Magnitudes at some frequencies, for scipy shares the gain out in another way."""
    sos = scipy.signal.butter(3, 100, "highpass", fs=8000, output="sos")
    other = [[*s[:3], *s[4:]] for s in sos]
    edge = mpmath.tan(mpmath.pi * 100 / 8000)

    def parts(section, f):
        z = mpmath.expjpi(-2 * mpf(f) / 8000)
        b, a = [mpf(x) for x in section[:3]], [mpf(1), *map(mpf, section[3:])]
        return [(abs(sum(c * z ** k for k, c in enumerate(p))), sum(map(abs, p)))
                for p in (b, a)]

    ours, theirs, condition = [], [], 0.0
    for f in (20, 50, 99, 100, 300, 750, 3000):
        mine, scipys, moved = mpf(1), mpf(1), 0
        for one, two in zip(sections, other):
            (b, b_sum), (a, a_sum) = parts(one, f)
            mine *= b / a
            moved += b_sum / b + a_sum / a
        for two in other:
            (b, _), (a, _) = parts(two, f)
            scipys *= b / a
        ours += [mine, mine]
        ratio = (edge / mpmath.tan(mpmath.pi * f / 8000)) ** 6
        theirs += [scipys, 1 / mpmath.sqrt(1 + ratio)]
        condition = max(condition, float(moved))
    return Row(PART, "high-pass of the disturbance residual, at 7 frequencies",
               "`design`: `disturbance.high_pass`",
               "scipy.signal.butter, and the formula of its magnitude", ours, theirs,
               condition, "sums of the coefficients' sizes over those of polynomials")


@functools.lru_cache(maxsize=None)
def bonder():
    """Printed M, D, K, Gamma and b."""
    said = ask("linearize", "--setup", MJCF / "ab383")
    return [*model_of(said), matrix(said["b"])]


def delta_form(M, D, K, Gamma, b):
    """A, B, C of a tick in powers of p, in coordinates of unit mass and velocities times
    the tick (docs/theory.md, The exact tick in delta form)."""
    n, tick = M.rows, mpf(1) / 8000
    A, B = tick_map(M, D, K, Gamma, tick / 4, 4)
    root = mpmath.cholesky(M).T
    inverse = mpmath.inverse(root)
    zero = mpmath.zeros(n)
    to = blocks([[root, zero], [zero, tick * root]])
    back = blocks([[inverse, zero], [zero, inverse / tick]])
    C = blocks([[b.T, mpmath.zeros(b.cols, n)]])
    return to * (A - mpmath.eye(2 * n)) * back / DELTA, to * B / DELTA, C * back


def size(A):
    return A.apply(abs)


class Stack:
    """C A^i, one below the other, with a size of every row and column."""

    def __init__(self, A, B, C, degree, shake=still):
        self.B, self.powers = shake(B), [shake(C)]
        A = shake(A)
        for _ in range(degree):
            self.powers.append(shake(self.powers[-1] * A))
        self.rows = blocks([[part] for part in self.powers])
        n, m = self.rows.rows, self.rows.cols
        self.row_size = [max(size(self.rows[i, :])) for i in range(n)]
        self.column_size = [max(abs(self.rows[i, j]) / self.row_size[i] for i in range(n))
                            for j in range(m)]

    def inputs(self, Ny):
        """The input polynomials that belong to output polynomials."""
        count = len(Ny)
        return [-sum((Ny[i] * self.powers[i - k - 1] * self.B
                      for i in range(k + 1, count)),
                     mpmath.zeros(Ny[0].rows, self.B.cols)) for k in range(count)]

    def relations(self):
        """All parity relations of the degree, orthonormal where rows are of one size."""
        n, m = self.rows.rows, self.rows.cols
        even = matrix([[self.rows[i, j] / self.row_size[i] / self.column_size[j]
                        for j in range(m)] for i in range(n)])
        Q, _ = mpmath.qr(even)
        ny = self.powers[0].rows
        Ny = [matrix([[Q[ny * k + i, j] / self.row_size[ny * k + i] for i in range(ny)]
                      for j in range(m, n)]) for k in range(len(self.powers))]
        return [blocks([[y, u]]) for y, u in zip(Ny, self.inputs(Ny))]


def bank_of(numerators, order, cutoff):
    """Stages of filters N(p) / d(p) in long double; numerators as matrices, rows x signals,
    one a power of p."""
    feedback, gain = butterworth(order, cutoff, mpf(1) / 8000)
    corner, m = gain / DELTA, numerators[0].rows
    parts = [N * corner ** (k - order) for k, N in enumerate(numerators)]
    parts += [mpmath.zeros(m, numerators[0].cols)] * (order + 1 - len(parts))
    bank = Bank.__new__(Bank)
    bank.gain, bank.feedback, bank.order, bank.outputs = gain, feedback, order, m
    bank.D = long_of(parts[order])
    bank.B = np.concatenate([long_of(gain * (parts[k] - feedback[k] * parts[order]))
                             for k in range(order)])
    return bank


def noise_covariance(bank, noise):
    """Of all outputs under white noise of the sensors: sums over impulse responses."""
    total, outputs = LONG(0), list(range(bank.outputs))
    for i, sd in enumerate(noise):
        impulse = np.zeros((bank.B.shape[1], 6000), LONG)
        impulse[i, 0] = sd
        h = bank.chain(outputs, impulse)
        total = total + h @ h.T
    return total


def residual_variance(bank, noise, shake=still):
    """Of the residual: its impulse response by powers of the stages' matrix."""
    order, g = bank.order, long_of(bank.gain)
    A = np.eye(order, dtype=LONG) + np.diag(np.full(order - 1, g), -1)
    A[:, -1] -= g * np.array([long_of(x) for x in bank.feedback])
    A = shake(A)
    B = shake(bank.B.astype(LONG).reshape(order, bank.outputs, -1)[:, 0, :3])
    sd = np.array(noise, LONG)
    total = np.sum((bank.D[0, :3] * sd) ** 2)
    answer = np.zeros(order, LONG)
    answer[-1] = 1
    for _ in range(6000):
        total += np.sum((answer @ B * sd) ** 2)
        answer = answer @ A
    return total


def noise_condition(relations):
    """Root of the condition number of their noise."""
    covariance = noise_covariance(bank_of(relations, 7, 50), [2e-8] * 3)
    spread = np.linalg.eigvalsh(covariance.astype(float))
    return float(np.sqrt(spread[-1] / spread[0]))


def nulling():
    """R z = 0 on all that the healthy machine does: both equations of docs/theory.md,
    Null space, for the relation of the design; and its noise is 1."""
    design = designed()
    rows = [matrix(part) for part in design["rows"]]
    Ny, Nu = [row[:, :3] for row in rows], [row[:, 3:] for row in rows]
    stack = Stack(*delta_form(*bonder()), len(rows) - 1)
    output = blocks([Ny])
    # A scale for every column, of the stack with its rows and columns equilibrated.
    weight = sum(abs(x) * r for x, r in zip(output, stack.row_size))
    ours = list(output * stack.rows)
    scale = [weight * c for c in stack.column_size]
    for k, wanted in enumerate(stack.inputs(Ny)[:-1]):
        for j in range(3):
            ours.append(Nu[k][j] - wanted[j])
            scale.append(max(abs(N[j]) for N in Nu))
    # The design takes a combination of all relations of the degree.
    condition = noise_condition(stack.relations())
    filters = Bank(design["filters"])
    variance = residual_variance(filters, design["sensor_noise"])
    rows = [Row(PART, "variance of the residual's noise: 1", "`design`: `filters`",
                "sum over the impulse response in long double", 1.0, variance,
                condition_of(lambda shake: residual_variance(
                    filters, design["sensor_noise"], shake), variance), SHAKEN)]
    return [*rows, Row(PART, "the residual is blind to the healthy machine",
                       "`design`: `rows`",
                       "sum N_y,i C A^i = 0 and the rows of u, in 50 digits", ours,
                       [0] * len(ours), condition,
                       "root of that of the noise of all relations", scale=scale)]


ROWS = [applied, denominators, nulling]
