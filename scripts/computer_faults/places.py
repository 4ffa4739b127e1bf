"""Places that cannot be written to, or that somebody else writes to as well."""

import contextlib
import os
import resource
import shutil
import subprocess
import threading
import time

from computer_faults.bench import Skipped, complaint, files_of, halves, leftovers

WRITERS = ["simulate", "simulate to MAT 7.3", "linearize", "design", "diagnose",
           "calibrate", "compare", "discover", "render", "study --preset", "study --plan",
           "excite"]
ROOMS = (0, 8, 40)  # kB
NOBODY = 65534


def unchanged(out, before, grows=()):
    """What a command that failed has done to a folder all the same. @param grows  files
    that are written bit by bit, and may have grown"""
    wrong = halves(out)
    now = files_of(out)
    changed = sorted(name for name in {**before, **now}
                     if before.get(name) != now.get(name) and name not in grows)
    if changed:
        wrong.append("changed " + ", ".join(changed[:4]))
    if leftovers(out):
        wrong.append("left " + ", ".join(leftovers(out)[:2]))
    return wrong


GROWING = ("runs.journal", "study.log", "plan.toml", "dataset.h5", "study.json")


def refused(bench, name, out, **options):
    """A command that has no place to write to: what is wrong with its end."""
    before = files_of(out)
    status, _, err = bench.run(bench.command(name, "new", out), **options)
    if status in (0, 1):
        return [], 0  # it had room enough
    what = complaint(status, err)
    wrong = [what] if what else []
    wrong += unchanged(out, before, GROWING if name.startswith("study") else ())
    return [f"{name}: {one}" for one in wrong], 1


@contextlib.contextmanager
def small_disk(bench):
    place = bench.fresh("disk")
    os.mkdir(place)
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16m", "mjdiag", place],
                             stderr=subprocess.PIPE, check=False)
    if mounted.returncode != 0:
        raise Skipped("no disk can be mounted: " + mounted.stderr.decode().strip())
    try:
        yield place
    finally:
        subprocess.run(["umount", place], check=True)


def fill(place, room):
    """Leaves so many bytes."""
    filler = os.path.join(place, "filler")
    with contextlib.suppress(OSError), open(filler, "wb", buffering=0) as stream:
        while stream.write(b"\0" * 4096):
            pass
    with contextlib.suppress(OSError):
        os.truncate(filler, os.path.getsize(filler) - room)


def full_disk(bench):
    if os.geteuid() != 0:
        raise Skipped("only root can mount a small disk")
    wrong, ends = [], 0
    with small_disk(bench) as place:
        for name in WRITERS:
            for room in ROOMS:
                for file in os.listdir(place):
                    path = os.path.join(place, file)
                    shutil.rmtree(path) if os.path.isdir(path) else os.remove(path)
                out = os.path.join(place, "out")
                if name == "study --plan":
                    os.mkdir(out)
                else:
                    bench.done(bench.command(name, "old", out))
                fill(place, 1024 * room)
                what, ended = refused(bench, name, out)
                wrong += [f"{room} kB: {one}" for one in what]
                ends += ended
    return f"{len(WRITERS) * len(ROOMS)} commands, {ends} had too little room", wrong


def file_limit(bench):
    wrong, ends = [], 0
    for name in WRITERS:
        out = bench.fresh("limited")
        if name == "study --plan":
            os.mkdir(out)
        else:
            bench.done(bench.command(name, "old", out))
        for room in ROOMS:
            bytes_ = 1024 * room
            # Python ignores SIGXFSZ, and so does what it starts without restoring it.
            what, ended = refused(
                bench, name, out, restore_signals=False, preexec_fn=lambda b=bytes_:
                resource.setrlimit(resource.RLIMIT_FSIZE, (b, b)))
            wrong += [f"{room} kB: {one}" for one in what]
            ends += ended
    return f"{len(WRITERS) * len(ROOMS)} commands, {ends} ended by it", wrong


def read_only(bench):
    options = {"user": NOBODY, "group": NOBODY} if os.geteuid() == 0 else {}
    os.chmod(bench.folder, 0o755)
    wrong = []
    for name in WRITERS:
        out = bench.fresh("read only")
        if name == "study --plan":
            os.mkdir(out)
        else:
            bench.done(bench.command(name, "old", out))
        os.chmod(out, 0o555)
        what, ended = refused(bench, name, out, **options)
        os.chmod(out, 0o755)
        wrong += what
        if not ended:
            wrong.append(f"{name}: has written all the same")
    return f"{len(WRITERS)} commands", wrong


