"""Simulated runs beside integrations of our own in long double or more."""

import fractions
import pathlib
import tempfile

import numpy as np
import scipy.signal

from .common import (LONG, MJCF, SHAKEN, Row, ask, condition_of, mpf, read_csv, setup_of,
                     still)

PART = "Runs"
PENDULUM = """<mujoco model="double_pendulum">
  <option timestep="0.00025" integrator="Euler" gravity="0 0 -9.81"/>
  <worldbody>
    <body name="upper">
      <joint name="shoulder" type="hinge" axis="0 1 0" damping="0.05"/>
      <inertial pos="0 0 -0.2" mass="1.3" diaginertia="0.02 0.02 0.003"/>
      <body name="lower" pos="0 0 -0.4">
        <joint name="elbow" type="hinge" axis="0 1 0" damping="0.02"/>
        <inertial pos="0 0 -0.15" mass="0.7" diaginertia="0.008 0.008 0.001"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="shoulder_motor" joint="shoulder"/>
    <motor name="elbow_motor" joint="elbow"/>
  </actuator>
  <sensor>
    <jointpos name="shoulder_angle" joint="shoulder"/>
    <jointpos name="elbow_angle" joint="elbow"/>
  </sensor>
</mujoco>
"""
PENDULUM_SETUP = """schema = "mjdiag.setup/1"
name = "double pendulum"
plant = "plant.xml"
[rates]
control = 1000.0
substeps = 4
[sensors.a]
element = "shoulder_angle"
unit = "rad"
[sensors.b]
element = "elbow_angle"
unit = "rad"
[actuators.s]
element = "shoulder_motor"
unit = "N m"
[actuators.e]
element = "elbow_motor"
unit = "N m"
"""


def long_array(A):
    return np.asarray(A, dtype=LONG)


class Compensator:
    """A feedback in direct form: past errors and outputs as they are."""

    def __init__(self, axis):
        self.b = long_array(axis["feedback"]["numerator"])
        self.a = long_array(axis["feedback"]["denominator"])
        self.b = np.concatenate([np.zeros(len(self.a) - len(self.b), LONG), self.b])
        self.errors = np.zeros(len(self.b), LONG)
        self.outputs = np.zeros(len(self.a) - 1, LONG)

    def step(self, error):
        self.errors = np.concatenate([[error], self.errors[:-1]])
        output = (self.b @ self.errors - self.a[1:] @ self.outputs) / self.a[0]
        self.outputs = np.concatenate([[output], self.outputs[:-1]])
        return output


def closed_loop(system, setup, record, shake=still):
    """Readings and commands of the loop of docs/theory.md, Control, in ticks."""
    A, B, C = (shake(long_array(M)) for M in (system.A, system.B, system.C))
    axes = setup["axes"]
    feedback = {name: Compensator(axis) for name, axis in axes.items()}
    x = np.zeros(A.shape[0], LONG)
    readings, commands = [], []
    for k in range(len(record["time"])):
        y = C @ x
        u = []
        for i, (name, axis) in enumerate(axes.items()):
            def reference(kind, name=name, k=k):
                return LONG(record[name + "_ref" + kind][k])
            forward = axis["feedforward"]
            current = LONG(forward["snap"]) * reference("_snap") \
                + LONG(forward["acceleration"]) * reference("_acceleration") \
                + LONG(forward["velocity"]) * reference("_velocity") \
                + feedback[name].step(shake(np.atleast_1d(reference("") - y[i]))[0])
            u.append(LONG(axis["drive_gain"]) * current)
        u = shake(np.array(u))
        x = shake(A @ x + B @ u)
        readings.append(y)
        commands.append(u)
    return np.array(readings), np.array(commands)


def linear_runs():
    import mjdiag
    setup = setup_of("ab383")
    system = mjdiag.Machine(str(MJCF / "ab383")).linearize().state_space()
    with tempfile.TemporaryDirectory() as folder:
        ask("simulate", "--setup", MJCF / "ab383", "--linear", "--noise", 0,
            "--trajectory", "xyz", "--duration", 0.1, "--out", folder)
        record = read_csv(pathlib.Path(folder) / "record.csv")
    source = "`simulate --linear --noise 0 --trajectory xyz`"
    y = np.column_stack([record[name] for name in setup["sensors"]])
    u = np.column_stack([record[name] for name in setup["actuators"]])
    exact = closed_loop(system, setup, record)
    largest = [np.broadcast_to(np.abs(part).max(axis=0), part.shape) for part in exact]
    rows = [Row(PART, "linear plant in closed loop: readings and commands", source,
                "own loop in long double, on the printed map of a tick", [y, u],
                list(exact), condition_of(
                    lambda shake: list(closed_loop(system, setup, record, shake)),
                    list(exact), largest), SHAKEN, scale=largest)]
    _, answer, _ = scipy.signal.dlsim(
        (system.A, system.B, system.C, system.D, system.dt), u)

    def open_loop(shake=still):
        A, B, C = (shake(long_array(M)) for M in (system.A, system.B, system.C))
        x, out = np.zeros(A.shape[0], LONG), []
        for row in u:
            out.append(C @ x)
            x = shake(A @ x + B @ long_array(row))
        return np.array(out)

    exact = open_loop()
    rows.append(Row(PART, "linear plant under the recorded commands", source,
                    "scipy.signal.dlsim, and the same in long double", [y, y],
                    [answer, exact], condition_of(open_loop, exact, largest[0]), SHAKEN,
                    scale=[largest[0], largest[0]]))
    rows.append(setpoints(record))
    return rows


