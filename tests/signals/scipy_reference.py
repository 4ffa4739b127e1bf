"""Reference values from SciPy for the tests of signals/.

Prints one array a line, `name rows columns v11 v12 ... `, row by row, with 17
significant digits. The inputs are printed too, so that the tests use the same.
"""

import numpy as np
from scipy import signal


def show(name, values):
    values = np.atleast_2d(np.asarray(values, dtype=float))
    numbers = " ".join(f"{v:.17g}" for v in values.ravel())
    print(name, values.shape[0], values.shape[1], numbers)


def butterworth():
    cases = [("low", 4, 100.0, 1000.0), ("low", 7, 50.0, 8000.0),
             ("high", 3, 100.0, 8000.0), ("high", 5, 900.0, 2000.0),
             ("low", 1, 10.0, 1000.0), ("low", 2, 499.0, 1000.0)]
    frequencies = np.array([0.01, 0.1, 0.5, 0.9, 1.0, 1.1])
    for i, (kind, order, cutoff, rate) in enumerate(cases):
        show(f"butter{i}.case", [kind == "high", order, cutoff, rate])
        b, a = signal.butter(order, 2 * np.pi * cutoff, kind, analog=True)
        show(f"butter{i}.continuous", [np.pad(b, (order + 1 - len(b), 0)), a])
        show(f"butter{i}.digital", signal.butter(order, cutoff, kind, fs=rate))
        sections = signal.butter(order, cutoff, kind, fs=rate, output="sos")
        points = np.minimum(frequencies * cutoff, 0.49 * rate)
        _, response = signal.sosfreqz(sections, points, fs=rate)
        show(f"butter{i}.frequencies", points)
        show(f"butter{i}.response", [response.real, response.imag])
    show("butter.cases", [len(cases)])


def filters_and_spectra(random):
    time = np.arange(1500) / 1000.0
    x = 0.3 + 2 * time + np.sin(2 * np.pi * 7 * time + 1) + random.normal(size=1500)
    show("filtfilt.input", x)
    for name, kind, order, cutoff in [("low4", "low", 4, 100.0), ("low7", "low", 7, 50.0),
                                      ("high3", "high", 3, 100.0)]:
        b, a = signal.butter(order, cutoff, kind, fs=1000.0)
        sections = signal.butter(order, cutoff, kind, fs=1000.0, output="sos")
        show(f"filtfilt.{name}", signal.sosfiltfilt(sections, x, padlen=3 * order))
        # The polynomial form is the one that other programs use.
        if order < 5:
            show(f"filtfilt.{name}.polynomial",
                 signal.filtfilt(b, a, x, padlen=3 * order))
    for segment, overlap in [(256, 128), (255, 100), (1500, 0)]:
        show(f"welch.{segment}", signal.welch(x, 1000.0, "hann", segment, overlap))
    show("gradient", np.gradient(x, 0.001, edge_order=2))


def simulation(random):
    """A stiff machine: three masses, springs up to 2 kHz, at 8 kHz."""
    mass = np.diag([50.0, 6.0, 0.3])
    stiffness = np.array([[2e7, -1.5e7, 0], [-1.5e7, 3.5e7, -2e7], [0, -2e7, 2.2e7]])
    damping = 2e-5 * stiffness
    inverse = np.linalg.inv(mass)
    A = np.block([[np.zeros((3, 3)), np.eye(3)],
                  [-inverse @ stiffness, -inverse @ damping]])
    B = np.vstack([np.zeros((3, 2)), inverse @ np.array([[1, 0], [-1, 1], [0, 0.2]])])
    C = np.array([[1, 0, 0, 0, 0, 0], [-1, 1, 0, 0, 0, 0], [0, 0, 0, 0, 0, 1.0]])
    D = np.array([[0, 0], [0, 0], [1e-3, 0]])
    u = random.normal(size=(400, 2))
    show("lti.input", u.T)
    for method in ("zoh", "bilinear"):
        Ad, Bd, Cd, Dd, T = signal.cont2discrete((A, B, C, D), 1 / 8000.0, method)
        for name, matrix in zip("ABCD", (Ad, Bd, Cd, Dd)):
            show(f"lti.{method}.{name}", matrix)
        _, y, _ = signal.dlsim((Ad, Bd, Cd, Dd, T), u, x0=np.arange(6) * 1e-6)
        show(f"lti.{method}.output", y.T)


if __name__ == "__main__":
    generator = np.random.default_rng(20240607)
    butterworth()
    filters_and_spectra(generator)
    simulation(generator)
