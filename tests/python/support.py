"""What the tests of the package share: machines that are simulated in no time."""

import os
import shutil
import tempfile
import unittest

import numpy as np

import mjdiag

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
MJCF = os.path.join(ROOT, "mjcf")
COMMAND = os.environ.get("MJDIAG_COMMAND", "")


def voice_coil(**options):
    return mjdiag.Machine(os.path.join(MJCF, "voice_coil"), **options)


def current(seconds=2.0):
    """A current that moves the stage slowly and fast, as a record."""
    time = np.arange(int(5000 * seconds)) / 5000
    waves = ((0.2, 1.3), (0.15, 4.7), (0.05, 11.0), (0.1, 31.0))
    samples = sum(size * np.sin(2 * np.pi * rate * time) for size, rate in waves)
    return mjdiag.Record({"i": samples}, {"i": "A"}, 1 / 5000)


class Test(unittest.TestCase):
    """A test in a folder of its own."""

    def setUp(self):
        self._before = os.getcwd()
        self.folder = tempfile.mkdtemp(prefix="mjdiag-python-")
        os.chdir(self.folder)

    def tearDown(self):
        os.chdir(self._before)
        shutil.rmtree(self.folder, ignore_errors=True)

    def assertRefuses(self, call, *words):
        """The call raises InputError with one line that has all the words."""
        with self.assertRaises(mjdiag.InputError) as caught:
            call()
        message = str(caught.exception)
        self.assertNotIn("\n", message)
        self.assertIn("expected", message)
        for word in words:
            self.assertIn(word, message)
