"""scripts/bench: what it calls worse, its history and its page. What it measures the
benchmarks themselves do."""

import os
import pathlib
import re
import sys
import unittest

from support import ROOT, Test

sys.path.insert(0, os.path.join(ROOT, "scripts"))
from bench_ratios import history, page, ratios  # noqa: E402

OLD = [1.02, 1.03, 1.01, 1.04, 1.02]


def entry(commit, computer="2 cores", **values):
    return history.Entry(commit, computer, values)


class BenchTest(Test):
    def test_worse_is_what_lies_beyond_all_earlier_values(self):
        above, across, below = [1.05, 1.06, 1.2, 1.05, 1.07], [1.04] * 5, [1.0] * 5
        self.assertEqual(history.verdict(above, OLD, True), "worse")
        self.assertEqual(history.verdict(above, OLD, False), "better")
        self.assertEqual(history.verdict(across, OLD, True), "same")
        self.assertEqual(history.verdict(below, OLD, True), "better")
        self.assertEqual(history.verdict(below, OLD, False), "worse")
        self.assertEqual(history.chance(above, OLD), 1 / 252)

    def test_is_compared_with_another_commit_on_such_a_computer(self):
        entries = [entry("c"), entry("b", "8 cores"), entry("a")]
        self.assertEqual(history.last_before(entries, entry("c")).commit, "a")
        self.assertEqual(history.last_before(entries, entry("d")).commit, "c")
        self.assertIsNone(history.last_before([], entry("d")))

    def test_a_commit_that_is_measured_again_is_one_entry(self):
        entries = history.with_entry([entry("b"), entry("a")], entry("b", study=[1.0]))
        self.assertEqual([(e.commit, e.values) for e in entries],
                         [("b", {"study": [1.0]}), ("a", {})])

    def test_the_file_has_what_was_written(self):
        path = pathlib.Path("performance.json")
        self.assertEqual(history.read(path), [])
        entries = [entry("b", study=OLD, clip=OLD), entry("a", study=[2.0])]
        history.write(path, entries)
        self.assertEqual(history.read(path), entries)

    def test_says_what_got_worse(self):
        now = entry("b", closed_loop=[2.0] * 5, clip=[2.0] * 5, clip_rate=[1.0] * 5)
        before = entry("a", closed_loop=OLD, clip=OLD, clip_rate=OLD)
        self.assertEqual(history.report(now, before, False), ["closed_loop"])
        self.assertEqual(history.report(now, before, True), [])
        self.assertEqual(history.report(now, None, False), [])

    def test_the_page_shows_targets_and_history(self):
        text = page.document([entry("b", closed_loop=[1.06] * 5, clip=[1.4] * 5),
                              entry("a", closed_loop=OLD)])
        self.assertRegex(text, r"`closed_loop`<br>.* at most 1.05 \| \*\*1.060\*\* \| "
                               r"1.060 to 1.060 \| 1.020 \|")
        self.assertRegex(text, r"`clip`<br>.* at least 1.3 \| 1.400 \|")
        rows = [line for line in text.splitlines() if line.startswith("|")]
        self.assertEqual(len(rows), len(ratios.RATIOS) + 2)
        self.assertEqual({row.count("|") for row in rows}, {6})

    def test_the_page_in_docs_is_of_its_history(self):
        docs = pathlib.Path(ROOT) / "docs"
        entries = history.read(docs / "performance.json")
        self.assertEqual((docs / "performance.md").read_text(encoding="utf-8"),
                         page.document(entries))

    def test_ratios_come_from_benchmarks_that_exist(self):
        bench = pathlib.Path(ROOT) / "tests/bench"
        for ratio in ratios.RATIOS:
            if ratio.source[0] == "beside_python":
                continue
            program, case, counter = ratio.source
            text = (bench / f"{program}.cc").read_text(encoding="utf-8")
            function, _, argument = case.partition("/")
            with self.subTest(ratio.name):
                self.assertTrue(re.search(rf"\b{function}\b", text))
                self.assertTrue(not argument or re.search(rf"\b{argument}\b", text))
                self.assertIn(f'"{counter}"', text)


if __name__ == "__main__":
    unittest.main()
