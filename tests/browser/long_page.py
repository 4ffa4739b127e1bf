"""A page with more samples than a screen has pixels, and with hostile names."""

import array
import base64
import json
import os

LONG = 200_000  # samples
LONG_PLOTS = 3
STEP = 1e-4  # s


def long_wave():
    wave = array.array("f", (((k * 7919) % 1000) / 1000.0 for k in range(LONG)))
    wave[123457], wave[76543] = -1.0, 2.0  # peaks of one sample
    return wave


def write_long_page(folder):
    """A page of three time plots and a hostile name, as a command would write it."""
    samples = base64.b64encode(long_wave().tobytes()).decode()
    name = "<img src=x onerror=console.error('run')>"
    plots = [{"kind": "time", "height": 240, "x_label": "time [s]",
              "y_label": name + " [m]", "unit": "m", "start": 0.0, "step": STEP,
              "curves": [{"label": name, "role": "measured", "samples": samples}],
              "levels": [{"value": 0.5, "label": name}], "bands": [], "marks": []}] * LONG_PLOTS
    page = {"schema": "mjdiag.page/1", "title": name, "verdict": None, "command": name,
            "versions": [], "blocks": [
                {"kind": "plot", "caption": name, "plot": plot} for plot in plots]}
    with open(os.path.join(folder, "long.page.json"), "w") as file:
        json.dump(page, file)
