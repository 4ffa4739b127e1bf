"""Pictures of records and diagnoses, with matplotlib where it is installed."""

import importlib


def _pyplot():
    try:
        return importlib.import_module("matplotlib.pyplot")
    except ImportError as error:
        raise ImportError("plot: matplotlib is not installed") from error


def plot_record(self, names=None, axes=None):
    """Draws channels over the time, each in axes of its own.

    names: of the channels, or one; None: all.
    axes: as many matplotlib axes; None: new ones, below each other.

    Returns the list of axes. KeyError without such a channel; ImportError without
    matplotlib.
    """
    names = list(self) if names is None else [names] if isinstance(names, str) else list(names)
    channels = [self[name] for name in names]
    if axes is None:
        pyplot = _pyplot()
        _, axes = pyplot.subplots(len(names), sharex=True, squeeze=False)
        axes = list(axes[:, 0])
    for name, samples, one in zip(names, channels, axes):
        one.plot(self.time, samples)
        one.set_ylabel(f"{name} [{self.units[name]}]")
    axes[-1].set_xlabel("time [s]")
    return axes


def plot_diagnosis(self, axes=None):
    """Draws the residual of every sample between its limits.

    axes: of matplotlib; None: new ones.

    Returns the axes. ImportError without matplotlib.
    """
    if axes is None:
        _, axes = _pyplot().subplots()
    axes.plot(self.residual)
    for limit in self.limits:
        axes.axhline(limit, linestyle="--")
    axes.set_xlabel("sample")
    axes.set_ylabel("residual")
    axes.set_title(self.verdict)
    return axes
