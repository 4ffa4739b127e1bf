"""effects.py beside an extended plant does what the effects of mjdiag do, to rounding.

effects_test.py PROGRAM: what writes extended plants and what their effects do along a motion
(extended_plants.cc). In the place of MuJoCo's Python package stand models and data that have
nothing but the fields that effects.py reads."""

import copy
import glob
import importlib.util
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np

PLANTS = ""  # folder of all of them

ROUNDING = 1e-12  # relative to what is largest along the motion
CHANGED = ("qpos0", "qpos_spring", "dof_frictionloss", "dof_solref", "dof_solimp")


class Fields:
    """A model, or data, as MuJoCo's package shows it; without a hash, as that may be."""

    __hash__ = None

    def __init__(self, fields):
        for name, value in fields.items():
            setattr(self, name, np.array(value) if isinstance(value, list) else value)


def model_of(fields):
    model = Fields(fields)
    model.names = bytes(code % 256 for code in fields["names"])
    model.opt = Fields({key: fields[key] for key in ("timestep", "integrator")})
    model.dof_solref = model.dof_solref.reshape(model.nv, -1)
    model.dof_solimp = model.dof_solimp.reshape(model.nv, -1)
    return model


def data_of(model):
    return Fields({"qfrc_passive": np.zeros(model.nv), "qfrc_applied": np.zeros(model.nv)})


def take(data, model, step):
    """The step as MuJoCo has it when it calls for passive forces."""
    for name, value in step.items():
        setattr(data, name, np.array(value) if isinstance(value, list) else value)
    data.actuator_moment = data.actuator_moment.reshape(model.nu, model.nv)


def load(folder):
    with open(os.path.join(folder, "steps.json"), encoding="utf-8") as file:
        return json.load(file)


def effects_of(folder):
    """The module that lies beside a plant; none beside one that needs none."""
    file = os.path.join(folder, "effects.py")
    if not os.path.exists(file):
        return None
    spec = importlib.util.spec_from_file_location("effects", file)
    effects = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(effects)
    # Known behind the passive forces only, for which effects.py asks MuJoCo.
    effects.bias_force = lambda model, data: data.qfrc_bias
    return effects


def plant(name):
    # Of a law, and none whose name ends as its.
    (folder,) = [f for f in glob.glob(os.path.join(PLANTS, name))
                 if re.fullmatch(name.replace("*", "[^_]*"), os.path.basename(f))]
    return folder, load(folder), effects_of(folder)


class Motion:
    """What effects.py makes of the steps of a plant."""

    def __init__(self, effects, run, before_step=lambda data: None):
        self.model = model_of(run["model"])
        effects.prepare(self.model)
        data = data_of(self.model)
        self.forces, self.bounds, self.readings = [], [], []
        for step in run["steps"]:
            take(data, self.model, step)
            before_step(data)
            effects.passive(self.model, data)
            self.forces.append(data.qfrc_passive - np.array(step["qfrc_passive"]))
            self.bounds.append(data.efc_frictionloss)
            readings = effects.distort(self.model, data)
            self.readings.append(readings[step["expected"]["sensors"]])


def expected(run, name):
    return np.array([step["expected"][name] for step in run["steps"]])


