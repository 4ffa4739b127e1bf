"""What a machine says of records, motions and its own diagnosis: compare, excite, design
and tolerate, with the figures of the command."""

import json
import os
import shutil
import subprocess
import unittest

import numpy as np

import mjdiag
from support import COMMAND, MJCF, Test, current, voice_coil

BONDER = os.path.join(MJCF, "ab383")
ARM = """
<mujoco>
  <option timestep="0.001" gravity="0 0 9.81"/>
  <worldbody>
    <body name="upper">
      <joint name="shoulder" axis="0 -1 0" damping="0.5"/>
      <geom type="capsule" size="0.02" fromto="0 0 0 0 0 -0.3" mass="1"/>
      <body name="lower" pos="0 0 -0.3">
        <joint name="elbow" axis="0 -1 0" damping="0.5"/>
        <geom type="capsule" size="0.02" fromto="0 0 0 0 0 -0.3" mass="1"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="u1" joint="shoulder"/><motor name="u2" joint="elbow"/></actuator>
  <sensor><jointpos name="q1" joint="shoulder"/><jointpos name="q2" joint="elbow"/></sensor>
</mujoco>
"""
ARM_SETUP = """
schema = "mjdiag.setup/1"
name = "Arm on its head"
plant = "plant.xml"
rates = { control = 500.0, substeps = 2 }
default_trajectory = "swing"
""" + "".join(f"""
[sensors.q{i}]
element = "q{i}"
unit = "rad"
noise_sd = 1e-5
[actuators.u{i}]
element = "u{i}"
unit = "N m"
[axes.q{i}]
sensor = "q{i}"
actuator = "u{i}"
feedback = {{ numerator = [40.0], denominator = [1.0] }}
limits = {{ velocity = 10.0, acceleration = 50.0, jerk = 1000.0, snap = 50000.0 }}
""" for i in (1, 2)) + """
[trajectories.swing]
duration = 8.0
period = 8.0
moves = [{ at = 0.1, by = { q1 = 0.8, q2 = 1.0 } },
         { at = 1.5, by = { q1 = -0.8, q2 = -1.0 } }]
"""


def said(*arguments):
    """What the command says in JSON."""
    return json.loads(subprocess.run(
        [COMMAND, *arguments, "--json"], check=True, capture_output=True,
        text=True).stdout)


def servo():
    """A folder with the servo, seen through a noisy encoder, whose files have the names of
    its channels."""
    shutil.copytree(os.path.join(MJCF, "servo"), "servo")
    with open("servo/setup.toml") as file:
        text = file.read()
    fine, columns = "resolution = 0.0015339807878856412", "[record.channels]"
    assert fine in text and columns in text
    before, after = text.replace(fine, "noise_sd = 1e-4").split(columns)
    with open("servo/setup.toml", "w") as file:
        file.write(before + "[diagnosis]" + after.split("[diagnosis]", 1)[1])
    return "servo"


def arm():
    """A folder with an arm that stands on its head as long as its controllers hold it."""
    os.mkdir("arm")
    for name, text in (("plant.xml", ARM), ("setup.toml", ARM_SETUP)):
        with open(os.path.join("arm", name), "w") as file:
            file.write(text)
    return "arm"


