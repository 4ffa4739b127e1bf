"""Estimates of faults, how sure they are, and the information bound."""

import functools
import pathlib
import tempfile

import mpmath
import numpy as np

from .common import (LONG, MJCF, SHAKEN, Row, ask, condition_of, long_of, matrix, mpf,
                     read_csv, still)
from .filters import Bank, signals_of
from .linear import model_of
from .mechanics import tick_map
from .runs import wave

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
        filters = pathlib.Path(folder) / "filters.json"
        import json
        filters.write_text(json.dumps(design), encoding="utf-8")
        said = ask("diagnose", "--setup", BONDER, "--linear", *quiet, "--filters", filters,
                   "--record", file, status=(0, 1))
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


@functools.lru_cache(maxsize=None)
def worn_maps():
    """Maps of a tick of the bonder with each fault parameter changed by -c and +c."""
    import xml.etree.ElementTree
    root = xml.etree.ElementTree.parse(BONDER / "plant.xml").getroot()
    said = ask("linearize", "--setup", BONDER)
    M, D, K, Gamma = model_of(said)
    joints = [joint.get("name") for joint in root.iter("joint") if joint.get("name")]
    stiffness = {joint.get("name"): mpf(joint.get("stiffness", "0"))
                 for joint in root.iter("joint")}
    motors = [motor.get("name") for motor in root.find("actuator")]
    step = mpf(1) / 32000
    b = long_of(matrix(said["b"]).T)
    maps = []
    for text in root.find("custom").findall("text"):
        kind, *names = text.get("data").split()
        c = mpf(0.01 if "beta" in text.get("name") else 1e-3)
        pair = []
        for change in (-c, c):
            d, k, gamma = D.copy(), K.copy(), Gamma.copy()
            for name in names:
                if kind == "damping":
                    d[joints.index(name), joints.index(name)] *= 1 + change
                elif kind == "stiffness":
                    k[joints.index(name), joints.index(name)] += change * stiffness[name]
                else:
                    j = motors.index(name)
                    for i in range(gamma.rows):
                        gamma[i, j] *= 1 + change
            pair.append([long_of(x) for x in tick_map(M, d, k, gamma, step, 4)])
        maps.append((c, pair))
    healthy = [long_of(x) for x in tick_map(M, D, K, Gamma, step, 4)]
    return maps, healthy, b


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


def twin_tick(theta, shake):
    """Map of a control tick of the voice coil: of position, velocity, and what they change
    by with the logarithms of damper, spring and coil, and of the current."""
    m, d, k, c = shake(np.array([LONG("0.12"), 4, 900, 12]))
    d, k, c = np.exp(np.array([long_of(x) for x in theta])) * np.array([d, k, c])
    h = LONG("0.0001")
    columns = []
    for start in np.eye(9, dtype=LONG):  # the last one a unit of current
        q, v, dq, dv, i = start[0], start[1], start[2:5], start[5:8], start[8]
        for _ in range(2):
            a = (c * i - d * v - k * q) / (m + h * d)
            force = np.array([-d * v - h * d * a, -k * q, c * i])
            da = (force - d * dv - k * dq) / (m + h * d)
            v, dv = v + h * a, dv + h * da
            q, dq = q + h * v, dq + h * dv
        columns.append(np.concatenate([[q, v], dq, dv]))
    return shake(np.array(columns).T)


def twin_sums(reading, current, theta=(0, 0, 0), shake=still):
    """One pass of a twin of the voice coil about `theta`, logarithms of what damper, spring
    and coil are over what they were: estimate, and information H, from means over blocks of
    8 ticks (docs/theory.md, Estimation by a twin)."""
    tick, sd, block = twin_tick(theta, shake), LONG(5e-8), 8
    x, e, psi = np.zeros(8, LONG), [], []
    for y, i in zip(reading, current):
        e.append(LONG(y) - x[0])
        psi.append(x[2:5])
        x = shake(tick[:, :8] @ x + tick[:, 8] * LONG(i))
    n = len(e) // block * block
    e = shake(np.array(e[:n]).reshape(-1, block).mean(axis=1))
    psi = np.array(psi[:n]).reshape(-1, block, 3).mean(axis=1)
    weight, prior = block / sd ** 2, LONG(100)  # a standard deviation of 0.1
    theta = np.array([long_of(t) for t in theta])
    H = mp_of(shake(psi.T @ psi * weight + np.eye(3, dtype=LONG) * prior))
    g = mp_of(shake((psi.T @ e * weight - prior * theta)[:, None]))
    return matrix_list(mpmath.lu_solve(H, g), theta), H


def matrix_list(change, theta):
    return [mpf_long(t) + c for t, c in zip(theta, change)]


def deviations(theta):
    return [mpmath.expm1(t) for t in theta]


def spreads(H):
    covariance = mpmath.inverse(H)
    return [mpmath.sqrt(covariance[i, i]) for i in range(H.rows)]


def seen_sizes(H):
    """A fault is named from here on: 1e-4 over all faults, beside others that are healthy
    (docs/theory.md, Names)."""
    sigmas = mpmath.sqrt(2) * mpmath.erfinv(1 - mpf(1e-4) / H.rows)
    return [mpmath.expm1(sigmas / mpmath.sqrt(H[i, i])) for i in range(H.rows)]


def twin():
    """Without noise the estimate is healthy, and the last pass was about just that; with
    noise it is where passes end, one about what the one before has said."""
    import mjdiag
    machine = mjdiag.Machine(str(MJCF / "voice_coil"))
    current = 0.2 * wave(5000, 5000)
    push = mjdiag.Record({"i": current}, {"i": "A"}, 1 / 5000)
    source = "`Machine.diagnose(record, linear=True)`"
    rows = []

    def diagnosed(noise):
        record = machine.simulate(seed=3, replay=push, noise=noise)
        said = machine.diagnose(record, linear=True).to_dict()["faults"]
        return record["x"], {key: [fault[key] for fault in said]
                             for key in ("deviation", "sd", "alarm")}

    reading, said = diagnosed(0.0)
    for what, key, of in (("standard deviations", "sd", spreads),
                          ("sizes that are seen", "alarm", seen_sizes)):
        exact = of(twin_sums(reading, current)[1])
        rows.append(Row(PART, f"twin of the voice coil: {what}", f"{source}: `{key}`",
                        "own sums over blocks, in long double", said[key], exact,
                        condition_of(lambda shake, of=of: of(
                            twin_sums(reading, current, shake=shake)[1]), exact), SHAKEN))
    reading, said = diagnosed(1.0)
    theta = (0, 0, 0)
    for _ in range(2):
        theta, H = twin_sums(reading, current, theta)
    scale = spreads(H)
    rows.append(Row(PART, "twin of the voice coil: estimates, in their standard deviations",
                    f"{source}: `deviation`", "Gauss and Newton, in long double",
                    said["deviation"], deviations(theta), condition_of(
                        lambda shake: deviations(twin_sums(
                            reading, current, theta, shake)[0]), deviations(theta), scale),
                    SHAKEN, scale=scale))
    return rows


ROWS = [from_residuals, bound, twin]
