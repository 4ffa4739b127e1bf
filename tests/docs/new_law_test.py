"""Somebody who knows docs/how-to-law.md alone adds a law: the files and lines of the page, on a
scratch copy of the effects.

    new_law_test.py <build folder>
"""

import importlib.util
import json
import math
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PAGE = (ROOT / "docs/how-to-law.md").read_text(encoding="utf-8")

PROGRAM = r"""
#include <cstdio>

#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"

int main() {
  const mjdiag::Effect& found = mjdiag::FindEffect("transitional_drag");
  const auto& law = dynamic_cast<const mjdiag::JointForceEffect&>(found);
  mjdiag::EffectValues values(1);
  values[0] = 0.5;
  for (const double v : {-2.0, 0.0, 0.3, 4.0}) {
    std::printf("%.17g %.17g\n", v, law.Force(0.0, v, 0.0, values));
  }
}
"""


def code(language, beginning):
    """The block of the page that begins so."""
    for block in re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL):
        if block.startswith(beginning):
            return block
    raise AssertionError(f"no {language} block of the page begins with {beginning!r}")


def compiler(build):
    """The words that compile a file as those of plugin/effects are."""
    for entry in json.loads((build / "compile_commands.json").read_text()):
        if "mjdiag_plugin_effects.dir" not in entry["command"] + entry.get("output", ""):
            continue
        words = shlex.split(entry["command"])
        kept, skip = [], 0
        for word in words:
            if skip:
                skip -= 1
            elif word in ("-o", "-c", "-MT", "-MF", "-include"):
                skip = 1
            elif word not in ("-MD", "-Winvalid-pch"):
                kept.append(word)
        return kept, entry["directory"]
    raise AssertionError("no command compiles plugin/effects")


class NewLaw(unittest.TestCase):
    build = pathlib.Path()

    def test_is_one_file_and_two_lines(self):
        with tempfile.TemporaryDirectory() as scratch:
            scratch = pathlib.Path(scratch)
            copy = scratch / "include/mjdiag/plugin/effects"
            shutil.copytree(ROOT / "plugin/effects", copy)
            law = copy / "friction/transitional_drag.cc"
            law.write_text(code("cpp", "// -coefficient"), encoding="utf-8")
            with open(copy / "effect_list.h", "a", encoding="utf-8") as effects:
                effects.write(code("cpp", "MJDIAG_EFFECT"))
            program = scratch / "program.cc"
            program.write_text(PROGRAM, encoding="utf-8")
            words, folder = compiler(self.build)
            libraries = [str(path) for of in ("plugin", "diagnosis", "controllers",
                                              "signals")
                         for path in sorted(self.build.glob(f"{of}/*.a"))]
            # The list of the scratch copy comes before that of the library.
            subprocess.run(
                [words[0], f"-I{scratch}/include", *words[1:], str(program), str(law),
                 str(copy / "registry.cc"), "-o", str(scratch / "program"),
                 "-Wl,--allow-multiple-definition", "-Wl,--start-group", *libraries,
                 "-Wl,--end-group", *self.others()],
                check=True, cwd=folder)
            said = subprocess.run([scratch / "program"], check=True, text=True,
                                  capture_output=True).stdout
            forces = [tuple(map(float, line.split())) for line in said.splitlines()]
            for v, force in forces:
                expected = -0.5 * math.copysign(abs(v) ** 1.5, v)
                self.assertAlmostEqual(force, expected, delta=1e-15)
            self.assertEqual(len(forces), 4)
            self.check_python(scratch, forces)

    def check_python(self, scratch, forces):
        source = (ROOT / "plugin/extension/effects_laws.py").read_text(encoding="utf-8")
        module = scratch / "laws.py"
        module.write_text(source + "\n\n" + code("python", "@_law"), encoding="utf-8")
        spec = importlib.util.spec_from_file_location("laws", module)
        laws = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(laws)
        _, function, count = laws.LAWS["transitional_drag"]
        self.assertEqual(count, 1)
        for v, force in forces:
            at = type("At", (), {"v": v})
            self.assertAlmostEqual(function(at, 0.5), force, delta=1e-15)

    def others(self):
        """Libraries of others that those of mjdiag ask for, as the command links them."""
        link = (self.build / "build.ninja").read_text(encoding="utf-8")
        rule = re.search(r"^build app/mjdiag:.*?^  LINK_LIBRARIES = (.*?)$", link,
                         re.DOTALL | re.MULTILINE)
        return [word for word in shlex.split(rule[1]) if not re.search(r"mjdiag_|^plugin/|"
                r"^(signals|diagnosis|controllers|discovery|report|render|studies|"
                r"watch)/", word)]


if __name__ == "__main__":
    NewLaw.build = pathlib.Path(sys.argv.pop()).resolve()
    unittest.main()
