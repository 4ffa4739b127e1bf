"""docs/notebooks, cell by cell, without a display, a browser or a kernel."""

import contextlib
import glob
import importlib.util
import io
import json
import os
import re
import unittest

from support import MJCF, ROOT, Test

FOLDER = os.path.join(ROOT, "docs", "notebooks")


def cells(path):
    with open(path) as file:
        return json.load(file)["cells"]


def imported(source):
    return re.findall(r"^(?:import|from) (\w+)", source, re.MULTILINE)


class NotebooksTest(Test):
    def test_hold_no_outputs(self):
        paths = glob.glob(os.path.join(FOLDER, "*.ipynb"))
        self.assertEqual(len(paths), 3)
        for path in paths:
            for cell in cells(path):
                self.assertFalse(cell.get("outputs"), path)
                self.assertIsNone(cell.get("execution_count"), path)

    def run_notebook(self, name):
        os.environ["MPLBACKEND"] = "Agg"
        os.symlink(MJCF, "mjcf")
        path = os.path.join(FOLDER, name + ".ipynb")
        code = ["".join(cell["source"]) for cell in cells(path) if cell["cell_type"] == "code"]
        for module in imported("\n".join(code)):
            if importlib.util.find_spec(module) is None:
                self.skipTest("needs " + module)
        typed = {"__name__": "__main__"}
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            for number, source in enumerate(code):
                lines = source.splitlines()
                exec(compile(source, f"{name}, cell {number}", "exec"), typed)
                # A notebook shows the value of a last line that is a name.
                if lines[-1].isidentifier():
                    self.assertIn("<", typed[lines[-1]]._repr_html_())
        return typed, printed.getvalue()

    def test_fault_study(self):
        typed, _ = self.run_notebook("fault_study")
        self.assertEqual(typed["study"].runs, 12 * 8)

    def test_measured_to_cause(self):
        _, printed = self.run_notebook("measured_to_cause")
        self.assertIn("cubic_stiffness at stage", printed)

    def test_classifier(self):
        self.run_notebook("classifier")


if __name__ == "__main__":
    unittest.main()