class CompareTest(Test):
    def test_says_what_is_wrong_with_a_machine_that_differs(self):
        machine = mjdiag.Machine(servo())
        measured = machine.with_effect("coulomb_friction@shaft", force=0.02).simulate(
            seed=3, duration=2.0)
        found = machine.compare(measured)
        self.assertTrue(found.closed_loop and found.exceeds_noise)
        q = found.channels["q"]
        wrong = found.measured["q"] - found.simulated["q"]
        self.assertAlmostEqual(q.rms, np.sqrt(np.mean(wrong**2)), 12)
        self.assertAlmostEqual(q.peak, abs(wrong).max(), 12)
        self.assertEqual((q.unit, q.exceeds_noise), ("rad", True))
        self.assertGreater(q.rms, 5 * q.noise_floor)
        self.assertIn("volts", found.verdict)
        self.assertIn("<td>volts</td>", found._repr_html_())
        self.assertIn("q", repr(q))
        self.assertFalse(found.falls)
        self.assertEqual(list(found.prediction), ["q"])
        self.assertIsInstance(found.deviance, float)
        self.assertFalse(machine.compare(machine.simulate(duration=2.0)).exceeds_noise)

    @unittest.skipUnless(COMMAND, "needs the command, $MJDIAG_COMMAND")
    def test_has_the_figures_of_the_command(self):
        machine = mjdiag.Machine(servo())
        measured = machine.with_effect("coulomb_friction@shaft", force=0.02).simulate(
            seed=3, duration=2.0)
        measured.write("measured.csv")
        for found, flags in ((machine.compare(measured), ()),
                             (machine.compare("measured.csv", seed=2), ("--seed", "2")),
                             (machine.compare(measured, open_loop=True),
                              ("--open-loop",))):
            told = said("compare", "--setup", "servo", "--record", "measured.csv", *flags)
            for key, value in found.to_dict().items():
                self.assertEqual(value, told[key], (flags, key))
            self.assertEqual(found.channels["q"].rms, told["channels"]["q"]["rms"])
            self.assertEqual(found.derived, told["derived"])
            self.assertEqual(found.closed_loop, not flags or flags[0] == "--seed")

    def test_tells_the_missing_force_of_an_arm_that_nothing_holds(self):
        machine = mjdiag.Machine(arm())
        measured = machine.with_effect("coulomb_friction@elbow", force=0.2).simulate(seed=5)
        found = machine.compare(measured, open_loop=True)
        self.assertEqual(list(found.missing_force), ["shoulder", "elbow"])
        force = found.missing_force["elbow"]
        self.assertEqual((force.unit, force.value.shape), ("N m", (measured.samples,)))
        # Of the elbow's friction what the shoulder's force takes: its noise is found, too.
        self.assertLess(found.missing_force["shoulder"].rms, 0.03)
        self.assertTrue(found.falls)
        # Friction is its force where the elbow turns, and less where it rests.
        self.assertTrue(0.1 < force.rms < 0.2)
        self.assertAlmostEqual(force.rms, np.sqrt(np.mean(force.value**2)), 9)
        self.assertFalse(force.value.flags.writeable)
        np.testing.assert_allclose(found.horizons, [0.002, 0.01, 0.1, 1.0])
        self.assertEqual(found.prediction["q2"].shape, (4,))
        self.assertTrue((np.diff(found.prediction["q2"]) > 0).all())
        self.assertIsInstance(found.deviance, float)
        self.assertIn("elbow", found._repr_html_())
        self.assertIn("elbow", repr(force))
        if not COMMAND:
            return
        measured.write("measured.csv")
        told = said("compare", "--setup", "arm", "--record", "measured.csv", "--open-loop")
        for key, value in found.to_dict().items():
            self.assertEqual(value, told[key], key)
        self.assertEqual(told["missing_force"]["elbow"], force.rms)
        self.assertEqual(told["prediction"]["rms"]["q2"], found.prediction["q2"].tolist())

    def test_refuses_what_it_cannot_replay(self):
        coil = voice_coil()
        self.assertRefuses(lambda: coil.compare(3), "compare", "int")
        self.assertRefuses(lambda: coil.compare(current(0.01)), "sensor")
        slow = mjdiag.Record({"i": np.zeros(99), "x": np.zeros(99)}, {"i": "A", "x": "m"}, 1.0)
        self.assertRefuses(lambda: coil.compare(slow), "sample time")


