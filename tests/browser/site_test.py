#!/usr/bin/env python3
"""The site of the documentation as people see it, from its folder, without a server.

    tests/browser/site_test.py <build folder> <folder of the site> [folder for pictures]

Builds it with scripts/docs --quick, which checks links and commands, and opens it in
Chromium. <folder of the site>: is made anew."""

import os
import shutil
import subprocess
import sys
import unittest

sys.dont_write_bytecode = True  # leave the tree as it was

from browser import Browser, Tab

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
sys.path.insert(0, os.path.join(ROOT, "docs", "site"))

import equations  # noqa: E402

BUILD, SITE = (os.path.abspath(path) for path in sys.argv[1:3])
PICTURES = os.path.abspath(sys.argv[3]) if len(sys.argv) > 3 else ""
NEEDED = ("python3-sphinx", "python3-myst-parser", "furo", "libjs-mathjax", "chromium",
          "python3-nbclient", "python3-ipykernel")

# Settles when nothing is left to typeset.
TYPESET = """() => new Promise((done) => MathJax.Hub.Queue(() => done({
  formulas: Array.from(document.querySelectorAll('div.math'))
      .filter((e) => e.querySelector('.mjx-math')).length,
  bad: Array.from(document.querySelectorAll('.merror, .mjx-merror, .MathJax_Error'),
                  (e) => e.textContent),
  links: Array.from(document.querySelectorAll('div.where'),
                    (e) => e.querySelectorAll('a').length) })))"""

FOUND = """() => new Promise((done) => {
  const end = performance.now() + 20000;
  const look = () => {
    const found = Array.from(document.querySelectorAll('ul.search li a'), (a) => a.href);
    const over = (document.querySelector('.search-summary') || {}).textContent || '';
    if (/finished|found/.test(over) || performance.now() > end) done({ found, over });
    else setTimeout(look, 50);
  };
  look();
})"""


class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        environment = {**os.environ, "MJDIAG_BUILD": BUILD}
        subprocess.run([os.path.join(ROOT, "scripts", "docs"), "--quick", SITE],
                       env=environment, check=True)
        cls.browser = Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()

    def page(self, name, **options):
        tab = Tab(self.browser, **options)
        self.addCleanup(tab.__exit__)
        tab.open(os.path.join(SITE, "html", name))
        return tab

    def keep(self, name, tab):
        if PICTURES:
            os.makedirs(PICTURES, exist_ok=True)
            with open(os.path.join(PICTURES, name + ".png"), "wb") as file:
                file.write(tab.screenshot())

    def test_begins_with_the_readme_and_its_picture(self):
        tab = self.page("index.html")
        self.assertEqual(tab.run("() => document.querySelector('h1').firstChild.data"),
                         "mjdiag")
        width = tab.run("() => document.querySelector('article img').naturalWidth")
        self.assertGreater(width, 600)
        self.assertGreater(tab.run(
            "() => document.querySelectorAll('article table a').length"), 10)
        self.assertEqual(tab.complaints(), [])
        self.keep("index", tab)

    def test_equations_are_typeset_and_lead_to_what_has_them(self):
        tab = self.page("theory.html")
        seen = tab.run(TYPESET)
        with open(os.path.join(ROOT, "docs", "theory.md"), encoding="utf-8") as theory:
            self.assertEqual(seen["formulas"], len(equations.equations(theory.read())))
        self.assertEqual(seen["bad"], [])
        self.assertEqual(len(seen["links"]), seen["formulas"])
        self.assertGreaterEqual(min(seen["links"]), 2)  # a name and its file
        self.assertEqual(tab.complaints(), [])
        self.keep("theory", tab)
        link = tab.run("() => Array.from(document.querySelectorAll('div.where a'))"
                       ".find((a) => a.textContent === 'TickModel').href")
        self.assertTrue(link.startswith("file://"), link)
        path, _, anchor = link.removeprefix("file://").partition("#")
        tab.open(path)
        shown = tab.run("(id) => document.getElementById(id)"
                        ".querySelector('.hll').textContent", anchor)
        self.assertIn("StateSpace TickModel(", shown)

    def test_search_needs_no_server(self):
        for words, page in (("backlash", "effects.html"), ("TickModel", "mechanical_model.h"),
                            ("--tolerate", "commands/simulate.html")):
            with self.subTest(words=words):
                tab = self.page("search.html?q=" + words)
                seen = tab.run(FOUND)
                self.assertTrue(any(page in link for link in seen["found"]), seen)
                self.assertEqual(tab.complaints(), [])
        self.keep("search", tab)

    def test_phone_does_not_scroll_sideways(self):
        for name in ("index.html", "comparison.html", "python-reference.html",
                     "source/diagnosis.residuals.fault_estimator.h.html"):
            with self.subTest(page=name):
                tab = self.page(name, width=390, height=844, mobile=True)
                self.assertLessEqual(
                    tab.run("() => document.documentElement.scrollWidth"), 390)
                self.assertEqual(tab.complaints(), [])
                self.keep("phone-" + os.path.basename(name), tab)


if __name__ == "__main__":
    for package in NEEDED:
        if subprocess.run(["dpkg", "-s", package], stdout=subprocess.DEVNULL,
                          stderr=subprocess.DEVNULL).returncode and "CI" not in os.environ:
            print(f"no {package}: skipped")
            sys.exit(77)  # as CTest has it
    if shutil.which("chromium") is None:
        sys.exit("no chromium")
    unittest.main(argv=sys.argv[:1], verbosity=2)
