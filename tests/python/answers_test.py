"""Diagnosis, calibration, discovery and the monitor find what was put in."""

import json
import os
import subprocess
import time
import unittest

import numpy as np

import mjdiag
from support import COMMAND, MJCF, Test, current, voice_coil


class AnswersTest(Test):
    @classmethod
    def setUpClass(cls):
        cls.coil = voice_coil()
        cls.push = current()
        cls.healthy = [cls.coil.simulate(replay=cls.push, seed=seed) for seed in (1, 2)]
        cls.worn = cls.coil.with_faults(zeta=1.05).simulate(replay=cls.push, seed=3)

    def test_a_diagnosis_finds_the_fault(self):
        result = self.coil.diagnose(self.worn)
        self.assertTrue(result.detected)
        fault = result.faults["zeta"]
        self.assertTrue(fault.detected)
        self.assertLess(abs(fault.value - 1.05), 4 * fault.sd)
        self.assertLess(fault.ci95[0], fault.value)
        self.assertGreater(fault.ci95[1], fault.value)
        self.assertFalse(result.faults["eta"].detected)
        self.assertEqual(result.residual.shape, (self.worn.samples,))
        self.assertIn("zeta = 1.05", result.verdict)
        self.assertIn("<td>zeta</td>", result._repr_html_())
        self.assertEqual(result.to_dict()["schema"], "mjdiag.diagnosis/1")
        self.assertFalse(self.coil.diagnose(self.healthy[0]).detected)

    @unittest.skipUnless(COMMAND, "needs the command, $MJDIAG_COMMAND")
    def test_it_says_what_the_command_says(self):
        self.worn.write("worn.csv")
        said = json.loads(subprocess.run(
            [COMMAND, "diagnose", "--setup", os.path.join(MJCF, "voice_coil"),
             "--record", "worn.csv", "--json"],
            check=True, capture_output=True, text=True).stdout)
        for record in (self.worn, "worn.csv"):
            self.assertEqual(self.coil.diagnose(record).to_dict()["faults"],
                             said["faults"])

    def test_a_calibration_says_how_well_the_machine_is_known(self):
        calibrated = self.coil.calibrate(self.healthy)
        known = calibrated.calibration
        number = known.numbers["stiffness@stage"]
        self.assertAlmostEqual(number.factor, 1.0, 2)
        self.assertLess(number.sd, number.prior_sd)
        self.assertEqual((len(known.misfits), known.doubts), (2, []))
        self.assertTrue(calibrated.diagnose(self.worn).faults["zeta"].detected)
        self.assertIsNone(self.coil.calibration)
        calibrated.write("calibrated")
        again = mjdiag.Machine("calibrated")
        read = again.calibration
        self.assertEqual(read.numbers["stiffness@stage"][:2], number[:2])
        self.assertEqual((read.misfits, read.force_noise), ([], known.force_noise))
        self.assertEqual(again.diagnose(self.worn).to_dict(),
                         calibrated.diagnose(self.worn).to_dict())
        self.assertRefuses(lambda: calibrated.with_faults(zeta=2).write("x"), "faults")
        self.assertRefuses(lambda: self.coil.calibrate([]), "no records")
        self.assertRefuses(lambda: self.coil.calibrate(3), "int")

    def test_a_discovery_finds_the_hidden_effect(self):
        hidden = self.coil.with_effect("cubic_stiffness@stage", coefficient=4e6)
        measured = hidden.simulate(replay=self.push)
        unseen = hidden.simulate(replay=current(1.0), seed=9)
        found = self.coil.discover([measured], validation=[unseen], budget=20,
                                   only=["structure"])
        (cause,) = found.causes
        self.assertEqual((cause.effect, cause.site), ("cubic_stiffness", "stage"))
        parameter = cause.parameters["coefficient"]
        self.assertLess(abs(parameter.value - 4e6), 4 * parameter.sd)
        self.assertEqual(parameter.unit, "N/m^3")
        (kind,) = found.kinds
        self.assertEqual((kind.name, kind.site), ("compliance", "stage"))
        self.assertGreater(kind.probability, 0.99)
        self.assertEqual(found.verdict, "explained")
        self.assertGreater(found.gain[1], 0.99)
        for after, before in zip(found.mismatch_after, found.mismatch_before):
            self.assertLess(after["x"], 0.01 * before["x"])
        again = found.machine.simulate(replay=self.push, noise=0.0)
        np.testing.assert_allclose(again["x"], measured["x"], atol=1e-6)
        self.assertIn("cubic_stiffness", found._repr_html_())
        self.assertEqual(found.to_dict()["causes"][0]["effect"], "cubic_stiffness")
        found.write("extended")
        extended = mjdiag.Machine("extended")
        self.assertEqual(extended.effects, found.machine.effects)
        self.assertRefuses(lambda: self.coil.discover([]), "no records")
        self.assertRefuses(lambda: self.coil.discover([measured], only=["glue"]), "glue")

    def test_a_monitor_says_at_the_end_what_a_diagnosis_says(self):
        monitor = mjdiag.Monitor(self.coil, capacity=self.worn.samples)
        self.assertEqual((monitor.outputs, monitor.inputs), (["x"], ["i"]))
        readings = self.worn["x"].reshape(-1, 1)
        commands = self.worn["i"].reshape(-1, 1)
        for y, u in zip(readings, commands):
            monitor.step(y, u)
        self.assertEqual(monitor.ticks, self.worn.samples)
        self.assertEqual(monitor.estimates.shape, (len(monitor.fault_names),))
        self.assertTrue(monitor.faults["zeta"].detected)
        result, whole = monitor.conclude(), self.coil.diagnose(self.worn)
        self.assertEqual(result.to_dict(), whole.to_dict())
        self.assertRefuses(lambda: monitor.step([0.0], [0.0]), "concluded")
        monitor.restart()
        self.assertFalse(monitor.step([0], (0.0,)))

    def test_a_monitor_refuses_bad_ticks(self):
        monitor = mjdiag.Monitor(self.coil)
        one = np.zeros(1)
        self.assertRefuses(lambda: monitor.step(np.zeros(2), one), "y", "2 values", "1")
        self.assertRefuses(lambda: monitor.step(one, ["a"]), "u", "dtype")
        self.assertRefuses(lambda: monitor.step(one, np.zeros((1, 1))), "u", "(1, 1)")
        self.assertEqual(monitor.ticks, 0)
        self.assertRefuses(lambda: monitor.step(np.array([np.nan]), one), "finite")
        self.assertRefuses(lambda: monitor.step(one, one), "restart")
        self.assertRefuses(lambda: mjdiag.Monitor(), "filters")
        self.assertRefuses(monitor.conclude, "ticks")

    @unittest.skipUnless(os.environ.get("MJDIAG_OPTIMISED"), "for optimised builds")
    def test_a_step_adds_no_more_than_two_microseconds(self):
        self.coil.calibrate(self.healthy[:1]).write("calibrated")
        # Without a twin there is hardly any work behind the call.
        monitor = mjdiag.Monitor(filters="calibrated/filters.json")
        y, u, times = np.zeros(1), np.zeros(1), []
        for _ in range(5000):
            start = time.perf_counter()
            monitor.step(y, u)
            times.append(time.perf_counter() - start)
        self.assertLess(sorted(times)[len(times) // 10], 2e-6)

    def test_records_of_a_manifest_have_their_roles(self):
        hidden = self.coil.with_effect("cubic_stiffness@stage", coefficient=4e6)
        hidden.simulate(replay=self.push).write("a.csv")
        hidden.simulate(replay=current(1.0), seed=9).write("b.csv")
        with open("records.toml", "w") as file:
            file.write('[[record]]\nfile = "a.csv"\nrole = "fit"\n'
                       '[[record]]\nfile = "b.csv"\nrole = "validation"\n')
        found = self.coil.discover("records.toml", data=".", budget=20,
                                   only=["structure"])
        self.assertEqual([(one["file"], one["role"]) for one in found.to_dict()["records"]],
                         [("a.csv", "fit"), ("b.csv", "validation")])
        self.assertRefuses(lambda: self.coil.discover("records.toml"), "data")
        self.assertRefuses(lambda: self.coil.discover("a.csv", data="."), "data")

    @unittest.skipUnless(
        os.path.exists("/usr/share/javascript/dygraphs"), "needs libjs-dygraphs")
    def test_answers_are_written_as_pages(self):
        self.coil.diagnose(self.worn).report("worn.html")
        with open("worn.html") as file:
            self.assertIn("zeta", file.read())


if __name__ == "__main__":
    unittest.main()
