"""Thresholds from healthy runs, and the disturbance analysis of a record."""

import functools

import numpy as np
import scipy.signal
import scipy.stats

from .common import LONG, MJCF, SHAKEN, Row, ask, condition_of, still
from .estimation import simulated
from .filters import Bank, signals_of

PART = "Thresholds"
BONDER = MJCF / "ab383"
RATE, SEGMENT = 8000, 2048
SHORT = ("--set", "trajectories.multi.duration=0.4", "--set",
         "trajectories.x.duration=0.3", "--set",
         'diagnosis.thresholds.trajectories=["x"]')
NEIGHBOURS, TONE = 32, 3  # bins each side of a local floor, and those a tone covers


@functools.lru_cache(maxsize=None)
def design_of_three():
    """A design whose healthy runs are two of the default motion and one of x, and these
    runs: seeds go up from 1001 (plugin/design/filter_design.h)."""
    design = ask("design", "--setup", BONDER, "--linear", "--nominal-runs", 2, *SHORT)
    runs = [simulated(*SHORT, "--seed", 1001), simulated(*SHORT, "--seed", 1002),
            simulated(*SHORT, "--trajectory", "x", "--seed", 1001)]
    return design, [signals_of(design, run) for run in runs]


def residual_limits(design, signals, shake=still):
    bank = Bank(design["filters"])
    residuals = [bank.chain([0], z, shake)[0] for z in signals]
    window = int(round(design["options"]["integral_window"] * RATE))
    highest = max(window_means(abs(r), window).max() for r in residuals)
    every = np.concatenate(residuals)
    mean = every.mean()
    return [2 * every.min(), 2 * every.max(), mean,
            np.sqrt(np.mean((every - mean) ** 2)), 2 * highest]


def window_means(level, window):
    """Over the last so many samples, of a record that begins with nothing."""
    total = np.cumsum(level)
    before = np.concatenate([np.zeros(window, level.dtype), total])[:len(total)]
    return (total - before) / window


def limits():
    design, signals = design_of_three()
    said = design["limits"]
    ours = [*said["residual"], said["fit"]["mean"], said["fit"]["sd"], said["integral"]]
    exact = residual_limits(design, signals)
    scale = [exact[3]] * 5  # all are of the residual's size
    edges = said["histogram"]["edges"]
    inside = np.concatenate([Bank(design["filters"]).chain([0], z)[0] for z in signals])
    # The extremes are on the edges.
    inside = np.clip(inside.astype(float), edges[0], edges[-1])
    counts, _ = np.histogram(inside, bins=edges)
    return [Row(PART, "limits of the residual, mean, sd, limit of its mean size",
                "`design`: `limits`", "own residuals of the same healthy runs", ours, exact,
                condition_of(lambda shake: residual_limits(design, signals, shake), exact,
                             scale), SHAKEN, scale=scale),
            Row(PART, "histogram of the residual", "`design`: `limits.histogram`",
                "numpy.histogram", said["histogram"]["count"], counts.tolist(), 1.0,
                "counts", scale=1)]


def disturbance_residual(design, z, shake=still):
    """Behind its high-pass."""
    raw = Bank(design["disturbance"]["filters"]).chain([0], z, shake)[0]
    sections = np.array([[*s[:3], 1.0, *s[3:]] for s in
                         design["disturbance"]["high_pass"]], LONG)
    return scipy.signal.sosfilt(sections, raw)


def welch(residual):
    return scipy.signal.welch(np.asarray(residual, float), RATE, "hann", SEGMENT)[1]


def degrees_of(segments):
    return 36 * segments ** 2 / (19 * segments - 1)


def segment_count(samples):
    return (samples - SEGMENT) // (SEGMENT // 2) + 1


