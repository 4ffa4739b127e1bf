#!/usr/bin/env python3
"""Reports as people see them: in a browser, zoomed, played, on a phone and printed.

    tests/browser/report_test.py <mjdiag> [folder for the pictures]

Makes a report of each kind with the command, and opens it in Chromium."""

import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True  # leave the tree as it was

from browser import Browser, Tab
from long_page import LONG, LONG_PLOTS, STEP, long_wave, write_long_page
from picture import Picture

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
MJDIAG = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else ""
PICTURES = os.path.abspath(sys.argv[2]) if len(sys.argv) > 2 else ""
KINDS = ("diagnosis", "comparison", "discovery", "study", "design")
PHONE = {"width": 390, "height": 844, "mobile": True}

# Stretch of a plot that a drag selects, as parts of its width.
FROM, TO = 0.3, 0.6

CHARTS = """() => Array.from(document.querySelectorAll('.chart'), (chart) => {
  const graph = chart.dygraph, area = graph.getArea();
  const box = chart.getBoundingClientRect();
  return {
    kind: JSON.parse(chart.parentElement.querySelector('script').textContent).kind,
    caption: chart.parentElement.querySelector('figcaption').textContent,
    x: box.x + scrollX, y: box.y + scrollY, width: box.width, height: box.height,
    left: area.x, top: area.y, inner: area.w, tall: area.h,
    range: graph.xAxisRange(), canvas: chart.querySelector('canvas').clientWidth };
})"""

# Labels of one axis of one chart that lie on each other, and labels outside of it.
CROWDED = """() => Array.from(document.querySelectorAll('.chart')).flatMap((chart) => {
  const frame = chart.getBoundingClientRect();
  return ['x', 'y'].flatMap((axis) => {
    const labels = Array.from(chart.querySelectorAll('.dygraph-axis-label-' + axis),
        (label) => {
          const range = document.createRange();
          range.selectNodeContents(label);
          return { text: label.textContent, box: range.getBoundingClientRect() };
        }).filter((label) => label.text !== '');
    const bad = [];
    labels.forEach((a, i) => {
      if (a.box.left < frame.left - 2 || a.box.right > frame.right + 2) bad.push(a.text);
      for (const b of labels.slice(i + 1)) {
        if (a.box.left < b.box.right && b.box.left < a.box.right &&
            a.box.top < b.box.bottom - 2 && b.box.top < a.box.bottom - 2) {
          bad.push(a.text + ' on ' + b.text);
        }
      }
    });
    return bad.map((text) => chart.getAttribute('aria-label') + ': ' + text);
  });
})"""

# Least contrast of text with what is behind it (WCAG 2), over every element with text.
CONTRAST = """() => {
  const parse = (text) => (text.match(/[0-9.]+/g) || []).map(Number);
  const light = (rgb) => rgb.slice(0, 3).map((c) => c / 255)
      .map((c) => c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)
      .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
  const behind = (element) => {
    for (let e = element; e; e = e.parentElement) {
      const color = parse(getComputedStyle(e).backgroundColor);
      if (color.length === 3 || color[3] > 0) return color;
    }
    return [255, 255, 255];
  };
  let least = [99, ''];
  for (const e of document.querySelectorAll('main *')) {
    if (!Array.from(e.childNodes).some((n) => n.nodeType === 3 && n.data.trim())) continue;
    if (['SCRIPT', 'VIDEO', 'NOSCRIPT'].includes(e.tagName)) continue;
    if (e.closest('noscript')) continue;
    const a = light(parse(getComputedStyle(e).color)), b = light(behind(e));
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < least[0]) least = [ratio, e.tagName + ': ' + e.textContent.slice(0, 60)];
  }
  return least;
}"""


def mjdiag(arguments, status=0):
    done = subprocess.run([MJDIAG] + arguments.split(), cwd=ROOT, text=True,
                          capture_output=True)
    if done.returncode != status:
        raise AssertionError("mjdiag %s: %s" % (arguments, done.stderr))
    return done


def measure_voice_coil(folder):
    """A record of a voice coil with a hidden spring, as the walk of docs/own-machine.md has them."""
    os.makedirs(folder)
    with open(os.path.join(ROOT, "docs", "own-machine.md")) as document:
        lines = [line.strip() for line in document]
    for start in ("awk ", "mjdiag simulate"):
        line = next(line for line in lines if line.startswith(start))
        line = line.replace("out/voice_coil", folder).replace("mjdiag ", MJDIAG + " ")
        subprocess.run(line, shell=True, cwd=ROOT, check=True, capture_output=True)


class ReportTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="mjdiag-report-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        out = {kind: os.path.join(cls.folder, kind) for kind in KINDS}
        out["long"] = os.path.join(cls.folder, "long")
        os.mkdir(out["long"])
        bonder = "--setup mjcf/ab383 "
        worn = bonder + "--fault zeta_x=1.2 --duration 0.3 --out " + out["diagnosis"]
        mjdiag("render --width 640 --height 360 --to 0.05 --speed 0.05 " + worn)
        mjdiag("simulate --linear --diagnose --nominal-runs 2 --report " + worn)
        mjdiag("compare --report --record mjcf/ab383/example.csv " + bonder +
               "--out " + out["comparison"])
        mjdiag("study --preset bound --report " + bonder + "--out " + out["study"])
        mjdiag("design --linear --nominal-runs 2 --report " + bonder +
               "--out " + out["design"])
        measure_voice_coil(out["discovery"] + "-record")
        mjdiag("discover --setup mjcf/voice_coil --report --record %s --out %s" %
               (out["discovery"] + "-record/measured/record.csv", out["discovery"]))
        write_long_page(out["long"])
        mjdiag("report " + out["long"])
        cls.report = {kind: os.path.join(path, "report.html")
                      for kind, path in out.items()}
        cls.out = out
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)
        cls.looked_at = {}

    def tab(self, kind, **options):
        """A page that the test may change."""
        tab = Tab(self.browser, **options)
        self.addCleanup(tab.__exit__)
        tab.open(self.report[kind])
        return tab

    def look(self, kind, **options):
        """A page that tests share, for they only look at it."""
        key = (kind, *sorted(options.items()))
        if key not in self.looked_at:
            self.looked_at[key] = Tab(self.browser, **options)
            self.looked_at[key].open(self.report[kind])
        self.looked_at[key].call("Page.bringToFront")  # others are not painted
        return self.looked_at[key]

    def keep(self, name, png):
        if PICTURES:
            os.makedirs(PICTURES, exist_ok=True)
            with open(os.path.join(PICTURES, name + ".png"), "wb") as file:
                file.write(png)

    def keep_whole(self, name, tab):
        if PICTURES:
            size = tab.run("() => [document.documentElement.scrollWidth, "
                           "document.documentElement.scrollHeight]")
            self.keep(name, tab.screenshot([0, 0] + size))

    def test_report_of_each_kind_opens_without_complaint(self):
        for kind in KINDS:
            for scheme in ("light", "dark"):
                with self.subTest(kind=kind, scheme=scheme):
                    tab = self.look(kind, scheme=scheme)
                    figures = tab.run(
                        "() => document.querySelectorAll('figure.plot').length")
                    self.assertEqual(len(tab.run(CHARTS)), figures)
                    self.assertEqual(figures > 0, kind != "study")
                    self.assertEqual(tab.complaints(), [])
                    self.keep_whole(kind + "-" + scheme, tab)

    def test_axes_have_names_and_units(self):
        labels = """() => Array.from(document.querySelectorAll('.chart'), (chart) =>
            ['x', 'y'].map((axis) =>
                chart.querySelector('.dygraph-' + axis + 'label').textContent))"""
        for kind in KINDS:
            tab = self.look(kind, scheme="light")
            for chart, (x, y) in zip(tab.run(CHARTS), tab.run(labels)):
                with self.subTest(kind=kind, caption=chart["caption"]):
                    expected = {"time": "time [s]", "spectrum": "frequency [Hz]",
                                "bode": "frequency [Hz]"}
                    self.assertEqual(x, expected.get(chart["kind"], x))
                    self.assertTrue(x and y)

    def test_labels_do_not_lie_on_each_other(self):
        for kind in KINDS:
            for options in ({"scheme": "light"}, PHONE):
                with self.subTest(kind=kind, options=options):
                    self.assertEqual(self.look(kind, **options).run(CROWDED), [])

    def test_text_is_readable_in_light_and_dark(self):
        for kind in KINDS:
            for scheme in ("light", "dark"):
                with self.subTest(kind=kind, scheme=scheme):
                    ratio, where = self.look(kind, scheme=scheme).run(CONTRAST)
                    self.assertGreaterEqual(ratio, 4.5, where)

    def test_page_follows_the_scheme(self):
        for scheme, dark in (("light", False), ("dark", True)):
            tab = self.look("diagnosis", scheme=scheme)
            picture = Picture(tab.screenshot([0, 0, 40, 40]))
            self.assertEqual(sum(picture.pixel(20, 20)) < 200, dark)

    def test_phone_does_not_scroll_sideways(self):
        for kind in KINDS:
            with self.subTest(kind=kind):
                tab = self.look(kind, **PHONE)
                width = tab.run("() => document.documentElement.scrollWidth")
                self.assertLessEqual(width, 390)
                for chart in tab.run(CHARTS):
                    self.assertLessEqual(chart["x"] + chart["canvas"], 390)
                self.keep_whole(kind + "-phone", tab)

    def test_time_plots_zoom_together_and_come_back(self):
        for kind in ("diagnosis", "comparison", "discovery", "long"):
            with self.subTest(kind=kind):
                self.zoom(self.tab(kind))

    def zoom(self, tab):
        before = tab.run(CHARTS)
        first = next(i for i, c in enumerate(before) if c["kind"] == "time")
        box = tab.run("""(index) => {
            const chart = document.querySelectorAll('.chart')[index];
            chart.scrollIntoView({block: 'center', behavior: 'instant'});
            const box = chart.getBoundingClientRect();
            return [box.x, box.y]; }""", first)
        chart = before[first]
        places = [(box[0] + chart["left"] + part * chart["inner"],
                   box[1] + chart["top"] + 0.5 * chart["tall"]) for part in (FROM, TO)]
        tab.drag(*places)
        tab.run("() => new Promise((done) => setTimeout(done, 400))")
        low, high = chart["range"]
        pixel = (high - low) / chart["inner"]
        after = tab.run(CHARTS)
        for old, new in zip(before, after):
            if old["kind"] == "time":
                expected = (low + FROM * (high - low), low + TO * (high - low))
            else:
                expected = old["range"]
            for found, wanted in zip(new["range"], expected):
                self.assertAlmostEqual(found, wanted, delta=2.0 * pixel,
                                       msg=new["caption"])
        tab.run("() => document.getElementById('reset-zoom').click()")
        tab.run("() => new Promise((done) => setTimeout(done, 400))")
        for old, new in zip(before, tab.run(CHARTS)):
            for found, wanted in zip(new["range"], old["range"]):
                self.assertAlmostEqual(found, wanted, delta=pixel, msg=new["caption"])

    def test_moment_of_detection_is_marked_where_it_is(self):
        with open(os.path.join(self.out["diagnosis"], "diagnosis.json")) as file:
            moment = json.load(file)["first_detection"]
        self.assertIsNotNone(moment)
        tab = self.tab("diagnosis")
        chart = tab.run(CHARTS)[0]
        self.assertEqual(chart["caption"], "Residual and its thresholds")
        expected = tab.run("(t) => document.querySelector('.chart').dygraph"
                           ".toDomXCoord(t)", moment)
        low, high = chart["range"]
        self.assertAlmostEqual(
            expected,
            chart["left"] + (moment - low) / (high - low) * chart["inner"], delta=0.01)
        picture = Picture(tab.screenshot(
            [chart["x"], chart["y"], chart["width"], chart["height"]]))
        quiet = tab.run("() => getComputedStyle(document.documentElement)"
                        ".getPropertyValue('--quiet').trim()")
        color = tuple(int(quiet[i:i + 2], 16) for i in (1, 3, 5))
        counts = picture.columns_of(color, 60, int(chart["top"]) + 2,
                                    int(chart["top"] + chart["tall"]) - 2)
        # The axes have that colour, too: only what lies inside of them counts.
        inside = {x: counts[x] for x in range(int(chart["left"]) + 3,
                                              int(chart["left"] + chart["inner"]) - 2)}
        dashes = [x for x, count in inside.items() if count > 0.3 * chart["tall"]]
        self.assertTrue(dashes)
        first = min(dashes, key=lambda x: abs(x - expected))
        self.assertLessEqual(abs(first + 0.5 - expected), 1.5, dashes)
        self.keep("detection", tab.screenshot(
            [chart["x"], chart["y"], chart["width"], chart["height"]]))

    def test_clip_plays(self):
        tab = self.tab("diagnosis")
        seen = tab.run("""async () => {
            const video = document.querySelector('video');
            await video.play();
            const deadline = performance.now() + 30000;
            while (video.currentTime < 0.2 && performance.now() < deadline) {
              await new Promise((done) => setTimeout(done, 50));
            }
            const canvas = document.createElement('canvas');
            canvas.width = video.videoWidth;
            canvas.height = video.videoHeight;
            const context = canvas.getContext('2d');
            context.drawImage(video, 0, 0);
            const pixels = context.getImageData(0, 0, canvas.width, canvas.height).data;
            return { time: video.currentTime, width: video.videoWidth,
                     height: video.videoHeight, colors: new Set(pixels).size };
          }""")
        self.assertGreaterEqual(seen["time"], 0.2)
        self.assertEqual((seen["width"], seen["height"]), (640, 360))
        self.assertGreater(seen["colors"], 30)
        self.assertEqual(tab.complaints(), [])

    def test_print_is_light_and_fits_the_paper(self):
        for kind in ("diagnosis", "discovery"):
            with self.subTest(kind=kind):
                tab = self.tab(kind, scheme="dark")
                tab.run("""() => window.addEventListener('beforeprint', () => {
                    window.printed = Array.from(document.querySelectorAll('.chart'),
                        (chart) => chart.querySelector('canvas').clientWidth);
                  })""")
                pdf = base64.b64decode(tab.call("Page.printToPDF",
                                                printBackground=True)["data"])
                self.assertTrue(pdf.startswith(b"%PDF"))
                widths = tab.run("() => window.printed")
                self.assertTrue(widths)
                self.assertLessEqual(max(widths), 700)
                # As the paper would have it: 18 cm, and a screenshot of that.
                tab.media("dark", "print")
                tab.call("Emulation.setDeviceMetricsOverride", width=718, height=1000,
                         deviceScaleFactor=1, mobile=False)
                tab.run("() => window.dispatchEvent(new Event('beforeprint'))")
                width = tab.run("() => document.documentElement.scrollWidth")
                self.assertLessEqual(width, 718)
                wide = tab.run("""() => Array.from(document.querySelectorAll('table'),
                    (table) => table.getBoundingClientRect().right)""")
                self.assertLessEqual(max(wide), 718)
                chart = tab.run(CHARTS)[0]
                picture = Picture(tab.screenshot([0, 0, 718, 40]))
                self.assertEqual(picture.pixel(2, 2), (255, 255, 255))
                picture = Picture(tab.screenshot(
                    [chart["x"] + chart["left"] + 1, chart["y"] + chart["top"] + 1,
                     chart["inner"] - 2, 3]))
                self.assertEqual(picture.pixel(1, 1), (255, 255, 255))
                self.keep_whole(kind + "-print", tab)

    def test_hostile_names_stay_text(self):
        tab = self.look("long")
        self.assertEqual(tab.run("() => document.querySelectorAll('img').length"), 0)
        self.assertEqual(tab.complaints(), [])
        self.assertIn("<img", tab.run(
            "() => document.querySelector('.dygraph-ylabel').textContent"))

    def test_long_plots_show_extremes_afar_and_every_sample_near(self):
        tab = self.tab("long")
        rows = """(window) => {
            const graph = document.querySelector('.chart').dygraph;
            if (window) graph.updateOptions({ dateWindow: window });
            const [low, high] = graph.xAxisRange();
            const found = [];
            for (let k = 0; k < graph.numRows(); ++k) {
              const x = graph.getValue(k, 0);
              if (x >= low && x <= high) found.push([x, graph.getValue(k, 1)]);
            }
            return found; }"""
        wave = long_wave()
        afar = tab.run(rows, None)
        self.assertLess(len(afar), 5000)
        self.assertEqual(max(y for _, y in afar), max(wave))
        self.assertEqual(min(y for _, y in afar), min(wave))
        self.assertAlmostEqual(afar[-1][0], (LONG - 1) * STEP)
        first = LONG // 3
        near = tab.run(rows, [(first - 0.5) * STEP, (first + 49.5) * STEP])
        self.assertEqual([y for _, y in near], list(wave[first:first + 50]))
        for k, (x, _) in enumerate(near):
            self.assertAlmostEqual(x, (first + k) * STEP, delta=1e-9)
        taken = tab.run("""() => {
            const graph = document.querySelector('.chart').dygraph;
            const start = performance.now();
            for (let i = 1; i <= 10; ++i) {
              graph.updateOptions({ dateWindow: [i * 0.1, 19 - i * 0.1] });
            }
            return (performance.now() - start) / 10;
          }""")
        # Told, not judged: machines that run tests are noisy.
        print("%d plots of %d samples zoom in %.0f ms" % (LONG_PLOTS, LONG, taken))


if __name__ == "__main__":
    if shutil.which("chromium") is None and "CI" not in os.environ:
        print("no chromium: skipped")
        sys.exit(77)  # as CTest has it
    unittest.main(argv=sys.argv[:1], verbosity=2)
