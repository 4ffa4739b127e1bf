"""Prefilters: what a unit of a fault leaves in the residual."""

import mpmath

from .common import SHAKEN, Row, Shaker, matrix, mpf, spread_of, still
from .estimation import faults_of_plant, mp_of
from .filters import (DELTA, Bank, Stack, bank_of, bonder, butterworth, delta_form,
                      designed, noise_covariance)

PART = "Filters"
FREQUENCIES = (2, 10, 30, 60, 150, 400, 1200)
NOISE = [2e-8] * 3
FAULTS = ("zeta_x", "eta_z")


def stacked(*parts):
    """Numerators of several filters as those of one bank."""
    return [matrix([row for part in parts for row in part[k].tolist()])
            for k in range(len(parts[0]))]


def combined(weights, relations):
    return [weights * N for N in relations]


def nearest(rows, relations):
    """The combination of relations nearest to the residual in the metric of its noise:
    first made orthonormal, or their noise would lose what it has of digits."""
    root = mpmath.cholesky(mp_of(noise_covariance(bank_of(relations, 7, 50), NOISE)))
    relations = combined(mpmath.inverse(root), relations)
    joint = mp_of(noise_covariance(bank_of(stacked(rows, relations), 7, 50), NOISE))
    weights = joint[:1, 1:] * mpmath.inverse(joint[1:, 1:])
    return combined(weights, relations)


def response(numerators, f):
    """Of every signal, behind the denominator of the residual."""
    p = (mpmath.expjpi(2 * mpf(f) / 8000) - 1) / DELTA
    feedback, gain = butterworth(7, 50, mpf(1) / 8000)
    q = p * DELTA / gain
    d = (gain / DELTA) ** 7 * (q ** 7 + sum(a * q ** k for k, a in enumerate(feedback)))
    total = sum((N * p ** k for k, N in enumerate(numerators)),
                mpmath.zeros(1, numerators[0].cols))
    return list(total / d)


def printed_response(bank, output, f):
    z = mpmath.expjpi(2 * mpf(f) / 8000)
    return [mpmath.polyval(bank.numerator(output, i), z)
            / mpmath.polyval(bank.denominator(), z) for i in range(6)]


def slopes(rows, shake=still):
    """Of two faults, by machines with a little less and more of them: responses."""
    M, D, K, Gamma, b = bonder()
    names = designed()["faults"]
    answers = []
    for name in FAULTS:
        kind, d, k, gamma = faults_of_plant(D, Gamma)[names.index(name)]
        c = mpf(0.01 if kind == "stiffness" else 1e-3)
        less, more = (nearest(rows, Stack(*delta_form(
            M, D + change * d, K + change * k, Gamma + change * gamma, b),
            len(rows) - 1, shake).relations()) for change in (-c, c))
        slope = [(x - y) / (2 * c) for x, y in zip(less, more)]
        answers.append([response(slope, f) for f in FREQUENCIES])
    return answers


def derivatives():
    """Phi = -dR / df (docs/theory.md, Prefilters)."""
    design = designed()
    bank = Bank(design["filters"])
    rows = [matrix(part) for part in design["rows"]]
    ours = [[printed_response(bank, 1 + design["faults"].index(name), f)
             for f in FREQUENCIES] for name in FAULTS]
    exact = slopes(rows)
    # A signal that a fault does not change has none: beside the residual's response.
    residual = [response(rows, f) for f in FREQUENCIES]
    scale = [[[max(abs(row[j]) for row in one + residual) for j in range(6)]] * len(one)
             for one in exact]
    shaken = [slopes(rows, Shaker(seed)) for seed in range(2)]
    return [Row(PART, "prefilters of zeta_x and eta_z, at 7 frequencies",
                "`design`: `filters`", "null spaces of worn machines in 50 digits", ours,
                exact, spread_of(shaken, exact, scale), SHAKEN, scale=scale)]


ROWS = [derivatives]
