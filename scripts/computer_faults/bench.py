"""A small machine, every command that writes, quickly, and what is in an output folder."""

import csv
import hashlib
import json
import os
import re
import shutil
import subprocess
import xml.dom.minidom

from malformed_files import PLAN, make_stage, write

PATIENCE = 120.0  # s
UNLIKE = re.compile(rb'"real_time_factor": [^,\n]*|[^ \n]* times real time')
MAT_TEXT = 116  # bytes, in which matio says when it made a file
SMALL = ["--width", "320", "--height", "240"]


class Skipped(Exception):
    """Of a fault that cannot be made on this computer: why."""


class Bench:
    def __init__(self, program, folder):
        self.program = program
        self.folder = folder
        self.stage = make_stage(self.path("stage"))
        self.plan = write(folder, "plan.toml",
                          PLAN.replace("points = 4", "points = 300") + 'scale = "log"\n')
        for name, extra in (("old", ["--seed", "1"]),
                            ("new", ["--seed", "2", "--effect",
                                     "coulomb_friction@load:force=20"])):
            self.done(["simulate", "--setup", self.stage, *extra, "--out", self.path(name)])

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def record(self, variant):
        return self.path(variant, "record.csv")

    def command(self, name, variant, out):
        """Arguments of a command; `old` and `new` give different files."""
        is_new = variant == "new"
        setup = ["--setup", self.stage]
        zeta = ["--fault", "zeta=1.2" if is_new else "zeta=1.1"]
        record = ["--record", self.record(variant)]
        return {
            "simulate": ["simulate", *setup, *zeta, "--diagnose", "--log-joints"],
            "simulate to MAT 7.3": ["simulate", *setup, *zeta, "--format", "mat73"],
            "simulate to MAT 5": ["simulate", *setup, *zeta, "--format", "mat"],
            "linearize": ["linearize", *setup, *zeta],
            "design": ["design", *setup, *zeta],
            "diagnose": ["diagnose", *setup, *record],
            "calibrate": ["calibrate", *setup, *record],
            "compare": ["compare", *setup, *record],
            "discover": ["discover", *setup, *record, "--budget", "0.5", "--causes", "1",
                         "--only", "friction", "--no-doubt"],
            "render": ["render", *setup, *zeta, "--duration", "0.1", *SMALL],
            "study --preset": ["study", *setup, "--preset", "disturbance",
                               "--seed", "2" if is_new else "1"],
            "study --plan": ["study", "--plan", self.plan],
            "excite": ["excite", *setup, "--budget", "0.3",
                       "--limit", "q:velocity=" + ("0.04" if is_new else "0.05")],
            "watch": ["watch", *setup, "--linear", "--source", "stdin", "--listen",
                      "127.0.0.1:0", "--no-picture", "--save-every", "1"],
        }[name] + ["--out", out]

    def start(self, arguments, **options):
        stdin = subprocess.DEVNULL
        if arguments[0] == "watch":
            stdin = open(self.record("old"), "rb")
        return subprocess.Popen([self.program, *arguments], stdin=stdin,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options)

    def run(self, arguments, **options):
        """Status, stdout and stderr of a command."""
        process = self.start(arguments, **options)
        out, err = process.communicate(timeout=PATIENCE)
        return process.returncode, out, err.decode(errors="replace")

    def done(self, arguments, **options):
        status, out, err = self.run(arguments, **options)
        if status not in (0, 1):
            raise AssertionError(f"{' '.join(arguments)}: status {status}: {err}")
        return out

    def fresh(self, name):
        """A path at which nothing is."""
        path = self.path(name)
        shutil.rmtree(path, ignore_errors=True)
        return path


def complaint(status, err, expected=(2,)):
    """What is wrong with the end of a command that could not do its work, or nothing."""
    wrong = []
    if status not in expected:
        wrong.append(f"status {status}")
    lines = [line for line in err.splitlines() if line.startswith("mjdiag: ")]
    if len(lines) != 1:
        wrong.append(f"{len(lines)} lines of complaint")
    words = " ".join(err.split())[:300]
    return ", ".join(wrong) + ": " + words if wrong else ""


def is_temporary(name):
    return any(part.startswith(".") or part.endswith(".part") for part in name.split(os.sep))


def files_of(folder):
    """Names and checksums of all files below a folder, temporary ones left out."""
    found = {}
    for place, _, names in os.walk(folder):
        for name in names:
            file = os.path.join(place, name)
            with open(file, "rb") as stream:
                data = stream.read()
            if name.endswith(".json"):
                data = UNLIKE.sub(b"", data)
            elif name.endswith(".mat"):
                data = data[MAT_TEXT:]
            found[os.path.relpath(file, folder)] = hashlib.sha256(data).hexdigest()
    return {name: sum_ for name, sum_ in found.items() if not is_temporary(name)}


def leftovers(folder):
    """Temporary files and folders that are left in a folder."""
    left = []
    for place, folders, names in os.walk(folder):
        left += [os.path.join(place, name) for name in [*folders, *names]
                 if is_temporary(name)]
    return left


def halves(folder):
    """Files of a folder that are not whole."""
    broken = []
    for name in files_of(folder):
        file = os.path.join(folder, name)
        try:
            check_whole(file)
        except (ValueError, KeyError, IndexError, xml.parsers.expat.ExpatError) as error:
            broken.append(f"{name} is not whole: {error}")
    return broken


def check_whole(file):
    with open(file, "rb") as stream:
        data = stream.read()
    kind = os.path.splitext(file)[1]
    if kind == ".json":
        json.loads(data)
    elif kind == ".csv":
        rows = list(csv.reader(data.decode().splitlines()))
        if not data.endswith(b"\n") or len({len(row) for row in rows}) != 1:
            raise ValueError("ragged or cut")
    elif kind == ".xml":
        xml.dom.minidom.parseString(data)
    elif kind == ".html" and not data.rstrip().endswith(b"</html>"):
        raise ValueError("no </html>")
    elif kind == ".png" and not data.endswith(b"IEND\xaeB`\x82"):
        raise ValueError("no end")
    elif kind == ".jsonl":
        for line in data.splitlines():
            json.loads(line)
    elif kind == ".history":
        total = 0xcbf29ce484222325
        for byte in data[:-8]:
            total = (total ^ byte) * 0x100000001b3 & 0xffffffffffffffff
        if total != int.from_bytes(data[-8:], "little"):
            raise ValueError("wrong checksum")
    elif kind == ".mp4" and b"moov" not in data:
        raise ValueError("no moov")
    elif kind in (".h5", ".mat", ".toml") and not data:
        raise ValueError("empty")