def integrated(snap, number, shake=still):
    """Position, velocity and acceleration of a snap that is held over ticks of 1/8000 s;
    shaken where it changes, for a phase is a polynomial of its own."""
    tick, state, out, before = number(1) / 8000, [number(0)] * 4, [], 0.0
    for held in snap:
        if shake is not still and held != before:
            state = list(shake(np.array(state)))
        before = held
        out.append(state[:3])
        p, v, a, j = state
        s = number(float(held))
        state = [p + tick * (v + tick / 2 * (a + tick / 3 * (j + tick / 4 * s))),
                 v + tick * (a + tick / 2 * (j + tick / 3 * s)),
                 a + tick * (j + tick / 2 * s), j + tick * s]
    return out


def setpoints(record):
    """References are piecewise polynomials: their snap, integrated four times as
    fractions, is the position."""
    ours, theirs, scale, condition = [], [], [], 0.0
    for axis in "xyz":
        snap = record[f"{axis}_ref_snap"]
        whole = [[mpf(x.numerator) / x.denominator for x in row]
                 for row in integrated(snap, fractions.Fraction)]
        largest = [max(abs(row[i]) for row in whole) for i in range(3)]
        ours.append([[record[f"{axis}_ref{kind}"][k]
                      for kind in ("", "_velocity", "_acceleration")]
                     for k in range(len(snap))])
        theirs.append(whole)
        scale.append([largest] * len(snap))
        condition = max(condition, condition_of(
            lambda shake: integrated(snap, LONG, shake), whole, scale[-1]))
    return Row(PART, "references: position, velocity, acceleration",
               "`simulate`: `_ref`, `_ref_velocity`, `_ref_acceleration`",
               "the recorded snap, integrated as fractions", ours, theirs, condition,
               SHAKEN, scale=scale)


def wave(samples, rate):
    t = np.arange(samples) / rate
    return np.sin(2 * np.pi * 3.1 * t) + 0.7 * np.sin(2 * np.pi * 11.3 * t + 0.4)


def voice_coil():
    """One spring and one damper: m v' = c i - d v - k q, implicit in the damper."""
    import mjdiag
    current = 0.2 * wave(2500, 5000)
    machine = mjdiag.Machine(str(MJCF / "voice_coil"))
    run = machine.simulate(noise=0.0, replay=mjdiag.Record(
        {"i": current}, {"i": "A"}, 1 / 5000))

    def stage(shake=still):
        m, d, k, c = shake(np.array([LONG("0.12"), 4, 900, 12]))
        h = LONG("0.0001")
        x, out = np.zeros(2, LONG), []
        for i in current:
            out.append(x[0])
            for _ in range(2):
                v = x[1] + h / (m + h * d) * (c * LONG(i) - d * x[1] - k * x[0])
                x = shake(np.array([x[0] + h * v, v]))
        return np.array(out)

    exact = stage()
    scale = np.abs(exact).max()
    return [Row(PART, "voice coil, MuJoCo's Euler steps", "`Machine.simulate(noise=0)`",
                "own steps in long double", run["x"], exact,
                condition_of(stage, exact, scale), SHAKEN, scale=scale)]


def pendulum_steps(torque, shake=still):
    """Lagrange's equations of a double pendulum, angles relative, in MuJoCo's steps."""
    m1, c1, i1, l1, m2, c2, i2, d1, d2, g = shake(np.array([LONG(x) for x in (
        "1.3", "0.2", "0.02", "0.4", "0.7", "0.15", "0.008", "0.05", "0.02", "9.81")]))
    h = LONG("0.00025")
    q, v, out = np.zeros(2, LONG), np.zeros(2, LONG), []
    for tau in torque:
        out.append(q)
        for _ in range(4):
            a, b = q
            c, s = np.cos(b), np.sin(b)
            far = m2 * l1 * c2
            m22 = i2 + m2 * c2 * c2
            m12 = m22 + far * c
            m11 = i1 + m1 * c1 * c1 + m2 * l1 * l1 + m22 + 2 * far * c
            lower = m2 * c2 * g * np.sin(a + b)
            f1 = tau[0] - d1 * v[0] + far * s * v[1] * (2 * v[0] + v[1]) \
                - (m1 * c1 + m2 * l1) * g * np.sin(a) - lower
            f2 = tau[1] - d2 * v[1] - far * s * v[0] * v[0] - lower
            m11, m22 = m11 + h * d1, m22 + h * d2
            det = m11 * m22 - m12 * m12
            v = v + h * np.array([m22 * f1 - m12 * f2, m11 * f2 - m12 * f1]) / det
            v = shake(v)
            q = shake(q + h * v)
    return np.array(out)


def pendulum():
    import mjdiag
    samples = 600
    torque = np.column_stack([3.0 * wave(samples, 1000), -0.8 * wave(samples, 1000)])
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, "plant.xml").write_text(PENDULUM, encoding="utf-8")
        pathlib.Path(folder, "setup.toml").write_text(PENDULUM_SETUP, encoding="utf-8")
        run = mjdiag.Machine(folder).simulate(noise=0.0, replay=mjdiag.Record(
            {"s": torque[:, 0], "e": torque[:, 1]}, {"s": "N m", "e": "N m"}, 1e-3))
    ours = np.column_stack([run["a"], run["b"]])
    inputs = long_array(torque)
    exact = pendulum_steps(inputs)
    scale = np.broadcast_to(np.abs(exact).max(axis=0), exact.shape)
    return [Row(PART, "double pendulum, MuJoCo's Euler steps",
                "`Machine.simulate(noise=0)`",
                "Lagrange's equations in long double", ours, exact,
                condition_of(lambda shake: pendulum_steps(inputs, shake), exact, scale),
                SHAKEN, scale=scale)]


ROWS = [linear_runs, voice_coil, pendulum]
