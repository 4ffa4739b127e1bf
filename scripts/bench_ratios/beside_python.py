"""SciPy beside mjdiag, and mjdiag in Python beside the same in C++, slice by slice. What is
timed is processor time of the process, so that a busy computer counts for nothing."""

import itertools
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
import scipy.signal

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BONDER = ROOT / "mjcf" / "ab383"
# Its channels without its controllers, so that inputs drive it, as they drive dlsim.
SETUP = """schema = "mjdiag.setup/1"
name = "bonder without controllers"
plant = "{plant}"
[rates]
control = 8000.0
substeps = 4
[sensors.x]
element = "x_encoder"
component = 0
unit = "m"
[sensors.y]
element = "y_encoder"
component = 1
unit = "m"
[sensors.z]
element = "z_encoder"
unit = "rad"
[actuators.u_x]
element = "x_motor"
unit = "N"
[actuators.u_y]
element = "y_motor"
unit = "N"
[actuators.u_z]
element = "z_motor"
unit = "N m"
"""
OUTPUTS, INPUTS = ("x", "y", "z"), ("u_x", "u_y", "u_z")
SLICES = 31
SLICES_BESIDE_DLSIM = 5  # which takes long
MONITOR_TICKS = 2000


def seconds(action):
    start = time.process_time()
    action()
    return time.process_time() - start


def in_turn(above, below, slices):
    """Median of above's seconds over below's, each a callable that gives its seconds; the
    one that goes first changes."""
    above(), below()  # what is allocated once is not counted
    found = []
    for number in range(slices):
        if number % 2:
            first = above()
            found.append(first / below())
        else:
            first = below()
            found.append(above() / first)
    return statistics.median(found)


def require_equal(what, ours, theirs, within):
    """What does not give the same is not compared."""
    ours, theirs = np.asarray(ours), np.asarray(theirs)
    off = np.abs(ours - theirs).max() / np.abs(theirs).max()
    if not off < within:
        raise SystemExit(f"bench: {what}: results differ by {off:.1e}")


class Peer:
    """tests/bench/python_peer.cc, asked for a slice at a time."""

    def __init__(self, build):
        self.process = subprocess.Popen([str(build / "bench" / "python_peer")], text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def ask(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline()
        if not answer:
            raise SystemExit(f"bench: python_peer ended at '{line}'")
        return json.loads(answer)


class BesidePython:
    def __init__(self, build):
        sys.path.insert(0, str(build / "python"))
        import mjdiag
        self.mjdiag = mjdiag
        self.peer = Peer(build)
        self.bonder = mjdiag.Machine(str(BONDER))
        self.record = self.bonder.simulate(linear=True)
        self.made = {}

    def once(self, make):
        """What make gives, made at the first call."""
        if make.__name__ not in self.made:
            self.made[make.__name__] = make()
        return self.made[make.__name__]

    def linear_run(self):
        dlsim, ours = self.once(self.linear_runs)
        return in_turn(dlsim, ours, SLICES_BESIDE_DLSIM)

    def linear_runs(self):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "setup.toml").write_text(
                SETUP.format(plant=BONDER / "plant.xml"), encoding="utf-8")
            machine = self.mjdiag.Machine(folder)
        u = np.column_stack([self.record[name] for name in INPUTS])
        drive = self.mjdiag.Record({name: self.record[name] for name in INPUTS},
                                   {name: self.record.units[name] for name in INPUTS},
                                   self.record.sample_time)
        system = machine.linearize().state_space()
        run = machine.simulate(linear=True, replay=drive)
        y = np.column_stack([run[name] for name in OUTPUTS])
        _, answer, _ = scipy.signal.dlsim(system, u)
        require_equal("linear run", y - y[0], answer, 1e-9)  # the readings at rest
        return (lambda: seconds(lambda: scipy.signal.dlsim(system, u)),
                lambda: seconds(lambda: machine.simulate(linear=True, replay=drive)))

    def filter_bank(self):
        lfilter = self.once(self.scipy_filters)
        return in_turn(lfilter, lambda: self.peer.ask("filter"), SLICES)

    def scipy_filters(self):
        said = self.peer.ask("bank")
        gain, feedback = said["gain"], said["feedback"]
        signals = np.array(said["signals"])
        order = len(feedback)
        outputs = len(said["D"])
        # With q = (z - 1) / gain: q^n + sum a_k q^k, and stage k adds B_k / gain q^k.
        q = np.poly1d([1.0 / gain, -1.0 / gain])
        powers = [q ** k for k in range(order + 1)]
        a = sum((f * p for f, p in zip(feedback, powers)), powers[order]) * gain ** order
        b = np.zeros((outputs, len(signals), order + 1))
        for j, i in itertools.product(range(outputs), range(len(signals))):
            part = said["D"][j][i] * a + gain ** (order - 1) * sum(
                (said["B"][k * outputs + j][i] * powers[k] for k in range(order)),
                np.poly1d([0.0]))
            b[j, i, order + 1 - len(part.c):] = part.c
        a = a.c

        def run():
            # The denominator is common, so it is used once an output: six times as fast
            # as a filter for every signal.
            return scipy.signal.lfilter([1.0], a, np.array([
                sum(scipy.signal.lfilter(b[j, i], [1.0], signals[i])
                    for i in range(len(signals))) for j in range(outputs)]))

        require_equal("filter bank", np.ravel(said["outputs"]), run()[:, -1], 1e-6)
        return lambda: seconds(run)

    def python_run(self):
        return in_turn(lambda: seconds(lambda: self.bonder.simulate(duration=0.125)),
                       lambda: self.peer.ask("simulate"), SLICES)

    def python_tick(self):
        step = self.once(self.monitor_slices)
        return in_turn(step, lambda: self.peer.ask(f"monitor {MONITOR_TICKS}"), SLICES)

    def monitor_slices(self):
        monitor = self.mjdiag.Monitor(self.bonder, linear=True, capacity=len(self.record["x"]))
        y = np.column_stack([self.record[name] for name in monitor.outputs])
        u = np.column_stack([self.record[name] for name in monitor.inputs])
        begin = itertools.cycle(range(0, len(y), MONITOR_TICKS))

        def loop(outputs, inputs):
            for reading, command in zip(outputs, inputs):
                monitor.step(reading, command)

        def step():
            ticks = slice(first := next(begin), first + MONITOR_TICKS)
            return seconds(lambda: loop(y[ticks], u[ticks]))

        return step
