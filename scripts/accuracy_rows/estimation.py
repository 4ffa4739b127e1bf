"""Estimates of faults, how sure they are, and the information bound."""

import functools
import pathlib
import tempfile
import xml.etree.ElementTree

import mpmath
import numpy as np

from .common import (LONG, MJCF, SHAKEN, Row, ask, condition_of, diagnosed, long_of,
                     matrix, mpf, read_csv, still)
from .filters import Bank, signals_of
from .linear import model_of
from .mechanics import tick_map

PART = "Estimation"
SHORT = ("--set", 'default_trajectory="xyz"', "--set", "trajectories.xyz.duration=0.3")
BONDER = MJCF / "ab383"


def simulated(*options):
    with tempfile.TemporaryDirectory() as folder:
        ask("simulate", "--setup", BONDER, "--linear", *options, "--out", folder)
        return read_csv(pathlib.Path(folder) / "record.csv")


def disturbance_wave(design, samples):
    """Forces of a disturbance of magnitude 1, inputs x samples."""
    source = design["disturbances"][0]
    t = np.arange(samples) * LONG(design["sample_time"])
    two_pi = long_of(2 * mpmath.pi)
    total = sum(np.sin(two_pi * LONG(f) * t) for f in source["frequencies"])
    return np.array(source["amplitude"], LONG)[:, None] * total


def regression(design, record, shake=still):
    """Residual, and what a unit of every fault leaves in it, at the regressed samples."""
    bank = Bank(design["filters"])
    z = signals_of(design, record)
    faults = len(design["faults"])
    filtered = bank.chain(list(range(1 + faults)), z, shake)
    forces = np.concatenate([np.zeros((3, z.shape[1]), LONG),
                             disturbance_wave(design, z.shape[1])])
    tone = -bank.chain([0], forces, shake)
    stride = design["stride"]
    return filtered[0, ::stride], np.concatenate([filtered[1:], tone])[:, ::stride]


def solve_normal(G, r, shake=still):
    """Least squares by the normal equations of docs/theory.md, 25 digits."""
    N, right = shake(G @ G.T), shake(G @ r)
    size = np.sqrt(np.diag(N))
    N = mp_of(N / np.outer(size, size))
    return [x / mpf_long(s) for x, s in zip(mpmath.lu_solve(N, mp_of((right / size)[:, None])),
                                            size)]


def mpf_long(x):
    high = float(x)
    return mpf(high) + mpf(float(x - LONG(high)))


def mp_of(A):
    return mpmath.matrix([[mpf_long(x) for x in row] for row in A])


