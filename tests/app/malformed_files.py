"""Malformed files, each with the command that reads it and what has to be in the line
about it: lists of (name, arguments, words). Lines that begin with "record: " are about
channels that a file does not have, and do not name it."""

import json
import os
import shutil
import struct

EMPS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "mjcf", "emps")

PLAN = """schema = "mjdiag.plan/1"
name = "small"
setup = "stage"
points = 4
method = "sobol"
[keep]
records = ["q"]
[[axis]]
fault = "zeta"
from = 1.1
to = 2.0
"""

LIST = """[[record]]
file = "good/record.csv"
role = "fit"
"""


def read(file):
    with open(file, "rb") as stream:
        return stream.read()


def write(folder, name, content):
    file = os.path.join(folder, name)
    with open(file, "wb") as stream:
        stream.write(content if isinstance(content, bytes) else content.encode())
    return file


def make_stage(folder):
    """The EMPS stage with noise, names of columns as the simulation writes them, and a
    motion of a second: everything works on it, and quickly."""
    shutil.copytree(EMPS, folder)
    file = os.path.join(folder, "setup.toml")
    text = read(file).decode()
    text = text[:text.index("# Variables of DATA_EMPS")] + text[text.index("[compare]"):]
    text = text.replace('unit = "m"\n', 'unit = "m"\nnoise_sd = 1e-6\n', 1)
    motion = text.index("[trajectories.default]")
    text = text[:motion] + """[trajectories.default]
duration = 1.0
period = 1.0
moves = [{ at = 0.1, by = { q = 0.01 } }, { at = 0.5, by = { q = -0.01 } }]
""" + text[text.index("[compare]") - 1:]
    write(folder, "setup.toml", text)
    return folder


