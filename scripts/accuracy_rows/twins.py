"""What the twin of a linear machine says about a run that is healthy."""

import pathlib
import tempfile

import mpmath
import numpy as np

from .common import (DRAWS, LONG, MJCF, SHAKEN, Row, Shaker, ask, condition_of, diagnosed,
                     long_of, matrix, mpf, read_csv, spread_of, still)
from .estimation import BONDER, SHORT, faults_of_plant, mp_of, mpf_long
from .linear import model_of
from .mechanics import tick_map
from .runs import wave

PART = "Estimation"


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
    and coil are over what they were: estimate, and information H, of all ticks of whole
    blocks of 8 (docs/theory.md, Estimation by a twin)."""
    tick, sd, block = twin_tick(theta, shake), LONG(5e-8), 8
    x, e, psi = np.zeros(8, LONG), [], []
    for y, i in zip(reading, current):
        e.append(LONG(y) - x[0])
        psi.append(x[2:5])
        x = shake(tick[:, :8] @ x + tick[:, 8] * LONG(i))
    n = len(e) // block * block
    e, psi = shake(np.array(e[:n])), np.array(psi[:n])
    weight, prior = 1 / sd ** 2, LONG(100)  # a standard deviation of 0.1
    theta = np.array([long_of(t) for t in theta])
    H = mp_of(shake(psi.T @ psi * weight + np.eye(3, dtype=LONG) * prior))
    g = mp_of(shake((psi.T @ e * weight - prior * theta)[:, None]))
    return moved(theta, mpmath.lu_solve(H, g)), H


def moved(theta, change):
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


def voice_coil_twin():
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
                        "own sums over ticks, in long double", said[key], exact,
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


def bonder_sums(inputs, source, shake=still):
    """Information of seven factors and of sines and cosines of three tones about the healthy
    bonder, without noise: S^T S over all ticks of whole blocks of 8, every physics step with
    the sensitivities that docs/theory.md has."""
    said = ask("linearize", "--setup", BONDER)
    M, D, K, Gamma = model_of(said)
    n, step = M.rows, mpf(1) / 32000
    b = long_of(matrix(said["b"]).T)
    A1, B1 = tick_map(M, D, K, Gamma, step, 1)
    A1, B1 = shake(long_of(A1)), shake(long_of(B1))
    push = shake(long_of(step * mpmath.inverse(M + step * D)))  # speed by a force
    push = np.concatenate([LONG(1) / 32000 * push, push])

    def part(of):
        """By the difference of two machines, a thousandth more and less of it."""
        of = long_of(of)
        return (shake(of * LONG("1.001")) - shake(of * LONG("0.999"))) / LONG("0.002")

    dampers, springs, motors = [], [], []
    for i, (kind, d, k, gamma) in enumerate(faults_of_plant(D, Gamma)):
        {"damping": dampers, "stiffness": springs, "gear": motors}[kind].append(
            (i, part({"damping": d, "stiffness": k, "gear": gamma}[kind])))
    faults = len(dampers) + len(springs) + len(motors)
    amplitude = long_of(Gamma) @ np.array(source["amplitude"], LONG)
    x, S = np.zeros(2 * n, LONG), np.zeros((2 * n, faults + 6), LONG)
    two_pi, psi = long_of(2 * mpmath.pi), []
    for k, u in enumerate(inputs.T.astype(LONG)):
        psi.append(b @ S[:n])
        force = np.zeros((n, faults + 6), LONG)
        for i, gamma in motors:
            force[:, i] = gamma @ u
        for j, f in enumerate(source["frequencies"]):
            angle = two_pi * LONG(f) * k / 8000
            force[:, faults + 2 * j] = amplitude * np.sin(angle)
            force[:, faults + 2 * j + 1] = amplitude * np.cos(angle)
        for _ in range(4):
            after = A1 @ x + B1 @ u
            for i, d in dampers:
                force[:, i] = -d @ after[n:]
            for i, spring in springs:
                force[:, i] = -spring @ x[:n]
            S = shake(A1 @ S + push @ force)
            x = shake(after)
    psi = np.array(psi[:len(psi) // 8 * 8]).reshape(-1, faults + 6) / LONG(2e-8)
    # What is known beforehand: 0.1 of a logarithm, and of a magnitude.
    return mp_of(shake(psi.T @ psi + 100 * np.eye(faults + 6, dtype=LONG))), faults


def bonder_answers(H, faults):
    """Standard deviations, of a disturbance that of what its tones have in common, and
    sizes that are seen beside healthy others."""
    root = [mpmath.sqrt(H[i, i]) for i in range(H.rows)]
    scaled = mpmath.matrix([[H[i, j] / root[i] / root[j] for j in range(H.rows)]
                            for i in range(H.rows)])
    inverse = mpmath.inverse(scaled)
    variance = [inverse[i, i] / H[i, i] for i in range(H.rows)]
    tones = 1 / mpmath.sqrt(sum(2 / (variance[i] + variance[i + 1])
                                for i in range(faults, H.rows, 2)))
    sigmas = mpmath.sqrt(2) * mpmath.erfinv(1 - mpf(1e-4) / (faults + 1))
    return ([mpmath.sqrt(v) for v in variance[:faults]] + [tones],
            [mpmath.expm1(sigmas / root[i]) for i in range(faults)])


def bonder_twin():
    with tempfile.TemporaryDirectory() as folder:
        design = ask("design", "--setup", BONDER, "--linear", "--nominal-runs", 2, *SHORT)
        ask("simulate", "--setup", BONDER, "--linear", "--noise", 0, *SHORT, "--out", folder)
        record = pathlib.Path(folder) / "record.csv"
        said = diagnosed(design, record, *SHORT)["faults"]
        channels = read_csv(record)
    inputs = np.array([channels[name] for name in design["inputs"]])
    source = design["disturbances"][0]
    exact = bonder_answers(*bonder_sums(inputs, source))
    shaken = [bonder_answers(*bonder_sums(inputs, source, Shaker(seed)))
              for seed in range(DRAWS)]
    # Of a factor it is the factor times that of its logarithm, and an estimate without noise
    # is off by what rounding leaves in units of the noise.
    factors = [1 + mpf(fault["deviation"]) for fault in said[:-1]] + [1]
    rows = []
    for i, (what, key, times) in enumerate((
            ("standard deviations", "sd", factors),
            ("sizes that are seen", "alarm", [1] * (len(factors) - 1)))):
        rows.append(Row(PART, f"twin of the linear bonder: {what}", f"`diagnose`: `{key}`",
                        "own sensitivities and sums, in long double",
                        [fault[key] for fault in said[:len(times)]],
                        [x * factor for x, factor in zip(exact[i], times)],
                        spread_of([one[i] for one in shaken], exact[i]), SHAKEN))
    return rows


ROWS = [voice_coil_twin, bonder_twin]
