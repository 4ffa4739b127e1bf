"""The diagnosis of a machine made anew with SciPy, for diagnosis_scipy_test.cc.

Reads the matrices of the machine, the filters to be checked and a record from the file
named on the command line, and prints what the filters ought to be and do. Both are one
array a line: `name rows columns v11 v12 ...`, row by row, with 17 significant digits.
Nothing here follows the way of the program: modal coordinates instead of Cholesky
factors, SciPy's null space, filters in controllable instead of observable form,
covariances from Lyapunov equations.
"""

import sys

import numpy as np
from scipy import linalg, signal


def read(path):
    values = {}
    with open(path, encoding="ascii") as lines:
        for line in lines:
            name, rows, columns, *numbers = line.split()
            shape = int(rows), int(columns)
            values[name] = np.array(numbers, dtype=float).reshape(shape)
    return values


def show(name, values):
    values = np.atleast_2d(np.asarray(values, dtype=float))
    numbers = " ".join(f"{v:.17g}" for v in values.ravel())
    print(name, values.shape[0], values.shape[1], numbers)


class Machine:
    """M q'' + D q' + K q = Gamma u, y = b' q, in Euler steps of length h."""

    def __init__(self, given, prefix=""):
        self.M, self.D, self.K, self.Gamma, self.b = (
            given[prefix + name] for name in ("M", "D", "K", "Gamma", "b"))
        self.h = given["step"][0, 0]
        self.substeps = int(given["substeps"][0, 0])

    def tick(self):
        """x+ = A x + B u, y = C x over a tick, x = [q; v]."""
        n = len(self.M)
        rate = np.linalg.inv(self.M + self.h * self.D) * self.h
        to_v = np.hstack([-rate @ self.K, np.eye(n) - rate @ self.D])
        force = rate @ self.Gamma
        A = np.vstack([np.eye(n, 2 * n) + self.h * to_v, to_v])
        B = np.vstack([self.h * force, force])
        powers = [np.linalg.matrix_power(A, i) for i in range(self.substeps)]
        C = np.hstack([self.b.T, np.zeros_like(self.b.T)])
        return powers[-1] @ A, sum(powers) @ B, C

    def delta(self, scale):
        """The same in p = (z - 1) / scale and modal coordinates."""
        A, B, C = self.tick()
        n = len(self.M)
        period = self.h * self.substeps
        _, modes = linalg.eigh(self.K, self.M)
        back = linalg.block_diag(modes, modes / period)
        to = linalg.block_diag(modes.T @ self.M, period * modes.T @ self.M)
        return to @ (A - np.eye(2 * n)) @ back / scale, to @ B / scale, C @ back

    def response(self, z):
        """[G(z); I]: what z = [y; u] is for every unit command."""
        A, B, C = self.tick()
        inputs = B.shape[1]
        G = C @ np.linalg.solve(z * np.eye(len(A)) - A, B.astype(complex))
        return np.vstack([G, np.eye(inputs)])


def observability_stack(A, C, degree):
    blocks = [C]
    for _ in range(degree):
        blocks.append(blocks[-1] @ A)
    # The left null space does not see how the states are scaled.
    stack = np.vstack(blocks)
    size = np.linalg.norm(stack, axis=0)
    return stack / np.where(size > 0.0, size, 1.0)


def parity_relations(A, B, C, degree):
    """Numerators over z = [y; u] of every parity relation, (degree + 1) nz columns."""
    outputs = len(C)
    rows = linalg.null_space(observability_stack(A, C, degree).T, rcond=1e-11).T
    blocks = rows.reshape(len(rows), degree + 1, outputs)
    quotient = np.zeros((len(rows), len(A)))
    numerators = []
    for k in range(degree, -1, -1):
        numerators.insert(0, np.hstack([blocks[:, k], -quotient @ B]))
        quotient = quotient @ A + blocks[:, k] @ C
    return np.hstack(numerators)


def evaluate(numerators, p, signals):
    """sum_k N_k p^k"""
    count = numerators.shape[1] // signals
    return sum(numerators[:, k * signals:(k + 1) * signals] * p**k for k in range(count))


def angle_between(first, second, signals, outputs):
    """Largest principal angle of two row spaces. Powers of p count alike, and so do
    outputs and inputs; single coefficients do not, for some of them are zero."""
    size = np.abs(first).max(axis=0).reshape(-1, signals)
    for part in (size[:, :outputs], size[:, outputs:]):
        part[:] = part.max(axis=1, keepdims=True)
    size[size == 0.0] = 1.0
    return linalg.subspace_angles((first / size.ravel()).T, (second / size.ravel()).T).max()