def record_cases(folder, stage, good):
    lines = read(good["csv"]).decode().splitlines()
    columns = lines[0].split(",")
    q = next(i for i, name in enumerate(columns) if name.startswith("q ["))

    def cell(line, column, text):
        cells = lines[line].split(",")
        cells[column] = text
        return lines[:line] + [",".join(cells)] + lines[line + 1:]

    def header(old, new):
        return [lines[0].replace(old, new), *lines[1:]]

    def joined(rows, end="\n"):
        return end.join(rows) + end

    mat = read(good["mat"])
    mat73 = read(good["mat73"])
    files = {
        "no header.csv": (joined(lines[1:]), ["line 1", "names of columns"]),
        "header only.csv": (lines[0] + "\n", ["two rows of numbers"]),
        "one row.csv": (joined(lines[:2]), ["expected"]),
        "comments only.csv": ("# a\n# b\n", ["comments only"]),
        "ragged.csv": (joined(lines[:9] + [lines[9] + ",1"] + lines[10:]), ["line 10", "cells"]),
        "cut within a row.csv": (joined(lines[:3])[:-30] + "\n" + joined(lines[3:]), ["line 3", "cells"]),
        "huge.csv": (joined(cell(7, q, "1e999")), ["line 8", "q", "1e999"]),
        "a word.csv": (joined(cell(7, q, "off")), ["line 8", "off"]),
        "decimal commas.csv": (joined(line.replace(".", ",") for line in lines), ["expected"]),
        "two of a name.csv": (joined(header("u [V]", "q [m]")), ["q", "expected"]),
        "no name.csv": (joined(header("q [m]", "")), ["record: ", "q", "expected"]),
        "wrong unit.csv": (joined(header("q [m]", "q [kg]")), ["q", "kg"]),
        "unit left open.csv": (joined(header("q [m]", "q [m")), ["record: ", "q"]),
        "latin-1 unit.csv": (joined(header("q [m]", "q [\u00b5m]")).encode("latin-1"), ["q"]),
        "no time.csv": (joined(header("time [s]", "then [s]")), ["time"]),
        "time stands.csv": (joined(lines[:1] + lines[1:2] * 200), ["expected"]),
        "time without numbers.csv": (joined(line.split(".")[0] + "x," + line.split(",", 1)[1]
                                            for line in lines[1:]), ["expected"]),
        "zeros.csv": (b"\0" * 5000, ["expected"]),
        "picture.csv": (b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 20, ["expected"]),
        "utf-16.csv": (joined(lines[:50]).encode("utf-16"), ["expected"]),
        "wrong magic.mat": (b"JUNK" + mat[4:100] + b"\0" * 400, ["MAT"]),
        "empty.mat": (b"", ["empty"]),
        "header only.mat": (mat[:128], ["expected"]),
        "other byte order.mat": (mat[:126] + b"XX" + mat[128:], ["MAT"]),
        "text inside.mat": (mat_of_class(mat, 4), ["record: ", "expected"]),
        "numbers called cells.mat": (mat_of_class(mat, 1), ["damaged", "expected"]),
        "no length.mat": (mat[:132] + struct.pack("<I", 0xFFFFFFF0) + mat[136:], ["truncated"]),
        "cut v7.3.mat": (mat73[:len(mat73) // 3], ["expected"]),
        "v7.3 head only.mat": (mat73[:512], ["expected"]),
        "v7.3 that is none.mat": (mat73[:512] + b"\0" * 4096, ["expected"]),
    }
    return [(name, ["compare", "--setup", stage, "--record", write(folder, name, content)],
             words if words[0] == "record: " else [name, *words])
            for name, (content, words) in files.items()]


def mat_of_class(mat, kind):
    """A MAT file of version 5 whose first variable says that it is of another class."""
    flags = mat.index(struct.pack("<II", 6, 8), 128) + 8
    return mat[:flags] + bytes([kind]) + mat[flags + 1:]


def write_dialects(folder, record):
    text = read(record).decode()
    return [write(folder, "bom.csv", b"\xef\xbb\xbf" + text.encode()),
            write(folder, "crlf.csv", text.replace("\n", "\r\n")),
            write(folder, "no last line end.csv", text.rstrip("\n")),
            write(folder, "semicolons.csv", text.replace(",", ";")),
            write(folder, "csv named.mat", text),
            write(folder, "latin-1 comment.csv", b"# gr\xf6\xdfer\n" + text.encode())]


def setup_cases(folder):
    changes = [  # file, from, to, words
        ("setup.toml", "[rates]", "[rate]", ["rate"]),
        ("setup.toml", "control = 1000.0", "control = \"1000\"", ["setup.toml:", "control"]),
        ("setup.toml", "control = 1000.0", "control = -1000.0", ["setup.toml:", "control"]),
        ("setup.toml", "control = 1000.0", "control = nan", ["setup.toml:", "control"]),
        ("setup.toml", "control = 1000.0", "control = 1000,0", ["setup.toml:"]),
        ("setup.toml", "control = 1000.0", "control = 1\ncontrol = 2", ["setup.toml:"]),
        ("setup.toml", "mjdiag.setup/1", "mjdiag.setup/9", ["setup.toml", "mjdiag.setup/1"]),
        ("setup.toml", 'schema = "mjdiag.setup/1"', "", ["setup.toml", "schema"]),
        ("setup.toml", 'plant = "plant.xml"', "", ["setup.toml", "plant"]),
        ("setup.toml", 'plant = "plant.xml"', 'plant = "planet.xml"', ["planet.xml"]),
        ("setup.toml", 'element = "load_encoder"', 'element = "loud_encoder"',
         ["loud_encoder", "load_encoder"]),
        ("setup.toml", 'element = "drive"', 'element = "drove"', ["drove", "drive"]),
        ("setup.toml", 'unit = "m"', 'unit = "furlong"', ["furlong"]),
        ("setup.toml", 'sensor = "q"', 'sensor = "p"', ["setup.toml", "p"]),
        ("setup.toml", "noise_sd = 1e-6", "noise_sd = -1e-6", ["setup.toml:", "noise_sd"]),
        ("setup.toml", "moves = [", "moves = 3 # [", ["setup.toml:", "moves"]),
        ("setup.toml", "duration = 1.0", "duration = 0", ["setup.toml:", "duration"]),
        ("setup.toml", "by = { q", "by = { p", ["setup.toml", "p"]),
        ("setup.toml", "cutoff = 100.0", "cutoff = 1e5", ["setup.toml", "cutoff"]),
        ("plant.xml", "<actuator>", "<actuator/><!--", ["plant.xml"]),
        ("plant.xml", 'joint="load" gear', 'joint="lode" gear', ["plant.xml", "lode"]),
        ("plant.xml", 'type="slide"', 'type="slider"', ["plant.xml", "slider"]),
        ("plant.xml", 'mass="95.1"', 'mass="-95.1"', ["plant.xml", "mass"]),
        ("plant.xml", 'mass="95.1"', 'mass="heavy"', ["plant.xml", "mass"]),
        ("plant.xml", 'timestep="0.0002"', 'timestep="0"', ["plant.xml", "time step"]),
        ("plant.xml", '<joint name="load"', '<joint name="stage"', ["plant.xml", "load"]),
    ]
    cases = []
    for number, (file, old, new, words) in enumerate(changes):
        name = f"setup {number}"
        copy = make_stage(os.path.join(folder, name))
        text = read(os.path.join(copy, file)).decode()
        assert old in text, old
        text = text.replace(old, new, 1)
        if new.endswith("<!--"):
            text = text.replace("</actuator>", "-->", 1)
        write(copy, file, text)
        cases.append((f"{name} {new}".replace("/", "_"), ["simulate", "--setup", copy], words))
    for number, (file, content, words) in enumerate([
            ("setup.toml", b"", ["setup.toml", "schema"]),
            ("setup.toml", b"\xff\xfe\0\0", ["setup.toml"]),
            ("plant.xml", b"", ["plant.xml"]),
            ("plant.xml", b"<mujoco/>", ["plant.xml", "expected"]),
            ("plant.xml", b"<robot name='a'><link name='b'/></robot>", ["expected"])]):
        copy = make_stage(os.path.join(folder, f"content {number}"))
        write(copy, file, content)
        cases.append((f"content {number} of {file}", ["simulate", "--setup", copy], words))
    return cases


def other_cases(folder, stage, good):
    plans = {
        "no schema.toml": (PLAN.replace('schema = "mjdiag.plan/1"\n', ""), ["schema"]),
        "no setup.toml": (PLAN.replace('setup = "stage"\n', ""), ["setup"]),
        "setup of nowhere.toml": (PLAN.replace('"stage"', '"nowhere"'), ["nowhere"]),
        "no such fault.toml": (PLAN.replace('"zeta"', '"theta"'), ["theta", "zeta"]),
        "no such channel.toml": (PLAN.replace('["q"]', '["p"]'), ["p", "q"]),
        "no points.toml": (PLAN.replace("points = 4", "points = 0"), ["points"]),
        "points in words.toml": (PLAN.replace("points = 4", 'points = "4"'), ["points"]),
        "no such method.toml": (PLAN.replace('"sobol"', '"dice"'), ["dice", "sobol"]),
        "nothing kept.toml": (PLAN.replace('[keep]\nrecords = ["q"]\n', ""), ["keep"]),
        "range without end.toml": (PLAN.replace("to = 2.0\n", ""), ["to"]),
        "log of negative.toml": (PLAN.replace("1.1", "-1.1") + 'scale = "log"\n', ["axis[0].scale"]),
        "no toml.toml": ("this is not a plan", [".toml:1", "TOML"]),
    }
    lists = {
        "empty list.toml": ("", ["record"]),
        "no file.toml": (LIST.replace('file = "good/record.csv"\n', ""), ["file"]),
        "no such role.toml": (LIST.replace('"fit"', '"test"'), ["role", "fit"]),
        "file of nowhere.toml": (LIST.replace("good/", "bad/"), ["bad/record.csv"]),
        "foreign key.toml": (LIST + 'set = { "rates.control" = 5 }\n', ["rates"]),
        "no fit.toml": (LIST.replace('"fit"', '"validation"'), ["fit"]),
    }
    filters = read(good["filters"]).decode()

    def filters_with(change):
        document = json.loads(filters)
        change(document)
        return json.dumps(document)

    designs = {
        "cut.json": filters[:len(filters) // 2],
        "empty.json": "",
        "list.json": "[1, 2]",
        "other schema.json": filters.replace("mjdiag.filters/1", "mjdiag.filters/7"),
        "without limits.json": filters_with(lambda d: d.pop("limits")),
        "short rows.json": filters_with(lambda d: d["filters"]["B"].pop()),
        "ragged rows.json": filters_with(lambda d: d["filters"]["B"][0].append(1.0)),
        "words as numbers.json": filters_with(lambda d: d.update(sample_time="fast")),
        "no time.json": filters_with(lambda d: d.update(sample_time=0)),
        "endless stride.json": filters_with(lambda d: d.update(stride=10**9)),
        "short prefilters.json": filters_with(lambda d: d["disturbance"]["prefilters"]["B"].pop()),
        "too few limits.json": filters_with(lambda d: d["limits"]["estimates"].pop()),
        "other inputs.json": filters_with(lambda d: d.update(inputs=["volts"])),
        "null limits.json": filters_with(lambda d: d["limits"].update(residual=[None, None])),
    }
    return (
        [(name, ["study", "--plan", write(folder, name, content)], [name, *words])
         for name, (content, words) in plans.items()] +
        [(name, ["discover", "--setup", stage, "--budget", "1", "--data", folder,
                 "--records", write(folder, name, content)], words)
         for name, (content, words) in lists.items()] +
        [(name, ["diagnose", "--setup", stage, "--record", good["csv"],
                 "--filters", write(folder, name, content)], [name, "expected"])
         for name, content in designs.items()])
