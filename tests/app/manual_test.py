"""Manual pages and completion, made of the command in MJDIAG."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "app", "manual"))

import command_help  # noqa: E402
import manual  # noqa: E402

PROGRAM = os.environ["MJDIAG"]


class Manual(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.whole, cls.parts = command_help.commands(PROGRAM)
        manual.write(cls.whole, cls.parts, "0", Path(cls.folder.name))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def complete(self, *words):
        script = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); '
                  '_mjdiag; echo "${COMPREPLY[@]}"')
        return subprocess.run(
            ["bash", "-c", script, "bash", os.path.join(self.folder.name, "completions/mjdiag"),
             *words], check=True, text=True, stdout=subprocess.PIPE).stdout.split()

    def test_every_option_of_every_command_has_its_place(self):
        self.assertIn("simulate", self.parts)
        for name, command in self.parts.items():
            with open(os.path.join(self.folder.name, f"man1/mjdiag-{name}.1")) as file:
                text = file.read().replace("\\-", "-")
            self.assertGreater(len(command.options), 1)
            for option in command.names():
                self.assertIn(f"\\fB{option}\\fR", text)

    def test_completion_knows_commands_options_and_choices(self):
        self.assertEqual(self.complete("mjdiag", "lin"), ["linearize"])
        self.assertEqual(sorted(self.complete("mjdiag", "simulate", "--stream-f")),
                         ["--stream-for", "--stream-format"])
        self.assertEqual(self.complete("mjdiag", "simulate", "--format", "mat7"), ["mat73"])
        for name, command in self.parts.items():
            self.assertEqual(sorted(self.complete("mjdiag", name, "-")),
                             sorted(command.names()))


if __name__ == "__main__":
    unittest.main()