def spread(design, G, shake=still):
    """Standard deviations: M = Cov(G^T n) as a sum over all that the sensors' noise ever
    did, by the adjoint of the filters, run backwards."""
    bank = Bank(design["filters"])
    order, m = bank.order, bank.outputs
    B = bank.B.astype(LONG).reshape(order, m, -1)[:, 0, :3]
    D = bank.D.astype(LONG)[0, :3]
    g, a = long_of(bank.gain), np.array([long_of(x) for x in bank.feedback])
    A = np.eye(order, dtype=LONG) + np.diag(np.full(order - 1, g), -1)
    A[:, -1] -= g * a
    stride, noise = design["stride"], np.array(design["sensor_noise"], LONG)
    faults, samples = G.shape
    costate = np.zeros((order, faults), LONG)
    M = np.zeros((faults, faults), LONG)
    for k in range((samples - 1) * stride, -1, -1):
        c = B.T @ costate
        costate = shake(A.T @ costate)
        if k % stride == 0:
            now = G[:, k // stride]
            c = c + np.outer(D, now)
            costate[-1] += now
        c = c * noise[:, None]
        M += c.T @ c
    N = G @ G.T
    size = np.sqrt(np.diag(N))
    inverse = mpmath.inverse(mp_of(shake(N) / np.outer(size, size)))
    inner = mp_of(shake(M) / np.outer(size, size))
    covariance = inverse * inner * inverse
    return [mpmath.sqrt(covariance[i, i]) / mpf_long(size[i]) for i in range(faults)]


def from_residuals():
    """Least squares of a diagnosis that has no twin, for a sensor has no noise."""
    quiet = (*SHORT, "--set", "sensors.x.noise_power=0.0")
    design = ask("design", "--setup", BONDER, "--linear", "--nominal-runs", 2, *quiet)
    with tempfile.TemporaryDirectory() as folder:
        ask("simulate", "--setup", BONDER, "--linear", *quiet, "--fault", "zeta_x=1.02",
            "eta_y=0.99", "gamma=0.01", "--out", folder)
        record = read_csv(file := pathlib.Path(folder) / "record.csv")
        said = diagnosed(design, file, *quiet)
    ours = [fault["deviation"] for fault in said["faults"]]

    def estimate(shake=still):
        r, G = regression(design, record, shake)
        return solve_normal(G, r, shake)

    exact = estimate()
    # What is not there is estimated as noise.
    scale = [max(abs(x), sd) for x, sd in
             zip(exact, spread(design, regression(design, record)[1]))]
    return [Row(PART, "faults from residuals, of what is there or of the noise",
                "`diagnose`, a sensor without noise",
                "least squares on residuals of our own, in long double", ours, exact,
                condition_of(estimate, exact, scale), SHAKEN, scale=scale)]


def bound():
    said = ask("study", "--setup", BONDER, "--preset", "bound", *SHORT)
    table = said["tables"][0]
    column = {name: [row[i] for row in table["rows"]]
              for i, name in enumerate(table["columns"])}
    design = ask("design", "--setup", BONDER, "--linear", "--nominal-runs", 2, *SHORT)
    record = simulated(*SHORT)
    _, G = regression(design, record)
    exact = spread(design, G)
    rows = [Row(PART, "standard deviations of faults from residuals",
                "`study --preset bound`: \"sd, one residual\"",
                "noise through the adjoint of the filters, in long double",
                column["sd, one residual"], exact,
                condition_of(lambda shake: spread(
                    design, regression(design, record, shake)[1], shake), exact), SHAKEN)]
    inputs = simulated(*SHORT, "--noise", 0)
    u = np.array([inputs[name] for name in design["inputs"]])
    exact = information_bound(design, u)
    rows.append(Row(PART, "information bound, alone and together",
                    "`study --preset bound`", "central differences of own runs, 50 digits "
                    "for the maps", [column["bound alone"], column["bound together"]],
                    exact, condition_of(lambda shake: information_bound(
                        design, u, shake), exact), SHAKEN))
    return rows


def faults_of_plant(D, Gamma):
    """Of every fault parameter its kind, and what it is a factor of: of the dampers, of the
    springs, of the motors' forces."""
    root = xml.etree.ElementTree.parse(BONDER / "plant.xml").getroot()
    joints = [joint for joint in root.iter("joint") if joint.get("name")]
    names = [joint.get("name") for joint in joints]
    motors = [motor.get("name") for motor in root.find("actuator")]
    faults = []
    for text in root.find("custom").findall("text"):
        kind, *of = text.get("data").split()
        d, k, gamma = (mpmath.zeros(*size) for size in (
            (D.rows, D.rows), (D.rows, D.rows), (D.rows, Gamma.cols)))
        for name in of:
            if kind == "gear":
                j = motors.index(name)
                gamma[:, j] = Gamma[:, j]
                continue
            j = names.index(name)
            d[j, j] = D[j, j] if kind == "damping" else 0
            k[j, j] = mpf(joints[j].get("stiffness", "0")) if kind == "stiffness" else 0
        faults.append((kind, d, k, gamma))
    return faults


@functools.lru_cache(maxsize=None)
def worn_maps():
    """Maps of a tick of the bonder with each fault parameter changed by -c and +c."""
    said = ask("linearize", "--setup", BONDER)
    M, D, K, Gamma = model_of(said)
    step = mpf(1) / 32000
    maps = []
    for kind, d, k, gamma in faults_of_plant(D, Gamma):
        c = mpf(0.01 if kind == "stiffness" else 1e-3)  # setup.toml, magnitudes
        maps.append((c, [[long_of(x) for x in tick_map(
            M, D + change * d, K + change * k, Gamma + change * gamma, step, 4)]
            for change in (-c, c)]))
    healthy = [long_of(x) for x in tick_map(M, D, K, Gamma, step, 4)]
    return maps, healthy, long_of(matrix(said["b"]).T)


def readings(tick, b, u, shake=still):
    A, B = shake(tick[0]), shake(tick[1])
    x, out = np.zeros(A.shape[0], LONG), []
    for column in u.T:
        out.append(b @ x[:b.shape[1]])
        x = shake(A @ x + B @ column)
    return np.array(out)


def information_bound(design, u, shake=still):
    maps, healthy, b = worn_maps()
    u = u.astype(LONG)
    parts = [(readings(plus, b, u, shake) - readings(minus, b, u, shake))
             / (2 * long_of(c)) for c, (minus, plus) in maps]
    parts.append(readings(healthy, b, disturbance_wave(design, u.shape[1]), shake))
    scaled = [part / np.array(design["sensor_noise"], LONG) for part in parts]
    information = np.array([[np.sum(a * c) for c in scaled] for a in scaled])
    size = np.sqrt(np.diag(information))
    inverse = mpmath.inverse(mp_of(shake(information / np.outer(size, size))))
    return [[1 / mpf_long(s) for s in size],
            [mpmath.sqrt(inverse[i, i]) / mpf_long(s) for i, s in enumerate(size)]]


ROWS = [from_residuals, bound]
