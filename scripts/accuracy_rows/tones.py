"""The disturbance analysis of a record: tones, their thresholds, and raised noise."""

import pathlib
import tempfile

import numpy as np
import scipy.optimize
import scipy.stats

from .common import (DRAWS, LONG, SHAKEN, Row, Shaker, ask, diagnosed, read_csv,
                     spread_of, still)
from .filters import signals_of
from .spectra import (BONDER, NEIGHBOURS, RATE, SEGMENT, SHORT, USED, degrees_of,
                      design_of_three, disturbance_residual, fit_sines, middle,
                      segment_count, segment_noise, sines, taper, upper_median,
                      welch)

PART = "Disturbances"
TONE, SIDE = 3, 12  # bins that a tone covers, and those beside it
BINS = USED.stop - USED.start


def hann(samples):
    return np.sin(np.pi * (np.arange(samples) + 0.5) / samples) ** 2


def line_frequency(residual, near):
    """Where the periodogram under a Hann window is highest: its slope vanishes."""
    n = len(residual)
    weighted = hann(n) * residual
    t = (np.arange(n) - 0.5 * (n - 1)) / RATE

    def slope(f):
        turned = weighted * np.exp(-2j * np.pi * LONG(f) * t)
        return float((np.conj(turned.sum()) * (t * turned).sum()).imag)

    width = 0.25 * RATE / n
    return scipy.optimize.brentq(slope, near - width, near + width, xtol=1e-13, rtol=1e-15)


def floor_of(rest, limits, dof):
    """The noise expected at every bin: what is nominal, times the median around."""
    nominal = np.array(limits["nominal"])
    ratio = (rest / np.maximum(nominal, 1e-30 * nominal.max()))[USED]
    local = np.array([upper_median(np.concatenate([
        ratio[max(0, k - NEIGHBOURS):max(0, k - TONE)],
        ratio[k + TONE + 1:k + NEIGHBOURS + 1]])) for k in range(len(ratio))])
    local /= scipy.stats.f.isf(0.5, dof, limits["nominal_dof"])
    return nominal * np.concatenate([[local[0]] * USED.start, local,
                                     [local[-1]] * (len(nominal) - USED.stop)])


def leaked(line, k):
    """Of a Hann window's line into bin k, at most (root of density)."""
    def envelope(x):
        near = abs(x) - 0.25
        return 1.0 if near < 1.5 else 1 / (np.pi * near * (near * near - 1))
    centre, root = line
    return root * (envelope(k - centre) + envelope(k + centre)
                   + envelope(SEGMENT - k - centre))


def thresholds(density, limits, dof, bins):
    """Of the bins of tones, strongest first (docs/theory.md, Disturbances)."""
    nominal_dof = limits["nominal_dof"]
    highest = np.array(limits["highest"])
    floor = floor_of(density, limits, dof)
    count = (min(BINS - 1, NEIGHBOURS) - TONE) / 1.94
    floor_dof = 2 / (2 / nominal_dof
                     + 0.5 * np.pi * (2 / dof + 2 / nominal_dof) / count)
    quantile = scipy.stats.f.isf(1e-4 / BINS, dof, floor_dof)
    lines, found = [], {}
    for k in sorted(bins, key=lambda k: -density[k]):
        left = density[max(USED.start, k - SIDE - TONE):k - TONE]
        right = density[k + TONE + 1:min(USED.stop, k + SIDE + TONE + 1)]
        own = max(quantile * floor[k], quantile * upper_median(left),
                  quantile * upper_median(right), 2 * highest[k - 1:k + 2].max())
        found[k] = (np.sqrt(own) + sum(leaked(line, k) for line in lines)) ** 2
        lobe = density[k - 2:k + 3]
        lines.append((lobe @ np.arange(k - 2, k + 3) / lobe.sum(),
                      np.sqrt(lobe.sum() / 1.5)))
    return [found[k] for k in bins]


def analysis(design, z, near, shake=still):
    """Figures by name, of tones in order of frequency."""
    limits = design["limits"]["disturbance"]
    nominal = np.array(limits["nominal"])
    residual = disturbance_residual(design, z, shake)
    density = welch(residual)
    levels, _ = segment_noise(residual, nominal, limits["nominal_dof"])
    dof = max(2, levels.sum() ** 2 / (len(levels) * (levels ** 2).sum())
              * degrees_of(segment_count(len(residual))))
    bins = [max(range(round(f * SEGMENT / RATE) - 1, round(f * SEGMENT / RATE) + 2),
                key=lambda k: density[k]) for f in near]
    frequency = [line_frequency(residual, f) for f in near]
    fit = fit_sines(residual, frequency)
    amplitude = np.hypot(fit[::2], fit[1::2])
    rest = welch(residual - sines(frequency, len(residual)) @ fit)
    floor = floor_of(rest, limits, dof)
    at = np.interp(np.array(frequency) * SEGMENT / RATE, np.arange(len(floor)), floor)
    w, h = taper(len(residual)), hann(len(residual))
    t = (np.arange(len(residual)) + 0.5 - 0.5 * len(residual)) / RATE
    quiet, _ = segment_noise(residual, nominal, limits["nominal_dof"], frequency)
    return {
        "frequency": frequency, "amplitude": amplitude, "psd": density[bins],
        "threshold": thresholds(density, limits, dof, bins),
        "amplitude_sd": np.sqrt(at * (w ** 2).sum() * RATE) / w.sum(),
        "frequency_sd": np.sqrt(at * RATE * (h ** 2 * t ** 2).sum())
        / (2 * np.pi * amplitude * (h * t ** 2).sum()),
        "noise_ratio": [middle(quiet)], "total": [density.sum() * RATE / SEGMENT]}


def tones():
    design, _ = design_of_three()
    with tempfile.TemporaryDirectory() as folder:
        ask("simulate", "--setup", BONDER, "--linear", *SHORT, "--fault", "gamma=0.2",
            "--seed", 7, "--out", folder)
        file = pathlib.Path(folder) / "record.csv"
        said = diagnosed(design, file, *SHORT)
        z = signals_of(design, read_csv(file))
    named = [fault["name"] for fault in said["faults"] if fault["detected"]]
    peaks = said["disturbance"]["peaks"]
    if named != ["gamma"] or len(peaks) != 3:
        raise SystemExit(f"accuracy: {named} and {len(peaks)} tones beside gamma and 3")
    near = [peak["frequency"] for peak in peaks]
    exact = analysis(design, z, near)
    shaken = [analysis(design, z, near, Shaker(seed)) for seed in range(DRAWS)]
    rows = []
    for keys, what, reference in (
            (["total", "psd"], "power, densities of three tones",
             "scipy.signal.welch of an own residual"),
            (["frequency"], "frequencies of three tones",
             "where the slope of the periodogram vanishes, scipy.optimize"),
            (["amplitude"], "amplitudes of three tones", "weighted least squares, numpy"),
            (["threshold"], "thresholds of three tones",
             "own medians, scipy.stats.f"),
            (["amplitude_sd", "frequency_sd"], "standard deviations of tones",
             "own floor, scipy.stats.f"),
            (["noise_ratio"], "noise over that of healthy runs",
             "own medians, scipy.stats.f")):
        ours = [[peak[key] for peak in peaks] if key in peaks[0]
                else [said["disturbance"][key]] for key in keys]
        values = [list(exact[key]) for key in keys]
        rows.append(Row(PART, what, "`diagnose`: `disturbance`", reference, ours, values,
                        spread_of([[list(one[key]) for key in keys] for one in shaken],
                                  values), SHAKEN))
    return rows


ROWS = [tones]
