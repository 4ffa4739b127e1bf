"""The linear model about rest, its modes, and the map of a control tick."""

import mpmath
import numpy as np
import scipy.linalg

from .common import MJCF, SHAKEN, Row, ask, condition_of, matrix, mpf, setup_of
from .mechanics import Mechanics, tick_map

PART = "Linear model"
# Of the central difference of sixth order over steps of 1e-2 (plugin/plant/linearize.cc):
# sum of its weights over its divisor.
QUOTIENT = 2 * (45 + 9 + 1) / (60 * 1e-2)


def in_unit_mass(A, mass, columns=False):
    """Rows, and columns too, over the roots of the masses."""
    root = [mpmath.sqrt(mass[i, i]) for i in range(mass.rows)]
    return [A[i, j] / root[i] / (root[j] if columns else 1)
            for i in range(A.rows) for j in range(A.cols)]


def bonder_matrices():
    said = ask("linearize", "--setup", MJCF / "ab383")
    own = Mechanics(MJCF / "ab383" / "plant.xml")
    q = own.rest()
    M = own.mass(q)
    source, reference = "`linearize --setup mjcf/ab383`", \
        "rigid bodies of plant.xml in 50 digits"
    mass = in_unit_mass(M, M, True)
    # MuJoCo sums moments, of weights and of inertia, about the centre of the tree: places
    # in the world are within 0.2 m of it.
    lever = 0.2
    hinges = [i for i in range(M.rows) if own.joints[i]["hinge"]]
    rows = [Row(PART, "inertia M of the bonder", source, reference,
                in_unit_mass(matrix(said["M"]), M, True), mass,
                max(own.carried(i) * lever ** 2 / M[i, i] for i in hinges),
                "carried mass times (0.2 m)^2 over the inertia of a hinge", scale=1)]
    rows.append(Row(PART, "dampers D", source, reference, said["D"], own.dampers(), 1.0,
                    "read, not computed"))
    K = own.weight_stiffness(q)
    geometric = in_unit_mass(K, M, True)
    largest = max(abs(x) for x in geometric)
    moment = own.bodies[-1]["mass"] * 9.81 * lever / M[9, 9]
    ours = matrix(said["K"]) - own.springs()
    rows.append(Row(PART, "gravity's part of the stiffness K", source, reference,
                    in_unit_mass(ours, M, True), geometric,
                    float(QUOTIENT * moment / largest),
                    "weights of the difference quotient times the moment of the arm's "
                    "weight, 0.2 m, over the stiffness",
                    # What is printed has the springs in it.
                    scale=[abs(x) + largest for x in
                           in_unit_mass(matrix(said["K"]), M, True)]))
    # A port's column of unit masses, its largest part as scale.
    for what, key, own_matrix, factor in (
            ("forces Gamma of the motors", "Gamma", own.inputs(q), 1.0),
            ("derivatives b of the readings", "b",
             own.outputs(q, {"x_encoder": 0, "y_encoder": 1}), QUOTIENT)):
        scale, condition = [], 1.0
        for j in range(own_matrix.cols):
            column = in_unit_mass(own_matrix[:, j], M)
            scale.append(max(abs(x) for x in column))
            unit = max(lever / mpmath.sqrt(M[i, i]) for i in hinges
                       if abs(own_matrix[i, j]) > mpf(10) ** -25)
            condition = max(condition, float(factor * unit / scale[-1]))
        rows.append(Row(PART, what, source, reference,
                        in_unit_mass(matrix(said[key]), M), in_unit_mass(own_matrix, M),
                        condition, "levers of 0.2 m over the largest part of a column"
                        + (", times the weights of the difference quotient"
                           if factor > 1 else ""), scale=scale * M.rows))
    return rows


def model_of(said):
    return [matrix(said[name]) for name in ("M", "D", "K", "Gamma")]


def modes():
    """Modes of the printed matrices: eigenvalues of the first-order form in 50 digits."""
    said = ask("linearize", "--setup", MJCF / "ab383")
    M, D, K, _ = model_of(said)
    n = M.rows
    root = mpmath.cholesky(M)
    inverse = mpmath.inverse(root)
    k, d = inverse * K * inverse.T, inverse * D * inverse.T
    unit = 1 / mpmath.sqrt(mpmath.mnorm(k, "f"))
    A = mpmath.matrix(2 * n, 2 * n)
    for i in range(n):
        A[i, n + i] = 1
        for j in range(n):
            A[n + i, j], A[n + i, n + j] = -unit ** 2 * k[i, j], -unit * d[i, j]
    with mpmath.workdps(34):
        values, left, right = mpmath.eig(A, left=True, right=True)
    norm = mpmath.mnorm(A, "f")
    found, condition = [], 1.0
    for i, value in enumerate(values):
        if abs(value) < mpf(10) ** -7 or value.imag < -mpf(10) ** -25 * abs(value):
            continue
        found.append((abs(value) / (2 * mpmath.pi * unit), -value.real / abs(value)))
        y, x = left[i, :], right[:, i]
        condition = max(condition, float(norm * mpmath.norm(y) * mpmath.norm(x)
                                         / (abs((y * x)[0]) * abs(value))))
    found.sort(key=lambda mode: mode[0])
    ours = [(mode["frequency"], mode["damping_ratio"]) for mode in said["modes"]]
    scale = [(f, 1) for f, _ in found]
    return [Row(PART, "modes: frequencies and damping ratios", "`linearize`",
                "mpmath.eig of the printed matrices", ours, found, condition,
                "norm of A over |lambda|, times that of the eigenvectors", scale=scale)]


