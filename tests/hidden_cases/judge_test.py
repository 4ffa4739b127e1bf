"""What scripts/bonder-cases calls right and wrong."""

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
from bonder_cases import judge  # noqa: E402

MOTOR = {"kinds": ["drive gain"], "sites": ["Y", "y_motor"],
         "effect": "motor_constant@y_motor:factor=0.985",
         "forms": [{"name": "motor_constant", "site": "y_motor", "values": {"factor": 0.985}},
                   {"name": "eta_y", "site": "", "values": {"factor": 0.985}},
                   {"name": "number", "site": "gear@y_motor", "values": {"factor": 0.985}}]}
RUBBER = {"kinds": ["compliance"], "sites": ["u1"], "effect": "", "forms": []}
STAGE = {"mass@x_stage": {"factor": 0.99, "sites": ["x_stage", "X"]}}


def answer(causes=(), numbers=(), kinds=(), gain=0.9):
    return {"causes": [{"effect": effect, "site": site, "probability": probability,
                        "parameters": {name: {"value": value, "ci95": None}
                                       for name, value in values.items()}}
                       for effect, site, probability, values in causes],
            "calibration": [{"name": name, "value": value, "off": off,
                             "ci95": [value - 0.001, value + 0.001]}
                            for name, value, off in numbers],
            "kinds": [{"kind": kind, "site": site, "probability": 0.9}
                      for kind, site in kinds],
            "gain": {"validation": gain}}


def truth(causes=(), numbers=None):
    return {"causes": list(causes), "numbers": numbers or {}}


class Judge(unittest.TestCase):
    def right(self, *words):
        return judge.judge(*words).right

    def test_nothing_is_right_where_nothing_is_hidden(self):
        self.assertTrue(self.right(answer(), truth()))

    def test_something_is_wrong_where_nothing_is_hidden(self):
        self.assertFalse(self.right(answer([("input_delay", "y_motor", 0.9, {"delay": 1e-4})]),
                                    truth()))
        self.assertFalse(self.right(answer(numbers=[("mass@arm", 1.1, True)]), truth()))
        self.assertFalse(self.right(answer(kinds=[("inertia", "X")]), truth()))

    def test_a_cause_may_be_said_as_effect_fault_or_number(self):
        for one in (answer([("motor_constant", "y_motor", 0.9, {"factor": 0.9851})]),
                    answer([("eta_y", "y_motor", 0.9, {"value": 0.9849})]),
                    answer(numbers=[("gear@y_motor", 0.985, True)])):
            self.assertTrue(self.right(one, truth([MOTOR])))

    def test_a_cause_needs_its_size_its_site_and_certainty(self):
        for effect in (("motor_constant", "y_motor", 0.9, {"factor": 0.97}),
                       ("motor_constant", "x_motor", 0.9, {"factor": 0.985}),
                       ("motor_constant", "y_motor", 0.2, {"factor": 0.985})):
            self.assertFalse(self.right(answer([effect]), truth([MOTOR])))

    def test_numbers_that_are_off_are_asked_for_up_to_the_scale_of_a_motor(self):
        motor = ("motor_constant", "y_motor", 0.9, {"factor": 0.985})
        self.assertFalse(self.right(answer([motor]), truth([MOTOR], STAGE)))
        for numbers in ([("mass@x_stage", 0.99, True)],
                        [("mass@x_stage", 1.0098, False), ("gear@x_motor", 1.02, False)]):
            self.assertTrue(self.right(answer([motor], numbers), truth([MOTOR], STAGE)))

    def test_a_number_may_be_said_as_the_fault_that_scales_it_alone(self):
        damper = {"damping@X": {"factor": 1.08, "sites": ["X"], "forms": [
            {"name": "zeta_x", "site": "", "values": {"factor": 1.08}}]}}
        for value, right in ((1.079, True), (1.02, False)):
            found = answer([("zeta_x", "X", 0.9, {"value": value})])
            self.assertEqual(self.right(found, truth([], damper)), right)
        found = answer([("zeta_y", "Y", 0.9, {"value": 1.08})])
        self.assertFalse(self.right(found, truth([], damper)))

    def test_a_damping_may_be_said_as_the_friction_that_there_is_more_of(self):
        damper = {"damping@Z": {"factor": 1.08, "sites": ["Z"], "forms": [
            {"name": "viscous_friction", "site": "Z", "values": {"coefficient": 2.3e-4}}]}}
        for value, right in ((2.33e-4, True), (3.3e-4, False)):
            found = answer([("viscous_friction", "Z", 0.9, {"coefficient": value})])
            self.assertEqual(self.right(found, truth([], damper)), right)

    def test_a_law_of_no_list_needs_kind_place_and_gain(self):
        kinds = [("compliance", "u1")]
        self.assertTrue(self.right(answer(kinds=kinds), truth([RUBBER])))
        self.assertFalse(self.right(answer(kinds=kinds, gain=0.5), truth([RUBBER])))
        self.assertFalse(self.right(answer(kinds=[("compliance", "u2")]), truth([RUBBER])))
        self.assertFalse(self.right(answer(kinds=[*kinds, ("delay", "X")]), truth([RUBBER])))

    def test_a_curve_at_its_place_is_not_false(self):
        verdict = judge.judge(answer(kinds=[("force without a name", "u1")]), truth([RUBBER]))
        self.assertFalse(verdict.false)
        self.assertFalse(verdict.kind)

    def test_a_phase_may_be_a_turn_off(self):
        self.assertTrue(judge.near("phase", 0.7 - 6.2832, None, 0.7, 0.05))


if __name__ == "__main__":
    unittest.main()