class ExciteTest(Test):
    def test_gives_a_machine_that_tells_more(self):
        machine = mjdiag.Machine(servo())
        wide = {"q": {"velocity": 20.0, "acceleration": 400.0, "jerk": 2e5, "snap": 1e8}}
        found = machine.excite("armature@shaft", limits=wide, max_frequency=20)
        self.assertGreater(found.gain, 2.0)
        at = found.unknowns.index("armature@shaft")
        self.assertEqual(found.wanted.tolist(),
                         [i == at for i in range(len(found.unknowns))])
        self.assertAlmostEqual(found.gain, found.sd_before[at] / found.sd_after[at], 12)
        self.assertEqual(found.limits["q"]["velocity"], 20.0)
        self.assertLess(found.peaks["q"]["velocity"], 20.0 + 1e-6)
        self.assertEqual({tone.axis for tone in found.tones}, {"q"})
        self.assertLess(max(tone.frequency for tone in found.tones), 20.1)
        self.assertIn("times smaller", found.verdict)
        self.assertIn("<td>armature@shaft</td>", found._repr_html_())

        self.assertNotIn("excite", machine.trajectories)
        run = found.machine.simulate(noise=0.0)
        for name in run:
            np.testing.assert_array_equal(run[name], found.run_after[name])
        self.assertLessEqual(abs(run["volts"]).max(), 7.4)
        worn = found.machine.with_faults(eta=0.9)
        self.assertEqual(worn.trajectories[-1], "excite")
        self.assertTrue(found.machine.diagnose(worn.simulate(seed=2)).detected)

        self.assertEqual(found.write("excited"), "excited/setup.toml")
        worn.write("worn")
        for folder, same in (("excited", found.machine), ("worn", worn)):
            np.testing.assert_array_equal(
                mjdiag.Machine(folder).simulate(seed=4)["q"], same.simulate(seed=4)["q"])
        self.assertRefuses(lambda: found.write("servo"), "another folder")
        self.assertRefuses(lambda: worn.write("servo"), "another folder")
        again = worn.excite("eta", name="again", budget=0.01)
        self.assertRefuses(lambda: again.write("more"), "faults")
        again.machine.write("more")
        self.assertEqual(mjdiag.Machine("more").trajectories[-2:], ["excite", "again"])

    @unittest.skipUnless(COMMAND, "needs the command, $MJDIAG_COMMAND")
    def test_is_the_design_of_the_command(self):
        found = mjdiag.Machine(servo()).excite().to_dict()
        told = said("excite", "--setup", "servo")
        self.assertEqual({key: told[key] for key in found}, found)
        self.assertFalse(found["stopped"])

    def test_goes_to_pandas(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("needs pandas")
        found = mjdiag.Machine(servo()).excite(budget=0.01)
        frame = found.to_pandas()
        self.assertIsInstance(frame, pandas.DataFrame)
        self.assertEqual(list(frame.index), found.unknowns)
        self.assertEqual(frame["sd_before"]["eta"], found.sd_before[0])

    def test_a_budget_ends_it(self):
        found = mjdiag.Machine(BONDER).excite("beta_x", budget=0.01)
        self.assertTrue(found.stopped)
        self.assertIn("excite", found.machine.trajectories)

    def test_refuses_what_there_is_not(self):
        machine = mjdiag.Machine(servo())
        self.assertRefuses(lambda: machine.excite("theta"), "theta", "eta")
        self.assertRefuses(lambda: machine.excite(3), "wanted", "int")
        self.assertRefuses(lambda: machine.excite([3]), "wanted", "int")
        self.assertRefuses(lambda: machine.excite(limits={"p": {}}), "limits", "'p'")
        self.assertRefuses(lambda: machine.excite(limits={"q": {"speed": 1.0}}),
                           "'q'", "speed", "velocity")
        self.assertRefuses(lambda: machine.excite(limits={"q": {"velocity": "fast"}}),
                           "'q'", "velocity", "str")
        self.assertRefuses(lambda: machine.excite(limits={"q": {"force": np.inf}}),
                           "force", "finite")
        self.assertRefuses(lambda: machine.excite(limits=[1]), "limits", "list")
        self.assertRefuses(lambda: machine.excite(limits={"q": 1.0}), "'q'", "float")
        self.assertRefuses(lambda: machine.excite(budget=0), "budget")
        self.assertRefuses(lambda: machine.excite(max_frequency=-1), "max_frequency")
        self.assertRefuses(lambda: machine.excite(name="default"), "default", "another")
        self.assertRefuses(lambda: voice_coil().excite(), "axes")


class DesignTest(Test):
    def test_says_what_the_filters_are_made_of(self):
        found = voice_coil().design(method="lp")
        self.assertEqual((found.outputs, found.inputs), (["x"], ["i"]))
        self.assertEqual(found.fault_names, voice_coil().fault_names)
        self.assertEqual(found.observability_ranks.tolist(), [1, 2, 2])
        self.assertEqual((found.states, found.minimal_degree, found.degree), (2, 2, 2))
        self.assertLess(found.linear_program["angle"], 1e-9)
        self.assertLess(found.limits[0], found.limits[1])
        self.assertIn("from degree 2 on", found.verdict)
        self.assertIn("Linear programs", found._repr_html_())
        self.assertIsNone(voice_coil().design().linear_program)

    @unittest.skipUnless(COMMAND, "needs the command, $MJDIAG_COMMAND")
    def test_is_the_design_of_the_command(self):
        setup = os.path.join(MJCF, "voice_coil")
        for method in ("svd", "lp"):
            found = voice_coil().design(method=method, nominal_runs=3).to_dict()
            told = said("design", "--setup", setup, "--method", method,
                        "--nominal-runs", "3")
            self.assertEqual(set(told) - set(found), {"command"})
            self.assertEqual({key: told[key] for key in found}, found)

    def test_a_diagnosis_takes_what_it_writes(self):
        coil = voice_coil()
        worn = coil.with_faults(zeta=1.05).simulate(replay=current(1.0), seed=3)
        coil.design().write("filters.json")
        self.assertEqual(coil.diagnose(worn, filters="filters.json").to_dict(),
                         coil.diagnose(worn).to_dict())

    def test_refuses_what_there_is_not(self):
        coil = voice_coil()
        self.assertRefuses(lambda: coil.design(method="guess"), "guess", "svd")
        self.assertRefuses(lambda: coil.design(nominal_runs=1), "nominal_runs")
        self.assertRefuses(lambda: coil.design(filters="nowhere.json"), "nowhere.json")
        self.assertRefuses(lambda: coil.design().write("nowhere/filters.json"), "nowhere")


class TolerateTest(Test):
    def test_corrects_what_the_diagnosis_finds(self):
        bonder = mjdiag.Machine(BONDER)
        worn = bonder.with_faults(eta_x=0.7)
        found = bonder.tolerate(worn, linear=True, duration=0.3)
        (name, done), = found.faults.items()
        self.assertEqual((name, done.action), ("eta_x", "drive gain of x"))
        self.assertAlmostEqual(done.value, 0.7, 3)
        self.assertTrue(done.acting)
        self.assertIsNone(done.until)
        gain = found.gains["x"]
        self.assertAlmostEqual(gain.gain, 1 / 0.7, 2)
        self.assertTrue(gain.least < gain.gain < gain.most)
        self.assertEqual(found.gains["y"].gain, 1.0)
        self.assertLess(found.largest_loop_radius, 1.0)
        self.assertTrue(found.diagnosis.faults["eta_x"].detected)
        self.assertIn("drive gain of x", found._repr_html_())
        self.assertIn("eta_x", repr(found))
        # As long as nothing is certain it is the run without.
        plain = worn.simulate(linear=True, duration=0.3)
        first = int(done.since / bonder.sample_time)
        np.testing.assert_array_equal(found.record["u_x"][:first], plain["u_x"][:first])
        self.assertGreater(abs(found.record["u_x"] - plain["u_x"]).max(), 0.0)

        late = {"linear": True, "duration": 0.3, "late_faults": [("eta_x", 0.7, 0.299)]}
        calm = bonder.tolerate(**late)
        self.assertEqual(calm.faults, {})
        self.assertIn("nothing to correct", repr(calm))
        self.assertIn("Nothing to correct", calm._repr_html_())
        np.testing.assert_array_equal(calm.record["x"], bonder.simulate(**late)["x"])

    @unittest.skipUnless(COMMAND, "needs the command, $MJDIAG_COMMAND")
    def test_does_what_the_command_does(self):
        bonder = mjdiag.Machine(BONDER)
        found = bonder.tolerate(bonder.with_faults(eta_x=0.7, gamma=0.5), linear=True,
                                duration=0.3, seed=2)
        told = said("simulate", "--setup", BONDER, "--linear", "--fault", "eta_x=0.7",
                    "--fault", "gamma=0.5", "--duration", "0.3", "--seed", "2",
                    "--tolerate", "--out", "run")
        self.assertEqual(found.to_dict(), told["tolerance"])
        self.assertEqual(found.diagnosis.to_dict(), told["diagnosis"])
        record = mjdiag.Record.read("run/record.csv")
        for name in record:
            np.testing.assert_array_equal(record[name], found.record[name])

    def test_refuses_what_cannot_be_corrected(self):
        bonder, coil = mjdiag.Machine(BONDER), voice_coil()
        self.assertRefuses(lambda: bonder.tolerate("worn"), "str")
        self.assertRefuses(lambda: bonder.tolerate(coil), "axes")
        self.assertRefuses(lambda: bonder.tolerate(late_faults=[("eta_q", 0.7, 0.1)]),
                           "eta_q")
        self.assertRefuses(lambda: bonder.tolerate(mode="x"), "'x'")
        self.assertRefuses(lambda: bonder.with_faults(gamma=0.1).tolerate(), "gamma")
        self.assertRefuses(lambda: coil.tolerate(replay=current(0.1)), "axes")
        unseen = mjdiag.Machine(os.path.join(MJCF, "emps"))
        self.assertRefuses(lambda: unseen.tolerate(duration=0.1), "twin")


class ExciteJointsTest(Test):
    def setUp(self):
        super().setUp()
        self.arm = mjdiag.Machine(arm())
        self.record = self.arm.simulate(seed=1)

    def test_tells_numbers_apart_better_within_the_limits(self):
        design = self.arm.excite_joints(
            self.record, limits={"elbow": {"velocity": 3.0}}, budget=2)
        self.assertLess(design.condition_after, design.condition_before)
        # Of a planar arm: an inertia and two moments of each link, two frictions of each
        # joint and the elbow's rotor.
        self.assertEqual(len(design.numbers), 3 * 2 + 2 * 2 + 1)
        for of_all in (design.units, design.sd_before, design.sd_after):
            self.assertEqual(len(of_all), len(design.numbers))
        self.assertEqual(design.joints, ["shoulder", "elbow"])
        self.assertEqual(design.position.shape, (2, len(self.record["q1"])))
        np.testing.assert_array_equal(design.record["elbow"], design.position[1])
        self.assertEqual(design.record.units["elbow"], "rad")
        self.assertLessEqual(design.peaks["elbow"]["velocity"], 3.01)
        self.assertEqual(design.limits["elbow"]["velocity"], 3.0)
        self.assertEqual(design.to_dict()["schema"], "mjdiag.joint_excitation/1")
        self.assertIn("condition number", design.verdict)
        self.assertIn("damping@elbow", design._repr_html_())
        design.report("next.html")
        self.assertGreater(os.path.getsize("next.html"), 10000)

    def test_refuses_what_it_cannot_keep(self):
        excite = self.arm.excite_joints
        self.assertRefuses(lambda: excite(self.record, limits={"wrist": {"force": 1}}),
                           "shoulder, elbow")
        self.assertRefuses(lambda: excite(self.record, limits={"elbow": {"snap": 1}}),
                           "snap")
        self.assertRefuses(lambda: excite(self.record, budget=0), "budget")
        self.assertRefuses(lambda: excite(3), "int")


if __name__ == "__main__":
    unittest.main()