def points(random, count):
    """On the unit circle, where filters work, and around it."""
    angles = random.uniform(0.05, np.pi, count)
    return np.exp(1j * angles) * np.r_[np.ones(count // 2),
                                       random.uniform(0.9, 1.1, count - count // 2)]


def misfit(machine, numerators, scale, zs):
    """Largest |N [G; I]| over what it is the difference of."""
    worst = 0.0
    for z in zs:
        response = machine.response(z)
        row = evaluate(numerators, (z - 1) / scale, len(response))
        worst = max(worst, (np.abs(row @ response) / (np.abs(row) @ np.abs(response))).max())
    return worst


def filter_system(numerators, order, cutoff, period, scale, signals):
    """N(p) / d(p) in controllable form, a chain of integrators a signal."""
    _, poles, _ = signal.butter(order, 2 * np.pi * cutoff, analog=True, output="zpk")
    roots = (np.exp(poles * period) - 1) / scale
    corner = np.prod(np.abs(roots)) ** (1 / order)
    denominator = np.poly(roots / corner).real[::-1]  # ascending, in q = p / corner
    chain = np.eye(order, k=1)
    chain[-1] = -denominator[:-1]
    A = np.eye(order) + scale * corner * chain
    B = scale * corner * np.eye(order)[:, -1:]
    degree = numerators.shape[1] // signals - 1
    C = np.zeros((len(numerators), signals, order))
    D = np.zeros((len(numerators), signals))
    for k in range(degree + 1):
        part = numerators[:, k * signals:(k + 1) * signals] * corner**(k - order)
        if k < order:
            C[:, :, k] += part
        else:
            C -= part[:, :, None] * denominator[None, None, :-1]
            D += part
    every = np.eye(signals)
    return (np.kron(every, A), np.kron(every, B), C.reshape(len(numerators), -1), D,
            period), denominator[:-1], scale * corner


def covariance(system, noise):
    A, B, C, D, _ = system
    B, D = B * noise, D * noise
    states = linalg.solve_discrete_lyapunov(A, B @ B.T)
    return C @ states @ C.T + D @ D.T


def derivatives(given, machine, numerators, scale, zs):
    """-dR/df of every fault by its effect on the healthy relation, and as the filters say."""
    errors = []
    for i, magnitude in enumerate(given["magnitudes"][0]):
        minus = Machine(given, f"minus{i}.")
        plus = Machine(given, f"plus{i}.")
        seen, expected = [], []
        for z in zs:
            p = (z - 1) / scale
            signals = len(machine.b.T) + machine.Gamma.shape[1]
            change = (plus.response(z) - minus.response(z)) / (2 * magnitude)
            expected.append(evaluate(numerators[:1], p, signals) @ change)
            phi = evaluate(numerators[i + 1:i + 2], p, signals)
            seen.append(phi @ machine.response(z))
        seen, expected = np.array(seen), np.array(expected)
        errors.append(np.linalg.norm(seen - expected) / np.linalg.norm(expected))
    return errors


def main():
    given = read(sys.argv[1])
    machine = Machine(given)
    scale = given["delta_scale"][0, 0]
    degree = int(given["degree"][0, 0])
    period = machine.h * machine.substeps
    record = given["record"]
    signals = len(record)
    zs = points(np.random.default_rng(20240607), 40)
    A, B, C = machine.delta(scale)

    show("nullity", [len(parity_relations(A, B, C, d)) for d in range(degree + 1)])
    show("angle", angle_between(given["space"], parity_relations(A, B, C, degree), signals,
                                len(C)))
    for name in ("space", "disturbance"):
        show(f"{name}.misfit", misfit(machine, given[name], scale, zs))
    show("bank.misfit", misfit(machine, given["bank"][:1], scale, zs))
    show("derivatives", derivatives(given, machine, given["bank"], scale, zs))

    for name in ("space", "bank", "disturbance"):
        order, cutoff = given[f"{name}.denominator"][0]
        system, feedback, gain = filter_system(given[name], int(order), cutoff, period,
                                               scale, signals)
        show(f"{name}.feedback", feedback)
        show(f"{name}.gain", gain)
        show(f"{name}.covariance", covariance(system, given["noise"][0]))
        _, output, _ = signal.dlsim(system, record.T)
        show(f"{name}.output", output.T)

    order, cutoff = given["high_pass"][0]
    sections = signal.butter(int(order), cutoff, "high", fs=1 / period, output="sos")
    high = signal.sosfilt(sections, output[:, 0])
    show("high_passed", high)
    show("density", signal.welch(high, 1 / period, "hann", int(given["segment"][0, 0])))


if __name__ == "__main__":
    main()
