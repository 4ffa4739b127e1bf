"""Features of signals, as data sets for classifiers have them."""

import tempfile

import numpy as np
import scipy.signal
import scipy.stats

from .common import LONG, MJCF, SHAKEN, Row, condition_of, still

PART = "Features"
RATE, SEGMENT, BANDS = 8000, 512, 9
TIME = ("mean", "log_rms", "log_sd", "log_peak", "crest", "kurtosis", "skewness",
        "shape_factor", "log_peak_to_peak", "impulse_factor")


def features_of(x, shake=still):
    """By name (studies/features.h)."""
    x = np.asarray(shake(x.astype(LONG)))
    rms, size, peak = np.sqrt(np.mean(x ** 2)), np.mean(abs(x)), abs(x).max()
    of = dict(zip(TIME, (
        x.mean(), np.log10(rms), np.log10(x.std()), np.log10(peak), peak / rms,
        scipy.stats.kurtosis(x, fisher=False), scipy.stats.skew(x), rms / size,
        np.log10(x.max() - x.min()), peak / size)))
    f, S = scipy.signal.welch(np.asarray(x, float), RATE, "hann", SEGMENT)
    high = RATE / 2
    for band in range(BANDS):
        low = high / 2 if band < BANDS - 1 else -1.0
        power = S[(f > low) & (f <= high)].sum() * f[1]
        edges = [f"{x:.3g}" if x < 1000 else f"{x:g}" for x in (max(low, 0.0), high)]
        of[f"log_power_{edges[0]}-{edges[1]}_Hz"] = np.log10(power)
        high /= 2
    centre = (f * S).sum() / S.sum()
    of["centroid"] = centre
    of["spread"] = np.sqrt(((f - centre) ** 2 * S).sum() / S.sum())
    of["dominant"] = f[np.argmax(S)]
    return of


def table():
    import mjdiag
    study = mjdiag.Study({
        "setup": str(MJCF / "ab383"), "linear": True, "trajectories": ["xyz"],
        "duration": 0.2, "method": "random", "points": 3,
        "axis": [{"fault": "zeta_x", "from": 1.1, "to": 2.0}],
        "keep": {"features": ["x", "u_y"], "segment": SEGMENT}})
    with tempfile.TemporaryDirectory() as folder:
        done = study.run(folder)
        names, values = done.feature_names, np.array(done.features)
    ours, signals, kinds = [], [], []
    for run in range(study.runs):
        record = study.simulate(run)
        for j, name in enumerate(names):
            channel, kind = name.split(".", 1)
            signal = record[channel] if channel in record else \
                record[channel[:-6] + "_ref"] - record[channel[:-6]]
            ours.append(values[run, j])
            signals.append(signal)
            kinds.append(kind)

    def theirs(shake=still):
        made = {}
        out = []
        for signal, kind in zip(signals, kinds):
            key = signal.tobytes()
            if key not in made:
                made[key] = features_of(signal, shake)
            out.append(made[key][kind])
        return out

    exact = theirs()
    # Logarithms, means and skewness pass through zero.
    scale = [max(1.0, float(abs(x))) if not kind == "mean" else float(np.abs(signal).max())
             for x, kind, signal in zip(exact, kinds, signals)]
    return [Row(PART, "time and frequency features of three runs", "`Study.run().features`",
                "numpy, scipy.stats, scipy.signal.welch", ours, exact,
                condition_of(theirs, exact, scale), SHAKEN, scale=scale)]


ROWS = [table]
