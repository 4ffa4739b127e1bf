"""docs/python.md, block by block as it stands there, and what its reader relies on."""

import contextlib
import io
import os
import re
import shutil
import unittest

import mjdiag
from support import MJCF, ROOT, Test

BLOCK = re.compile(r"^```python *(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


class WalkTest(Test):
    def setUp(self):
        super().setUp()
        # The same bonder on shorter motions: the walk is about what is typed.
        shutil.copytree(os.path.join(MJCF, "ab383"), "mjcf/ab383")
        with open("mjcf/ab383/setup.toml") as file:
            setup = file.read()
        for long, short in (('default_trajectory = "multi"', 'default_trajectory = "xy"'),
                            ("duration = 0.5", "duration = 0.26")):
            self.assertIn(long, setup)
            setup = setup.replace(long, short)
        with open("mjcf/ab383/setup.toml", "w") as file:
            file.write(setup)

    def test_every_block_runs(self):
        with open(os.path.join(ROOT, "docs", "python.md")) as file:
            blocks = BLOCK.findall(file.read())
        self.assertGreater(len(blocks), 10)
        typed, printed = {}, io.StringIO()
        with contextlib.redirect_stdout(printed):
            for needs, block in blocks:
                try:
                    if needs:
                        __import__(needs)
                except ImportError:
                    continue
                # The best motion is waited for by other tests.
                block = block.replace("budget=30", "budget=5")
                exec(compile(block, "docs/python.md", "exec"), typed)
        self.assertIn("Detected: zeta_x = 1.2.", printed.getvalue())
        self.assertIn("drive gain of x", printed.getvalue())
        self.assertIn("times smaller", printed.getvalue())
        self.assertIn("zeta_q", printed.getvalue())
        effects = {cause.effect for cause in typed["found"].causes}
        self.assertEqual(effects, {"zeta_x", "coulomb_friction"})
        for name in ("clip.mp4", "found.html"):
            self.assertGreater(os.path.getsize(name), 10000)
        self.assertIsInstance(typed["extended"], mjdiag.Machine)
        self.assertEqual(mjdiag.Machine("excited").trajectories[-1], "excite")


if __name__ == "__main__":
    unittest.main()
