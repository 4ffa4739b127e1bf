"""Physics of the plant.xml beside this file that MJCF has no attributes for.

mjdiag found it and wrote it into that file as <custom><numeric name="effect.<law>.<site>"/>,
which MuJoCo loads and ignores. This makes forces of it, in MuJoCo's Python package:

    import mujoco
    import effects

    model = mujoco.MjModel.from_xml_path("plant.xml")
    effects.prepare(model)                      # once, before its data are made
    data = mujoco.MjData(model)
    mujoco.set_mjcb_passive(effects.passive)
    while data.time < 1.0:
        data.ctrl[:] = ...                      # before the step, not in mjcb_control
        mujoco.mj_step(model, data)
        readings = effects.distort(model, data) # where encoders err: instead of sensordata

`passive` adds to data.qfrc_passive, and sets the bounds of MuJoCo's own friction
constraints. What changes a command, as a delay does, leaves data.ctrl and
data.actuator_force as they are: what the other command would make of the drive is added to
qfrc_passive. `distort` returns the readings with the errors of the encoders in them. Laws
with a memory begin at rest in every MjData and take one step in a step of the physics,
however often that is evaluated; they begin anew when the time goes back, or with `reset`.
The equations are in docs/effects.md of mjdiag; q is the position from qpos0.
"""

import math
import weakref

import numpy as np

LEAST_BOUND = 1e-12  # [N, N m] MuJoCo makes no friction constraint of a bound of nothing
FRICTION_OF_DOF = 1  # mjCNSTR_FRICTION_DOF
SLIDE_OR_HINGE = (2, 3)  # mjJNT_SLIDE, mjJNT_HINGE
BODY, XBODY, JOINT, GEOM, SITE = 1, 2, 3, 5, 6  # mjOBJ_BODY and so on
AT_JOINT = (0, 1)  # mjTRN_JOINT, mjTRN_JOINTINPARENT
RUNGE_KUTTA = 1  # mjINT_RK4

SITES = {
    "command": "actuator",
    "reading": "sensor",
    "late reading": "sensor",
    "wound reading": "sensor",
    "noise": "sensor",
}  # others: joints

LAWS = {}  # name: (kind, function, number of values)


def _law(kind, given, count=None):
    """Registers a function under its own name; behind `given` arguments come its values."""

    def register(function):
        values = count or function.__code__.co_argcount - given
        LAWS[function.__name__] = (kind, function, values)
        return function

    return register


# Forces on a joint, of its motion and of time. `at` is that joint in this step.


@_law("force", 1)
def quadratic_drag(at, coefficient):
    return -coefficient * at.v * abs(at.v)


@_law("force", 1)
def eddy_current_brake(at, coefficient, velocity):
    ratio = at.v / velocity
    return -coefficient * at.v / (1.0 + ratio * ratio)


@_law("force", 1)
def smooth_coulomb_friction(at, force, velocity):
    return -force * math.tanh(at.v / velocity)


@_law("force", 1)
def force_offset(at, force):
    return force


@_law("force", 1)
def force_ripple(at, amplitude, period, phase):
    return amplitude * math.sin(2.0 * math.pi / period * at.q + phase)


@_law("force", 1)
def force_coupling(at, coefficient):
    model = at.step.model
    others = 0.0
    for motor in range(model.nu):
        if at.step.arm(motor)[at.dof] == 0.0:
            gear = np.reshape(model.actuator_gear, (-1, 6))[motor]
            others += math.sqrt(sum(g * g for g in gear)) * at.step.motor_force(motor)
    return coefficient * others


@_law("force", 1)
def cubic_stiffness(at, coefficient):
    return -coefficient * at.q * at.q * at.q


@_law("force", 1)
def quadratic_stiffness(at, coefficient):
    return -coefficient * at.q * at.q


@_law("force", 1)
def backlash(at, gap):
    strain = at.position - at.step.model.qpos_spring[at.address]
    return at.step.model.jnt_stiffness[at.joint] * min(max(strain, -0.5 * gap), 0.5 * gap)


@_law("force", 1)
def end_stop(at, position, stiffness):
    beyond = at.q - position
    touches = beyond > 0.0 if position >= 0.0 else beyond < 0.0
    return -stiffness * beyond if touches else 0.0


@_law("force", 1)
def floor_vibration(at, amplitude, frequency, phase):
    return amplitude * math.sin(2.0 * math.pi * frequency * at.time + phase)


def _direction(velocity, still):
    return math.tanh(velocity / still) if still > 0.0 else float(np.sign(velocity))