def upper_median(values):
    return np.sort(values)[len(values) // 2]


def middle(values):
    return np.median(values)


def nominal_dof(lengths):
    return len(lengths) ** 2 / sum(1 / degrees_of(segment_count(n)) for n in lengths)


USED = slice(2, SEGMENT // 2)  # bins


def segment_noise(residual, nominal, dof, tones=()):
    """Level and power of every segment over what is nominal (docs/theory.md,
    Disturbances)."""
    bias = scipy.stats.f.isf(0.5, 2, dof)
    expected = np.maximum(nominal, 1e-30 * nominal.max())[USED]
    levels, powers = [], []
    for s in range(segment_count(len(residual))):
        part = np.asarray(residual[s * SEGMENT // 2:s * SEGMENT // 2 + SEGMENT], float)
        if len(tones):
            part = part - sines(tones, len(part)) @ fit_sines(part, tones)
        ratio = welch(part)[USED] / expected
        known = nominal[USED] >= 1e-12 * nominal[USED].max()
        levels.append(upper_median(ratio[known]) / bias)
        powers.append(sum(
            upper_median(ratio[k:k + 2 * NEIGHBOURS])
            * nominal[USED][k:k + 2 * NEIGHBOURS].sum()
            for k in range(0, len(ratio), 2 * NEIGHBOURS)) * RATE / SEGMENT / bias)
    return np.array(levels), np.array(powers)


def sines(frequencies, samples):
    t = 2 * np.pi * np.arange(samples)[:, None] * (np.asarray(frequencies) / RATE)
    return np.stack([np.sin(t), np.cos(t)], axis=2).reshape(samples, -1)


def taper(samples):
    """A tenth of the record at each end."""
    n = np.arange(samples)
    edge = (np.minimum(n, samples - 1 - n) + 0.5) / samples
    return np.where(edge >= 0.1, 1.0, np.sin(5 * np.pi * np.minimum(edge, 0.1)) ** 2)


def fit_sines(signal, frequencies):
    """Weighted least squares of sines and cosines, by numpy's singular values."""
    root = np.sqrt(taper(len(signal)))
    S = sines(frequencies, len(signal))
    return np.linalg.lstsq(root[:, None] * S, root * np.asarray(signal, float),
                           rcond=None)[0]


def spectral_limits(design, signals, shake=still):
    runs = [disturbance_residual(design, z, shake) for z in signals[:2]]
    spectra = [welch(r) for r in runs]
    nominal = sum(spectra) / len(spectra)
    dof = nominal_dof([len(r) for r in runs])
    noises = [segment_noise(r, nominal, dof) for r in runs]
    bin_width = RATE / SEGMENT
    return {"nominal": nominal, "highest": np.max(spectra, axis=0), "figures": [
        dof, 2 * np.max(spectra, axis=0)[USED].max(),
        1.25 * max(s.sum() * bin_width for s in spectra),
        1.25 * max(middle(level) for level, _ in noises),
        1.25 * max(middle(power) for _, power in noises)]}


def spectrum_scale(density):
    """Errors of a transform are of its largest part; a density is its square."""
    return np.sqrt(density * density.max())


def spectra():
    design, signals = design_of_three()
    said = design["limits"]["disturbance"]
    exact = spectral_limits(design, signals)
    rows = []
    for what, key in (("mean density of healthy runs, 1025 bins", "nominal"),
                      ("highest density of healthy runs, 1025 bins", "highest")):
        scale = spectrum_scale(exact[key])
        rows.append(Row(PART, what, f"`design`: `limits.disturbance.{key}`",
                        "scipy.signal.welch of own residuals", said[key], exact[key],
                        condition_of(lambda shake, key=key: spectral_limits(
                            design, signals, shake)[key], exact[key], scale), SHAKEN,
                        scale=scale))
    ours = [said[key] for key in ("nominal_dof", "peak", "total", "noise_ratio",
                                  "broadband")]
    rows.append(Row(PART, "degrees of freedom, limits of peak, power and noise",
                    "`design`: `limits.disturbance`",
                    "scipy.signal.welch, scipy.stats.f, numpy", ours, exact["figures"],
                    condition_of(lambda shake: spectral_limits(
                        design, signals, shake)["figures"], exact["figures"]), SHAKEN))
    return rows


ROWS = [limits, spectra]
