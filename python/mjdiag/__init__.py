"""Fault diagnosis and model discovery for machines that move, on MuJoCo.

    bonder = mjdiag.Machine("mjcf/ab383")
    record = bonder.with_faults(zeta_x=1.2).simulate(seed=1)
    bonder.diagnose(record).faults["zeta_x"]

docs/python.md walks through it. All numbers are in SI units.
"""

from collections.abc import Mapping as _Mapping
from typing import NamedTuple as _NamedTuple

from . import _mjdiag, _plots
from ._mjdiag import (
    Cause,
    Comparison,
    Diagnosis,
    Discovery,
    Fault,
    FilterDesign,
    InputError,
    Kind,
    LinearModel,
    Machine,
    Mismatch,
    DisturbanceEstimate,
    Monitor,
    JointMotionDesign,
    MotionDesign,
    NumericalError,
    Parameter,
    Record,
    Study,
    StudyResult,
    TolerantRun,
    __version__,
)


class StateSpace(_NamedTuple):
    """x[k+1] = A x + B u, y = C x + D u, a step every dt [s]; dt None: x' = A x + B u.

    A (n, n), B (n, m), C (p, n), D (p, m), as scipy.signal takes them.
    """

    A: object
    B: object
    C: object
    D: object
    dt: object


class Mode(_NamedTuple):
    """A damped mode: frequency [Hz], damping_ratio, and shape (joints,), largest entry 1."""

    frequency: float
    damping_ratio: float
    shape: object


class ModelParameter(_NamedTuple):
    """A number of the plant as records have it: factor times what the model says.

    ci95: interval (low, high) of factor; is_off: whether it is another than the model's.
    """

    factor: float
    ci95: tuple
    is_off: bool


class CalibratedNumber(_NamedTuple):
    """factor times what the plant says; sd, prior_sd: of its logarithm, now and before.

    prior_sd is None of a calibration that was read beside its setup.
    """

    factor: float
    sd: float
    prior_sd: float


class Calibration(_NamedTuple):
    """What healthy runs said of a machine.

    numbers: name -> CalibratedNumber. sensor_noise: sd of a reading of every sensor.
    force_noise: bandwidth with which the twin is pulled along [Hz]; 0: the model lacks
    nothing. misfits: of every record, 1 where the model explains it. doubts: numbers far
    from what was known of them, as on a machine that was not healthy. A calibration that
    was read beside its setup has neither misfits nor doubts.
    """

    numbers: dict
    sensor_noise: object
    force_noise: float
    misfits: list
    doubts: list


class Tone(_NamedTuple):
    """amplitude sin(2 pi frequency t + phase) on an axis.

    frequency [Hz], amplitude [m or rad, as the axis has it], phase [rad].
    """

    axis: str
    frequency: float
    amplitude: float
    phase: float


class Correction(_NamedTuple):
    """What was done about a fault while the machine ran.

    action: "drive gain of x", "feedforward", "tones cancelled"; value: of the fault that is
    acted on at the end; since, until: when [s], until None where it is acting still.
    """

    action: str
    value: float
    since: float
    acting: bool
    until: object


class LoopGain(_NamedTuple):
    """gain of the loop of an axis; least and most: between which it is known to be stable."""

    gain: float
    least: float
    most: float


_Mapping.register(Record)
Record.plot = _plots.plot_record
Diagnosis.plot = _plots.plot_diagnosis

__all__ = [
    "CalibratedNumber",
    "Calibration",
    "Cause",
    "Comparison",
    "Correction",
    "Diagnosis",
    "Discovery",
    "Fault",
    "FilterDesign",
    "InputError",
    "Kind",
    "LinearModel",
    "LoopGain",
    "Machine",
    "Mismatch",
    "DisturbanceEstimate",
    "Mode",
    "Monitor",
    "JointMotionDesign",
    "MotionDesign",
    "NumericalError",
    "Parameter",
    "ModelParameter",
    "Record",
    "StateSpace",
    "Study",
    "StudyResult",
    "TolerantRun",
    "Tone",
]

for _name in __all__:
    if hasattr(_mjdiag, _name):
        getattr(_mjdiag, _name).__module__ = "mjdiag"
