"""Some entries of docs/accuracy.md: that they hold, and that one which is off would fail.
scripts/accuracy makes all of them."""

import importlib.util
import os
import sys
import unittest

from support import ROOT, Test

HAVE = all(importlib.util.find_spec(name) for name in ("scipy", "mpmath"))
if HAVE:
    sys.path.insert(0, os.path.join(ROOT, "scripts"))
    from accuracy_rows import common, files, filters, linear, report, runs


@unittest.skipUnless(HAVE, "needs SciPy and mpmath")
class AccuracyTest(Test):
    def assert_passes(self, *functions):
        for function in functions:
            for row in function():
                with self.subTest(row.what):
                    self.assertLessEqual(row.error, row.allowed)
                    self.assertTrue(row.passed)

    def test_matrices(self):
        self.assert_passes(linear.bonder_matrices)

    def test_runs(self):
        self.assert_passes(runs.voice_coil)

    def test_filters(self):
        self.assert_passes(filters.denominators)

    def test_files_and_plans(self):
        self.assert_passes(files.round_trips, files.grids)

    def test_what_is_off_fails(self):
        def row(ours, **more):
            return common.Row("part", "what", "", "", ours, [1.0, 3.0], 1.0, "", **more)

        self.assertTrue(row([1.0 + 4e-16, 3.0]).passed)
        for wrong in ([1.0, 3.0 + 1e-14], [float("nan"), 3.0], [float("inf"), 3.0]):
            self.assertFalse(row(wrong).passed)
        self.assertFalse(row([1.0, 3.0 + 1e-14], scale=1).passed)
        with self.assertRaises(SystemExit):
            row([1.0])

    def test_the_document_says_what_fails(self):
        good = common.Row("part", "good", "`a|b`", "", [1.0], [1.0], 1.0, "")
        bad = common.Row("part", "bad", "", "", [1.1], [1.0], 1.0, "")
        good.section = bad.section = ""
        text = report.document([good, bad])
        self.assertIn("| good | `a\\|b` |", text)
        self.assertIn("**fails**", text)
        self.assertIn("- *bad*.", text)
        self.assertNotIn("**fails**", report.document([good]))


if __name__ == "__main__":
    unittest.main()
