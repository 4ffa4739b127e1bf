"""Which ratios there are, and where each comes from."""

import dataclasses
from typing import Optional


@dataclasses.dataclass(frozen=True)
class Ratio:
    name: str
    what: str
    over: str
    source: tuple  # ("program", case, counter), or ("beside_python", method)
    less_is_better: bool = True
    target: Optional[float] = None
    digits: int = 3
    takes_long: bool = False
    # Whether it says something of the sources, not of the computer.
    judged: bool = True


def closed_loop(case):
    return ("closed_loop_bench", f"ClosedLoopOverBareSteps/{case}", "closed_over_bare")


def diagnosis(case):
    return ("diagnosis_bench", f"MonitoredOverPlainLoop/{case}", "monitored_over_plain")


def twin(case, counter):
    return ("diagnosis_bench", f"TwinOverTick/{case}", counter)


def clip(case, counter):
    return ("render_bench", f"ClipOverBareFrames/{case}", counter)


def discovery(case):
    return ("discovery_bench", f"DiscoverIn/{case}", "work")


RATIOS = (
    Ratio("closed_loop", "a tick in closed loop, the bonder with dry friction",
          "its bare `mj_step`s", closed_loop("with_friction"), target=1.05),
    Ratio("closed_loop_frictionless", "the same without dry friction",
          "its bare `mj_step`s", closed_loop("without_friction"), target=1.05),
    Ratio("diagnosis", "closed loop with residuals and their estimates",
          "closed loop, with dry friction", diagnosis("with_friction")),
    Ratio("diagnosis_frictionless", "the same without dry friction",
          "closed loop, without dry friction", diagnosis("without_friction")),
    Ratio("linear_twin", "diagnosis with a linear twin that follows", "a tick in closed loop",
          twin("linear", "follows_over_loop"), target=0.05),
    Ratio("linear_twin_learning", "the same while it goes back to learn",
          "a tick in closed loop", twin("linear", "learns_over_loop")),
    Ratio("nonlinear_twin", "diagnosis with a nonlinear twin that follows",
          "the bare steps of a tick", twin("nonlinear", "follows_over_bare"), target=1.5),
    Ratio("nonlinear_twin_learning", "the same while it goes back to learn",
          "the bare steps of a tick", twin("nonlinear", "learns_over_bare"), target=1.5),
    Ratio("linear_run", "`scipy.signal.dlsim`", "`Machine.simulate(linear=True)`: the bonder "
          "without its controllers, 20 states, 3 inputs, 3 outputs, 20,000 samples",
          ("beside_python", "linear_run"), less_is_better=False, target=25.0),
    Ratio("filter_bank", "`scipy.signal.lfilter`", "the filter bank: 12 filters of order 7 "
          "over 6 signals, 20,000 samples", ("beside_python", "filter_bank"),
          less_is_better=False),
    Ratio("study", "runs a second of a study, its data set and all",
          "the bare runs on as many cores", ("study_bench", "StudyOverBareLoop",
                                             "runs/s over bare"), less_is_better=False),
    Ratio("clip", "frames a second of a clip: two amplified views, with names",
          "one view, bare render plus encode, one frame after the other",
          clip("side_by_side", "over_bare"), less_is_better=False, target=1.3,
          takes_long=True),
    Ratio("clip_with_diagnosis", "the same with the diagnosis painted in", "the same",
          clip("with_diagnosis", "over_bare"), less_is_better=False, target=1.3,
          takes_long=True),
    Ratio("clip_rate", "frames of 1280x720 of a clip with its diagnosis", "a second",
          clip("with_diagnosis", "clip_frames_per_s"), less_is_better=False, target=60.0,
          takes_long=True, judged=False),
    Ratio("discovery_bonder", "work of discovering an asymmetric damper in the bonder, 0.5 s",
          "one replay of the record", discovery("ab383_half_second"), takes_long=True),
    Ratio("discovery_emps", "work of discovering dry friction and an offset in EMPS, 24.8 s",
          "one replay of the record", discovery("emps"), takes_long=True),
    Ratio("python_run", "`Machine.simulate`, 0.125 s of the bonder", "the same in C++",
          ("beside_python", "python_run")),
    Ratio("python_tick", "`Monitor.step`, the bonder taken as linear, a loop in Python",
          "the same in C++", ("beside_python", "python_tick")),
)


def named(name):
    return next(ratio for ratio in RATIOS if ratio.name == name)
