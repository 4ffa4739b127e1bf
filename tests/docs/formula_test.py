"""Formulas of the theory as the site typesets them."""

import os
import re
import sys
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "docs", "site"))

import formula  # noqa: E402


class Formula(unittest.TestCase):
    def test_powers_and_indices_take_what_belongs_to_them(self):
        self.assertEqual(formula.tex("(G^T G)^-1 M_k"), "(G^{T} G)^{-1} M_{k}")
        self.assertEqual(formula.tex("C A^(i-k-1)"), "C A^{i-k-1}")
        self.assertEqual(formula.tex("N_x,k"), "N_{x,k}")
        self.assertEqual(formula.tex("sum_{i>k} n_i"), r"\sum_{i>k} n_{i}")

    def test_words_stay_words_and_symbols_become_symbols(self):
        self.assertEqual(formula.tex("Gamma u >= 1e-3"), r"\Gamma u \ge  1\cdot 10^{-3}")
        self.assertIn(r"\text{subject}", formula.tex("min a   subject to   b = 0"))
        self.assertEqual(formula.tex("x+ = A x"), "{x^{+}} = A x")

    def test_names_of_things_stay_code(self):
        for name in ("frictionloss", "plugin/plant/linearize.h", "mjdiag linearize --compare",
                     "centre_x@link", "efc_D"):
            self.assertFalse(formula.is_formula(name), name)
        for name in ("M q''", "theta0", "sqrt(1 + 1/n)", "dN = -N dH H^+"):
            self.assertTrue(formula.is_formula(name), name)

    def test_braces_of_every_formula_of_the_theory_close(self):
        with open(os.path.join(ROOT, "docs", "theory.md"), encoding="utf-8") as file:
            lines = re.findall(r"^    (.*)$", file.read(), re.MULTILINE)
        self.assertGreater(len(lines), 40)
        for line in lines:
            text = re.sub(r"\\[{}]", "", formula.tex(line))
            self.assertEqual(text.count("{"), text.count("}"), line)
            self.assertNotRegex(text, r"\}\^\{[^{}]*\}\^", line)  # two exponents


if __name__ == "__main__":
    unittest.main()
