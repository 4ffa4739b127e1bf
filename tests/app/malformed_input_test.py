"""Input that is wrong in ways that people and programs make it wrong: each kind gets one
line that says where and what was expected, exit status 2, and leaves no folder behind.
The command is MJDIAG of the environment; bad_input_test.cc has what a table cannot say.
Every command takes a third of a second to begin, and so two of five kinds are tried;
with `--all` all of them."""

import concurrent.futures
import json
import os
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import malformed_files  # noqa: E402
from malformed_options import OPTIONS  # noqa: E402

PROGRAM = os.environ["MJDIAG"]
BAD_INPUT = 2
PATIENCE = 60.0  # s
ALL = "--all" in sys.argv


def run(arguments):
    return subprocess.run([PROGRAM, *arguments], stdin=subprocess.DEVNULL,
                          capture_output=True, timeout=PATIENCE, check=False)


class MalformedInput(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = cls.temporary.name
        cls.stage = malformed_files.make_stage(cls.path("stage"))
        for arguments in (["simulate", "--out", cls.path("good")],
                          ["simulate", "--format", "mat", "--out", cls.path("mat")],
                          ["simulate", "--format", "mat73", "--out", cls.path("mat73")],
                          ["design", "--out", cls.path("design")]):
            done = run([*arguments, "--setup", cls.stage])
            if done.returncode != 0:
                raise AssertionError(done.stderr.decode())
        cls.good = {"csv": cls.path("good/record.csv"), "mat": cls.path("mat/record.mat"),
                    "mat73": cls.path("mat73/record.mat"),
                    "filters": cls.path("design/filters.json")}

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    def complaint(self, name, arguments, words):
        """What is wrong with the answer to a wrong command, or nothing."""
        out = self.path("out of " + name)
        if arguments[0] != "report":
            arguments = [*arguments, "--out", out]
        done = run(arguments)
        line = done.stderr.decode(errors="replace")
        wrong = []
        if done.returncode != BAD_INPUT:
            wrong.append(f"status {done.returncode}")
        if line.count("\n") != 1 or not line.startswith("mjdiag: "):
            wrong.append("not one line")
        wrong += [f"no '{word}'" for word in words if word not in line]
        if done.stdout:
            wrong.append("something on stdout")
        if os.path.exists(out):
            wrong.append("made a folder with " + str(os.listdir(out)))
        return f"{name}: {', '.join(wrong)}: {line}" if wrong else ""

    def check(self, cases):
        if not ALL:
            cases = [case for number, case in enumerate(cases) if number % 5 in (0, 2)]
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            answers = pool.map(lambda case: self.complaint(*case), cases)
        wrong = "".join(answers)
        self.assertFalse(wrong, "\n" + wrong)

    def test_records(self):
        self.check(malformed_files.record_cases(self.folder, self.stage, self.good))

    def test_dialects_of_a_record_that_are_none_the_worse(self):
        plain = ["compare", "--setup", self.stage, "--json", "--record"]
        expected = run([*plain, self.good["csv"]])
        self.assertEqual(expected.returncode, 0, expected.stderr)
        for file in malformed_files.write_dialects(self.folder, self.good["csv"]):
            done = run([*plain, file])
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(json.loads(done.stdout)["channels"],
                             json.loads(expected.stdout)["channels"], file)

    def test_setups_and_plants(self):
        self.check(malformed_files.setup_cases(self.folder))

    def test_plans_lists_and_filters(self):
        self.check(malformed_files.other_cases(self.folder, self.stage, self.good))

    def test_options(self):
        good = {"STAGE": self.stage, "RECORD": self.good["csv"], "NOWHERE": "/nowhere"}
        self.check([(" ".join(arguments).replace("/", "_"),
                     [good.get(word, word) for word in arguments], words)
                    for arguments, words in OPTIONS])


if __name__ == "__main__":
    unittest.main(argv=[word for word in sys.argv if word != "--all"])