class EffectsFile(unittest.TestCase):
    def expect_close(self, got, want, scale, what):
        error = np.max(np.abs(np.array(got) - want), initial=0.0)
        self.assertLessEqual(error, ROUNDING * scale, what)

    def expect_same(self, effects, run, what):
        motion = Motion(effects, run)
        for name in CHANGED:
            want = np.array(run["prepared"][name])
            self.expect_close(np.ravel(getattr(motion.model, name)), want,
                              np.max(np.abs(want), initial=1e-300), f"{what}: {name}")
        force, drive, bounds = (expected(run, k) for k in ("force", "drive", "bounds"))
        passive = np.max(np.abs([step["qfrc_passive"] for step in run["steps"]]))
        # A force is what MuJoCo has with it, less what it has without.
        scale = np.max(np.abs(force)) + np.max(np.abs(drive)) + passive
        self.expect_close(motion.forces, force, scale, f"{what}: force")
        self.expect_close(motion.bounds, bounds, np.max(bounds, initial=0.0) + scale,
                          f"{what}: bound")
        readings = expected(run, "readings")
        self.expect_close(motion.readings, readings, np.max(np.abs(readings)),
                          f"{what}: reading")
        untouched = np.array([step["sensordata"] for step in run["steps"]])
        untouched = untouched[:, run["steps"][0]["expected"]["sensors"]]
        loss = np.array([step["efc_frictionloss"] for step in run["steps"]])
        zero = np.array(run["model"]["qpos0"]) - np.array(run["prepared"]["qpos0"])
        return any(np.any(x) for x in (force, bounds - loss, readings - untouched, zero))

    def test_does_what_every_effect_of_every_machine_does(self):
        acting = set()
        for folder in sorted(glob.glob(os.path.join(PLANTS, "*_*"))):
            run, effects = load(folder), effects_of(folder)
            if effects is None:
                continue
            acts = self.expect_same(effects, run, os.path.basename(folder))
            if len(run["effects"]) == 1 and acts:
                acting.add(run["effects"][0].split("@")[0])
        with open(os.path.join(PLANTS, "effects.json"), encoding="utf-8") as file:
            self.assertEqual(acting, set(json.load(file)))

    def test_knows_every_effect_that_a_plant_carries_with_all_its_values(self):
        _, _, effects = plant("ab383_all")
        with open(os.path.join(PLANTS, "effects.json"), encoding="utf-8") as file:
            known = {name: law[2] for name, law in effects.LAWS.items()}
            self.assertEqual(known, {**json.load(file), "encoder_noise": 1})

    def test_is_beside_plants_that_need_it_only(self):
        self.assertIsNone(plant("emps_*_coulomb_friction")[2])
        self.assertIsNotNone(plant("emps_*_force_offset")[2])

    def test_steps_once_however_often_a_step_is_evaluated(self):
        _, run, effects = plant("ab383_all")
        run["steps"] = [step for step in run["steps"] for _ in range(3)]
        self.expect_same(effects, run, "three times each")

    def test_begins_anew_when_the_time_goes_back_or_it_is_told_to(self):
        for name in ("emps_*_input_delay", "ab383_*_presliding_hysteresis"):
            _, run, effects = plant(name)
            twice = copy.deepcopy(run)
            twice["steps"] = run["steps"] + run["steps"]
            self.expect_same(effects, twice, name)
            self.expect_same(effects, run, name)
            # At every step told: as in its first step, whatever came before.
            always = Motion(effects, run, effects.reset).forces
            for k in (0, 7, 30):
                alone = dict(run, steps=[run["steps"][k]])
                np.testing.assert_array_equal(always[k], Motion(effects, alone).forces[0])

    def test_remembers_for_every_data_by_itself(self):
        _, run, effects = plant("ab383_*_bouc_wen")
        model = model_of(run["model"])
        effects.prepare(model)
        one, other = data_of(model), data_of(model)
        for step in run["steps"]:
            take(one, model, step)
            effects.passive(model, one)
            take(other, model, dict(step, qvel=[0.0] * model.nv))
            effects.passive(model, other)
            np.testing.assert_array_equal(other.qfrc_passive, step["qfrc_passive"])
        self.assertTrue(np.any(one.qfrc_passive != other.qfrc_passive))

    def test_reads_moments_of_actuators_as_newer_versions_keep_them(self):
        _, run, effects = plant("ab383_all")

        def sparse(data):
            dense = data.actuator_moment
            data.moment_rownnz = np.count_nonzero(dense, axis=1)
            data.moment_rowadr = np.cumsum(data.moment_rownnz) - data.moment_rownnz
            data.moment_colind = np.nonzero(dense)[1]
            data.actuator_moment = dense[dense != 0.0]

        np.testing.assert_array_equal(Motion(effects, run, sparse).forces,
                                      Motion(effects, run).forces)

    def test_sets_the_bounds_that_islands_are_solved_with(self):
        _, run, effects = plant("emps_*_stribeck_friction")
        islands = []

        def split(data):
            data.nisland = 1
            for name in ("type", "id", "frictionloss"):
                setattr(data, "iefc_" + name, getattr(data, "efc_" + name)[::-1].copy())
            islands.append(data.iefc_frictionloss)

        bounds = Motion(effects, run, split).bounds
        np.testing.assert_array_equal(islands, np.array(bounds)[:, ::-1])
        self.assertGreater(np.ptp(bounds), 0.0)

    def test_says_what_it_cannot_do(self):
        _, run, effects = plant("emps_*_input_delay")
        model = model_of(run["model"])
        with self.assertRaisesRegex(RuntimeError, "prepare"):
            effects.passive(model, data_of(model))
        model.opt.integrator = 1
        with self.assertRaisesRegex(ValueError, "input_delay.drive.*integrator"):
            effects.prepare(model)
        model.opt.integrator = 0
        model.actuator_dyntype[:] = 1
        with self.assertRaisesRegex(ValueError, "input_delay.drive.*dynamics"):
            effects.prepare(model)
        model = model_of(run["model"])
        model.names = model.names.replace(b"input_delay", b"inputxdelay")
        with self.assertRaisesRegex(ValueError, "inputxdelay.drive: no law"):
            effects.prepare(model)

    def test_prepares_a_model_once(self):
        _, run, effects = plant("emps_*_stribeck_friction")
        model = model_of(run["model"])
        effects.prepare(model)
        once = model.dof_frictionloss.copy()
        effects.prepare(model)
        np.testing.assert_array_equal(model.dof_frictionloss, once)


if __name__ == "__main__":
    program = sys.argv.pop(1)
    with tempfile.TemporaryDirectory(prefix="mjdiag-effects-") as PLANTS:
        subprocess.run([program, PLANTS], check=True)
        unittest.main()