def tick():
    """state_space() beside the power of a step in 50 digits."""
    import mjdiag
    rows = []
    for name in ("ab383", "voice_coil"):
        linear = mjdiag.Machine(str(MJCF / name)).linearize()
        rates = setup_of(name)["rates"]
        substeps = rates["substeps"]
        step = mpf(1 / rates["control"] / substeps)
        arguments = [matrix(x) for x in (linear.M, linear.D, linear.K, linear.Gamma)]
        A, B = tick_map(*arguments, step, substeps)
        # Velocities times the tick beside positions, in coordinates of unit mass.
        weights = [mpmath.sqrt(arguments[0][i, i]) for i in range(A.rows // 2)]
        weights += [w * step * substeps for w in weights]

        def scaled(A, B, w=weights):
            n = len(w)
            return [[w[i] * A[i, j] / w[j] for i in range(n) for j in range(n)],
                    [w[i] * B[i, j] for i in range(n) for j in range(B.cols)]]

        theirs = scaled(A, B)
        scale = [[max(map(abs, part))] * len(part) for part in theirs]
        condition = condition_of(
            lambda shake: scaled(*tick_map(*map(shake, arguments), step, substeps, shake)),
            theirs, scale)
        said = linear.state_space()
        rows.append(Row(PART, f"map of a control tick, {substeps} steps, {name}",
                        "`Machine.linearize().state_space()`",
                        "power of the step's matrix in 50 digits",
                        scaled(matrix(said.A), matrix(said.B)), theirs, condition, SHAKEN,
                        scale=scale))
        rows.append(continuous(linear, name, arguments))
    return rows


def continuous(linear, name, arguments):
    """The same without ticks."""
    M, D, K, Gamma = arguments
    n = M.rows
    inverse = mpmath.inverse(M)
    root = [mpmath.sqrt(M[i, i]) for i in range(n)]

    def scaled(parts):
        return [[root[i] * part[i, j] / (root[j] if part.cols == n else 1)
                 for i in range(n) for j in range(part.cols)] for part in parts]

    said = linear.state_space(continuous=True)
    A, B = matrix(said.A), matrix(said.B)
    theirs = scaled([-inverse * K, -inverse * D, inverse * Gamma])
    scale = [[max(map(abs, part))] * len(part) for part in theirs]
    # Of the masses, over those of the joints alone.
    even = mpmath.matrix(n, n)
    for i in range(n):
        for j in range(n):
            even[i, j] = M[i, j] / root[i] / root[j]
    condition = mpmath.mnorm(even, "f") * mpmath.mnorm(mpmath.inverse(even), "f")
    return Row(PART, f"continuous state space, {name}",
               "`Machine.linearize().state_space(continuous=True)`",
               "inverse of M in 50 digits",
               scaled([A[n:, :n], A[n:, n:], B[n:, :]]), theirs, condition,
               "of M, its norm times that of its inverse", scale=scale)


def closed_loop():
    """Largest eigenvalue of the loop of the printed matrices and the setup's feedback."""
    said = ask("linearize", "--setup", MJCF / "ab383")
    setup = setup_of("ab383")
    M, D, K, Gamma = model_of(said)
    A, B = tick_map(M, D, K, Gamma, mpf(1) / 32000, 4)
    C = matrix(said["b"]).T
    n = M.rows
    orders = [len(axis["feedback"]["denominator"]) - 1 for axis in setup["axes"].values()]
    closed = mpmath.zeros(2 * n + sum(orders))
    closed[:2 * n, :2 * n] = A
    first = 2 * n
    for j, (axis, order) in enumerate(zip(setup["axes"].values(), orders)):
        a = [mpf(x) for x in axis["feedback"]["denominator"]]
        b = [mpf(x) for x in axis["feedback"]["numerator"]]
        gain = mpf(axis["drive_gain"])
        # States of a chain of delays, observable form: the error drives all of them.
        drive = [b[i + 1] - a[i + 1] * b[0] for i in range(order)]
        for i in range(2 * n):
            for k in range(n):
                closed[i, k] -= gain * B[i, j] * b[0] * C[j, k]
            closed[i, first] += gain * B[i, j]
        for i in range(order):
            for k in range(n):
                closed[first + i, k] -= drive[i] * C[j, k]
            closed[first + i, first] -= a[i + 1]
            if i + 1 < order:
                closed[first + i, first + i + 1] += 1
        first += order
    with mpmath.workdps(34):
        values, left, right = mpmath.eig(closed, left=True, right=True)
    i = max(range(len(values)), key=lambda k: abs(values[k]))
    y, x = left[i, :], right[:, i]
    # In units of its own, as balancing finds them.
    _, (units, _) = scipy.linalg.matrix_balance(
        np.array(closed.tolist(), float), permute=False, separate=True)
    units = [mpf(u) for u in units]
    norm = mpmath.norm([units[c] / units[r] * closed[r, c] for r in range(closed.rows)
                        for c in range(closed.cols)])
    condition = norm * mpmath.norm([y[r] * units[r] for r in range(len(units))]) \
        * mpmath.norm([x[r] / units[r] for r in range(len(units))]) \
        / (abs((y * x)[0]) * abs(values[i]))
    return [Row(PART, "largest eigenvalue of the closed loop",
                "`linearize`: `closed_loop.largest_eigenvalue`",
                "mpmath.eig of an own loop", said["closed_loop"]["largest_eigenvalue"],
                abs(values[i]), condition,
                "norm of the loop's matrix, balanced, over the eigenvalue, times those of "
                "the eigenvectors")]


ROWS = [bonder_matrices, modes, tick, closed_loop]
