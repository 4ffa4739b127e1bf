"""Rounds through the benchmarks: all once, all a second time, and so on."""

import json
import re
import subprocess
import sys
import time

from . import ratios


class Failed(SystemExit):
    def __init__(self, what):
        super().__init__(f"bench: {what}")


class Case:
    """A case of a program that is made with Google Benchmark."""

    def __init__(self, build, program, case):
        self.program, self.case = build / "bench" / program, case
        self.title = case

    def counters(self):
        # Names end with what they were run with, as /iterations:5.
        done = subprocess.run(
            [str(self.program), f"--benchmark_filter=^{re.escape(self.case)}(/|$)",
             "--benchmark_format=json"], capture_output=True, text=True)
        if done.returncode != 0:
            raise Failed(f"{self.case} ended with status {done.returncode}\n{done.stderr}")
        try:
            cases = json.loads(done.stdout)["benchmarks"]
        except (ValueError, KeyError) as error:
            raise Failed(f"{self.case} does not exist") from error
        if len(cases) != 1 or cases[0].get("error_occurred"):
            raise Failed(f"{self.case}: {[case.get('error_message') for case in cases]}")
        return cases[0]


class BesidePython:
    """Measured in this process."""

    def __init__(self, held, method):
        self.held, self.method = held, method
        self.title = method

    def counters(self):
        return {self.method: getattr(self.held(), self.method)()}


def cases_of(build, wanted):
    """What is to be run, and the ratios that each gives: [(case, {name: counter})]."""
    made = []

    def held():
        if not made:
            from .beside_python import BesidePython as Measured
            made.append(Measured(build))
        return made[0]

    cases = {}
    for name in wanted:
        source = ratios.named(name).source
        if source[0] == "beside_python":
            case, counter = BesidePython(held, source[1]), source[1]
        else:
            case, counter = Case(build, source[0], source[1]), source[2]
        cases.setdefault(source[:2], (case, {}))[1][name] = counter
    return list(cases.values())


def measure(build, wanted, count):
    """Name -> a value of every round."""
    cases = cases_of(build, wanted)
    values = {name: [] for name in wanted}
    began = time.monotonic()
    for number in range(count):
        for case, names in cases:
            print(f"round {number + 1} of {count}, {time.monotonic() - began:4.0f} s: "
                  f"{case.title}", file=sys.stderr, flush=True)
            counters = case.counters()
            for name, counter in names.items():
                values[name].append(float(counters[counter]))
    return values
