"""Machines: how they are made, runs like the command's, the linear model, bad input."""

import json
import os
import subprocess
import unittest

import numpy as np

import mjdiag
from support import COMMAND, MJCF, Test, current, voice_coil

BONDER = os.path.join(MJCF, "ab383")
SLIDE = """
<mujoco>
  <option timestep="0.001"/>
  <worldbody>
    <body><joint name="slide" type="slide" axis="1 0 0" stiffness="100" damping="2"/>
      <geom type="box" size="0.1 0.1 0.02" mass="1"/></body>
  </worldbody>
  <actuator><motor name="force" joint="slide"/></actuator>
  <sensor><jointpos name="position" joint="slide"/></sensor>
</mujoco>
"""


class MachineTest(Test):
    @unittest.skipUnless(COMMAND, "needs the command, $MJDIAG_COMMAND")
    def test_simulates_what_the_command_does_bitwise(self):
        record = (mjdiag.Machine(BONDER).with_faults(zeta_x=1.2)
                  .with_effect("coulomb_friction@X", force=2)
                  .simulate(seed=7, duration=0.1))
        subprocess.run(
            [COMMAND, "simulate", "--setup", BONDER, "--fault", "zeta_x=1.2",
             "--effect", "coulomb_friction@X:force=2", "--seed", "7",
             "--duration", "0.1", "--out", "run"],
            check=True, stdout=subprocess.DEVNULL)
        theirs = mjdiag.Record.read("run/record.csv")
        self.assertEqual(list(theirs), list(record))
        self.assertEqual(theirs.units, record.units)
        for name in record:
            np.testing.assert_array_equal(theirs[name], record[name])

    @unittest.skipUnless(COMMAND, "needs the command, $MJDIAG_COMMAND")
    def test_linearises_as_the_command_does(self):
        said = json.loads(subprocess.run(
            [COMMAND, "linearize", "--setup", BONDER, "--json"], check=True,
            capture_output=True, text=True).stdout)
        linear = mjdiag.Machine(BONDER).linearize()
        for name in ("M", "D", "K", "Gamma", "b"):
            np.testing.assert_array_equal(getattr(linear, name), said[name])
        self.assertEqual(linear.coordinates, said["coordinates"])
        self.assertEqual(linear.modes[0].frequency, said["modes"][0]["frequency"])

    def test_its_tick_is_the_plant_that_is_simulated(self):
        coil = voice_coil(set={"sensors.x.noise_sd": 0.0})
        system = coil.linearize().state_space()
        self.assertEqual(system.dt, coil.sample_time)
        push = current(0.2)
        state, readings = np.zeros(len(system.A)), []
        for value in push["i"]:
            readings.append((system.C @ state)[0])
            state = system.A @ state + system.B[:, 0] * value
        simulated = coil.simulate(replay=push)["x"]
        np.testing.assert_allclose(simulated, readings, atol=1e-9 * abs(simulated).max())

    def test_scipy_takes_its_state_space(self):
        try:
            from scipy import signal
        except ImportError:
            self.skipTest("needs scipy")
        linear = voice_coil().linearize()
        push = current(0.1)
        _, readings, _ = signal.dlsim(linear.state_space(), push["i"])
        self.assertEqual(readings.shape, (push.samples, 1))
        continuous = linear.state_space(continuous=True)
        self.assertIsNone(continuous.dt)
        poles = np.linalg.eigvals(continuous.A)
        self.assertAlmostEqual(abs(poles[0]) / (2 * np.pi), linear.modes[0].frequency, 6)

    def test_matrices_are_views_that_outlive_their_model(self):
        inertia = voice_coil().linearize().M
        self.assertFalse(inertia.flags.writeable)
        self.assertAlmostEqual(inertia[0, 0], 0.12)

    def test_the_same_seed_gives_the_same_bits(self):
        coil, push = voice_coil(), current(0.1)
        one, same = (coil.simulate(replay=push, seed=4)["x"] for _ in range(2))
        np.testing.assert_array_equal(one, same)
        self.assertTrue((one != coil.simulate(replay=push, seed=5)["x"]).any())

    def test_changing_one_leaves_the_other(self):
        coil = voice_coil()
        worn = coil.with_faults(zeta=1.5).with_faults(zeta=1.2, beta=0.9)
        self.assertEqual(worn.faults, {"zeta": 1.2, "beta": 0.9})
        self.assertEqual(coil.faults, {})
        once = coil.with_faults(beta=0.9, zeta=1.2)
        push = current(0.05)
        np.testing.assert_array_equal(worn.simulate(replay=push)["x"],
                                      once.simulate(replay=push)["x"])
        stiff = coil.with_effect("cubic_stiffness@stage:coefficient=4e6")
        self.assertEqual(stiff.effects, ["cubic_stiffness@stage:coefficient=4e+06"])

    def test_disturbances_are_part_of_a_run(self):
        bonder = mjdiag.Machine(BONDER)
        shaken = bonder.with_faults(gamma=0.5)
        calm, moved = (one.simulate(duration=0.02, noise=0.0)["x"]
                       for one in (bonder, shaken))
        self.assertGreater(abs(moved - calm).max(), 0.0)
        self.assertRefuses(lambda: shaken.diagnose(None), "gamma")

    def test_late_faults_act_from_their_time_on(self):
        coil, push = voice_coil(), current(0.2)
        run = coil.simulate(replay=push, late_faults=[("eta", 0.5, 0.1)])["x"]
        whole = coil.simulate(replay=push)["x"]
        np.testing.assert_array_equal(run[:500], whole[:500])
        self.assertGreater(abs(run - whole).max(), 1e-5)

    def test_is_written_with_what_was_put_in(self):
        push = current(0.1)
        worn = (voice_coil().with_faults(zeta=1.2)
                .with_effect("cubic_stiffness@stage", coefficient=4e6))
        self.assertEqual(worn.write("worn"), "worn/plant.xml")
        np.testing.assert_array_equal(
            mjdiag.Machine("worn").simulate(replay=push)["x"],
            worn.simulate(replay=push)["x"])
        mjdiag.Machine(SLIDE).with_effect("coulomb_friction@slide", force=1).write("rub")
        self.assertEqual(mjdiag.Machine("rub").sensors, ["position"])

    def test_is_made_of_mjcf_alone(self):
        with open("slide.xml", "w") as file:
            file.write(SLIDE)
        push = mjdiag.Record({"force": np.ones(100)}, {"force": "N"}, 1e-3)
        runs = []
        for source in (SLIDE, "slide.xml"):
            machine = mjdiag.Machine(source, set={"sensors.position.noise_sd": 1e-9})
            self.assertEqual((machine.sensors, machine.actuators),
                             (["position"], ["force"]))
            runs.append(machine.simulate(replay=push))
        self.assertEqual(runs[0].units["position"], "m")
        np.testing.assert_array_equal(runs[0]["position"], runs[1]["position"])

    def test_takes_another_plant(self):
        with open(os.path.join(MJCF, "voice_coil", "plant.xml")) as file:
            softer = file.read().replace('stiffness="900"', 'stiffness="450"')
        machine = voice_coil(plant=softer)
        self.assertAlmostEqual(machine.linearize().K[0, 0], 450.0)

    def test_reads_files_as_loggers_leave_them(self):
        push = current(0.5)
        run = voice_coil().simulate(replay=push)
        with open("logged.csv", "w") as file:
            file.write("time [ms],i [mA],x [um]\n")
            for k, (i, x) in enumerate(zip(run["i"], run["x"])):
                reading = "" if k == 700 else repr(1e6 * x)
                file.write(f"{k / 5},{1e3 * i!r},{reading}\n")
        with self.assertWarns(UserWarning):
            read = voice_coil().read("logged.csv")
        self.assertEqual(read.units, run.units)
        self.assertEqual(read.sample_time, run.sample_time)
        self.assertFalse(read.measured["x"][700])
        known = read.measured["x"]
        np.testing.assert_allclose(read["x"][known], run["x"][known], rtol=1e-12)

    def test_keys_of_the_setup_are_set(self):
        machine = voice_coil(set={"name": 'a "new" one', "rates": {"substeps": 2},
                                  "sensors.x.noise_sd": np.float64(1e-6)})
        self.assertEqual(machine.name, 'a "new" one')
        self.assertRefuses(lambda: voice_coil(set={"rates.subtseps": 2}), "subtseps")
        self.assertRefuses(lambda: voice_coil(set={"name": object()}), "name", "object")
        self.assertRefuses(lambda: voice_coil(set=["name"]), "list")

    def test_refuses_what_there_is_not(self):
        coil, push = voice_coil(), current(0.01)
        self.assertRefuses(lambda: mjdiag.Machine("nowhere"), "nowhere")
        self.assertRefuses(lambda: mjdiag.Machine(3), "int")
        self.assertRefuses(lambda: mjdiag.Machine("<mujoco>"), "plant.xml")
        self.assertRefuses(lambda: coil.with_faults(zeta_q=1.1), "zeta_q", "zeta")
        self.assertRefuses(lambda: coil.with_faults(zeta="big"), "zeta", "str")
        self.assertRefuses(lambda: coil.with_faults(zeta=float("nan")), "zeta")
        self.assertRefuses(lambda: coil.with_effect("coulomb_friction@Q", force=1), "Q")
        self.assertRefuses(lambda: coil.with_effect("glue@stage", force=1), "glue")
        self.assertRefuses(lambda: coil.with_effect("coulomb_friction@stage", fors=1),
                           "fors")
        self.assertRefuses(lambda: coil.with_effect("coulomb_friction", force=1), "<site>")
        self.assertRefuses(lambda: coil.simulate(), "replay")
        self.assertRefuses(lambda: coil.simulate(replay=[1]), "list")
        self.assertRefuses(lambda: coil.simulate(replay=push, mode="x"), "'x'")
        self.assertRefuses(lambda: coil.simulate(replay=push, noise=-1), "noise")
        self.assertRefuses(lambda: coil.simulate(replay=push, duration=0), "duration")
        slow = mjdiag.Record({"i": [0.0, 0.0]}, {"i": "A"}, 1.0)
        self.assertRefuses(lambda: coil.simulate(replay=slow), "sample time")
        volts = mjdiag.Record({"i": [0.0, 0.0]}, {"i": "V"}, 1 / 5000)
        self.assertRefuses(lambda: coil.simulate(replay=volts), "V", "A")

    def test_renders_machines_and_records(self):
        coil, push = voice_coil(), current(0.02)
        small = {"width": 320, "height": 240, "speed": 0.05, "duration": 0.02}
        told = coil.render(coil.with_faults(eta=0.5), "a.mp4", replay=push, **small)
        self.assertEqual(told["frames"], 12)
        coil.render(coil.simulate(replay=push), "b.mp4", **small)
        for name in ("a.mp4", "b.mp4"):
            self.assertGreater(os.path.getsize(name), 1000)
        self.assertRefuses(lambda: coil.render(None, "a.avi", replay=push), "a.avi")
        self.assertRefuses(lambda: coil.render("worn", "a.mp4", replay=push), "str")

    def test_divergence_is_a_numerical_error(self):
        runaway = mjdiag.Machine(BONDER, set={"axes.x.drive_gain": -50.0})
        with self.assertRaises(mjdiag.NumericalError) as caught:
            runaway.simulate(duration=0.5)
        self.assertIsInstance(caught.exception, ArithmeticError)
        self.assertTrue(issubclass(mjdiag.InputError, ValueError))


if __name__ == "__main__":
    unittest.main()