def _piece(x, low, high, periodic, knots):
    """Cubic between knots at equal distances, with the slopes of Catmull and Rom."""
    cells = len(knots) if periodic else len(knots) - 1
    t = (x - low) / (high - low) * cells
    t = t - cells * math.floor(t / cells) if periodic else min(max(t, 0.0), float(cells))
    cell = min(int(t), cells - 1)
    t -= cell
    weight = [
        t * (-0.5 + t * (1.0 - 0.5 * t)),
        1.0 + t * t * (-2.5 + 1.5 * t),
        t * (0.5 + t * (2.0 - 1.5 * t)),
        t * t * (-0.5 + 0.5 * t),
    ]
    # Before its first knot and behind its last the curve goes on as a parabola, of two
    # knots as a line.
    near, after, far = (3.0, -3.0, 1.0) if len(knots) > 2 else (2.0, -1.0, 0.0)
    if not periodic and cell == 0:
        a, b, c, d = weight
        weight = [0.0, b + near * a, c + after * a, d + far * a]
    if not periodic and cell == cells - 1:
        a, b, c, d = weight
        weight = [a + far * d, b + after * d, c + near * d, 0.0]
    return sum(w * knots[(cell - 1 + i) % len(knots)] for i, w in enumerate(weight))


@_law("force", 1, count=25)
def force_curve(at, variable, of, factor, still, low, width, shape, knots, *values):
    variable, of, factor, shape, knots = (
        int(round(choice)) for choice in (variable, of, factor, shape, knots)
    )
    model, data = at.step.model, at.step.data
    if variable == 0:
        address = model.jnt_qposadr[model.dof_jntid[of]]
        x = data.qpos[address] - model.qpos0[address]
    else:
        x = (None, data.qvel, at.step.ctrl)[variable][of] if variable < 3 else at.time
    values = values[:knots]
    if shape == 2:  # split at 0
        half = knots // 2
        above = 0.5 * (1.0 + _direction(x, still))
        force = (1.0 - above) * _piece(x, low, 0.0, False, values[:half])
        force += above * _piece(x, 0.0, low + width, False, values[half : 2 * half])
    else:
        force = _piece(x, low, low + width, shape == 1, values)
    return force * (1.0, _direction(at.v, still), at.v)[factor]


# Forces with a memory z, None at rest: return the force and the memory behind the step,
# over which v is constant.


def _follow(at, z, length):
    end = math.copysign(length, at.v)
    return end + ((z or 0.0) - end) * math.exp(-abs(at.v) * at.h / length)


@_law("memory", 2)
def presliding_hysteresis(at, z, force, stiffness):
    if not force > 0.0:
        return 0.0, z
    z = _follow(at, z, force / stiffness)
    return -stiffness * z, z


@_law("memory", 2)
def hysteretic_stiffness(at, z, stiffness, loss, length):
    z = _follow(at, z, length)
    return -stiffness * (at.q + loss * z), z


@_law("memory", 2)
def bouc_wen(at, z, stiffness, loss, hardening, exponent):
    z = z or 0.0
    slides = loss + hardening
    most = (stiffness / slides) ** (1.0 / exponent) if slides > 0.0 else math.inf
    travel = at.v * at.h

    def slope(z):
        size = min(abs(z), most) ** exponent
        against = math.copysign(size, z) * math.copysign(1.0, travel)
        return stiffness - loss * against - hardening * size

    # Runge-Kutta in parts short enough for the memory.
    reached = min(abs(z) + stiffness * abs(travel), most)
    steep = exponent * reached ** (exponent - 1.0) if exponent > 1.0 else 1.0
    turns = abs(travel) * (loss + abs(hardening)) * max(steep, 1.0)
    parts = int(min(max(np.ceil(4.0 * turns), 1.0), 64.0))
    part = travel / parts
    for _ in range(parts):
        a = slope(z)
        b = slope(z + 0.5 * part * a)
        c = slope(z + 0.5 * part * b)
        d = slope(z + part * c)
        z = min(max(z + part / 6.0 * (a + 2.0 * b + 2.0 * c + d), -most), most)
    return -z, z


@_law("memory", 2)
def lugre_friction(at, z, coulomb, breakaway, velocity, stiffness, damping):
    before = z or 0.0
    stiffness = min(stiffness, at.stiffest())
    damping = min(damping, at.stiffest() * at.h)
    g = coulomb + breakaway * _stribeck(at.v, velocity)
    if not g > 0.0:
        return 0.0, 0.0
    end = math.copysign(g / stiffness, at.v)
    z = end + (before - end) * math.exp(-stiffness * abs(at.v) * at.h / g)
    fading = damping / (1.0 + 0.25 * damping * abs(at.v) / g)
    return -(stiffness * z + fading * (z - before) / at.h), z