def changing_file(bench):
    """The record is written anew, cut off and written on, again and again."""
    record = bench.path("changing.csv")
    with open(bench.record("old"), "rb") as old, open(bench.record("new"), "rb") as new:
        texts = (old.read(), new.read())
    ends = threading.Event()
    shutil.copy(bench.record("old"), record)

    def write():
        turn = 0
        while not ends.is_set():
            with open(record, "wb") as stream:
                for begin in range(0, len(texts[turn]), 7001):
                    stream.write(texts[turn][begin:begin + 7001])
                    stream.flush()
                    time.sleep(0.0005)
            turn = 1 - turn

    writer = threading.Thread(target=write)
    writer.start()
    wrong, seen = [], {}
    try:
        for number in range(12):
            command = (["diagnose"], ["compare"], ["calibrate"])[number % 3]
            out = bench.fresh("of changing")
            status, _, err = bench.run([*command, "--setup", bench.stage, "--record", record,
                                        "--out", out])
            seen[status] = seen.get(status, 0) + 1
            if status not in (0, 1):
                what = complaint(status, err, (2, 3))
                wrong += [what] if what else []
            wrong += halves(out)
    finally:
        ends.set()
        writer.join()
    return "exit statuses " + ", ".join(f"{s}: {n} times" for s, n in sorted(seen.items())), wrong


def two_processes(bench):
    wrong = []
    for name in WRITERS:
        out = bench.fresh("of two")
        both = [bench.start(bench.command(name, variant, out)) for variant in ("old", "new")]
        ends = [(process.communicate(), process.returncode) for process in both]
        for (_, err), status in ends:
            if status not in (0, 1):
                what = complaint(status, err.decode())
                wrong += [f"{name}: {what}"] if what else []
        if all(status not in (0, 1) for _, status in ends):
            wrong.append(f"{name}: both have given up")
        wrong += [f"{name}: {what}" for what in halves(out)]
        wrong += [f"{name}: left {what}" for what in leftovers(out)]
    return f"{len(WRITERS)} pairs", wrong


def odd_paths(bench):
    wrong = []
    for odd in ("two  words", "Gr\u00f6\u00dfe & Ma\u00df", "it's \"quoted\" $HOME;",
                "-dash", "100%s", b"latin-\xe4".decode("utf-8", "surrogateescape")):
        place = bench.fresh(odd)
        os.mkdir(place)
        stage = os.path.join(place, "st\u00e4ge")
        shutil.copytree(bench.stage, stage)
        setup = ["--setup", stage]
        out = os.path.join(place, "out put")
        record = os.path.join(out, "record.csv")
        for command in (["simulate", *setup, "--diagnose", "--out", out],
                        ["design", *setup, "--out", out],
                        ["diagnose", *setup, "--filters", os.path.join(out, "filters.json"),
                         "--record", record, "--out", out],
                        ["compare", *setup, "--record", record, "--out", out],
                        ["calibrate", *setup, "--record", record,
                         "--out", os.path.join(place, "calibr\u00e9")],
                        ["simulate", "--setup", os.path.join(place, "calibr\u00e9"),
                         "--format", "mat73", "--out", out],
                        ["simulate", *setup, "--replay", os.path.join(out, "record.mat")],
                        ["render", *setup, "--duration", "0.1", "--width", "320",
                         "--height", "240", "--out", out],
                        ["report", out]):
            status, _, err = bench.run(command)
            if status not in (0, 1):
                wrong.append(f"{command[0]} in {odd!a}: status {status}: {err.strip()[:200]}")
        wrong += [f"{odd!a}: {what}" for what in halves(out)]
    return "6 folders, 9 commands in each", wrong


FAULTS = [("full disk", full_disk), ("limit on the size of files", file_limit),
          ("folder that is read only", read_only),
          ("record that changes while it is read", changing_file),
          ("two processes with one folder", two_processes),
          ("paths with spaces, umlauts and quotes", odd_paths)]