@_law("memory", 2)
def presliding_gear_friction(at, z, driving, backdriving, length):
    tau = at.motor()
    length = max(length, max(driving, backdriving) * abs(tau) / at.stiffest())
    end = math.copysign(1.0, at.v)
    z = end + ((z or 0.0) - end) * math.exp(-abs(at.v) * at.h / length)
    average = 0.5 * (driving + backdriving)
    difference = 0.5 * (driving - backdriving)
    return -(average * abs(tau) * z + difference * tau * z * z), z


@_law("memory", 2)
def flexible_mode(at, z, mass, frequency, damping_ratio):
    x, velocity = z or (at.position, at.v)
    omega = 2.0 * math.pi * frequency
    pull = omega * omega * (x - at.position)
    pull += 2.0 * damping_ratio * omega * (velocity - at.v)
    velocity -= at.h * pull
    return mass * pull, (x + at.h * velocity, velocity)


# What is added to the damping of a joint. All laws together take no more off than it has.


@_law("damping", 1)
def asymmetric_viscous_friction(at, positive, negative):
    return positive if at.v > 0.0 else negative


@_law("damping", 1)
def position_dependent_damping(at, slope, curvature):
    return (slope + curvature * at.q) * at.q


# What is added to the bound of dry friction of a joint, when all forces of the step are
# known: motor, of the motors on the joint, and rest, of everything else but that friction.


def _stribeck(v, velocity):
    ratio = v / velocity
    return math.exp(-ratio * ratio)


@_law("bound", 1)
def stribeck_friction(at, coulomb, breakaway, velocity):
    return breakaway * _stribeck(at.v, velocity)  # `prepare` has put coulomb into the model


@_law("bound", 1)
def load_friction(at, coefficient):
    return coefficient * abs(at.motor() - at.rest())


@_law("bound", 1)
def quadratic_load_friction(at, coefficient):
    transmitted = at.motor() - at.rest()
    return coefficient * transmitted * transmitted


@_law("bound", 1)
def directional_load_friction(at, motor_share, load_share):
    return abs(motor_share * at.motor() - load_share * at.rest())


@_law("bound", 1)
def gear_load_friction(at, motor_share, load_share, quadratic):
    return directional_load_friction(at, motor_share, load_share) + quadratic_load_friction(
        at, quadratic
    )


@_law("bound", 1)
def stribeck_load_friction(at, coefficient, breakaway, velocity):
    share = coefficient + breakaway * _stribeck(at.v, velocity)
    return share * abs(at.motor() - at.rest())


@_law("bound", 1)
def position_dependent_friction(at, slope, curvature):
    return (slope + curvature * at.q) * at.q


@_law("bound", 1)
def warming_friction(at, force, time_constant):
    return force * math.exp(-at.time * (1.0 / time_constant))


# Commands of an actuator: return the command that the drive follows and the memory.


@_law("command", 3)
def position_dependent_motor_constant(at, u, z, slope, curvature):
    s = (at.step.data.actuator_length[at.motor] - at.rest) / at.gear
    return u * max(0.0, 1.0 + slope * s + curvature * s * s), z


@_law("command", 3)
def input_delay(at, u, z, delay):
    steps = delay / at.h
    whole = math.floor(steps)
    fraction = steps - whole
    past = (u,) + (z[:-1] if z else (u,) * (whole + 1))  # the newest first
    return (1.0 - fraction) * past[whole] + fraction * past[whole + 1], past


@_law("command", 3)
def amplifier_lag(at, u, z, time_constant):
    force = u if z is None else z
    ratio = at.h / time_constant
    mean = -math.expm1(-ratio) / ratio  # of the force over the step
    return u + (force - u) * mean, u + (force - u) * math.exp(-ratio)


# Readings of an encoder.


@_law("reading", 2)
def encoder_scale(y, time, factor):
    return factor * y


@_law("reading", 2)
def encoder_periodic_error(y, time, amplitude, period, phase):
    return y + amplitude * math.sin(2.0 * math.pi / period * y + phase)


@_law("reading", 2)
def encoder_drift(y, time, rate):
    return y + rate * time


@_law("late reading", 2)
def encoder_delay(y, rate, delay):
    return y - delay * rate


@_law("wound reading", 2)
def transmission_windup(y, force, compliance):
    return y + compliance * force


# What does not act in a step: `prepare` moves zeros of hinges, and noise is that of the
# sensor in setup.toml.


@_law("zero", 0)
def zero_offset(offset):
    return offset


@_law("noise", 0)
def encoder_noise(sd):
    return sd
