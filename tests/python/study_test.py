"""Studies of one's own: plans, what they keep, and the data set for others."""

import os
import re
import unittest

import numpy as np

import mjdiag
from support import MJCF, ROOT, Test

BONDER = os.path.join(MJCF, "ab383")
BLOCK = re.compile(r"^```python *(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def short_plan(**keys):
    plan = {
        "setup": BONDER,
        "linear": True,
        "trajectories": ["xy"],
        "duration": 0.08,
        "method": "random",
        "points": 4,
        "machines": {"count": 2, "numbers": ["mass"], "spread": "usual",
                     "split": {"train": 0.5, "test": 0.5}},
        "axis": [{"fault": "eta_x", "from": 0.99, "to": 0.9, "scale": "log"}],
        "keep": {"records": ["x", "u_x"], "every": 2, "features": ["x"], "segment": 256},
    }
    plan.update(keys)
    return plan


class PlanTest(Test):
    def test_is_a_dict_a_text_or_a_file(self):
        study = mjdiag.Study(short_plan())
        self.assertEqual(study.runs, 8)
        again = mjdiag.Study(study.plan)
        with open("plan.toml", "w") as file:
            file.write(study.plan)
        read = mjdiag.Study("plan.toml")
        for other in (again, read):
            self.assertEqual(other.describe(5), study.describe(5))
        self.assertIn("8 runs", repr(study))

    def test_says_what_is_wrong_in_one_line(self):
        self.assertRefuses(lambda: mjdiag.Study(short_plan(methud="grid")), "methud",
                           "unknown key", "method")
        self.assertRefuses(lambda: mjdiag.Study(short_plan(method="gird")), "'gird'", "sobol")
        self.assertRefuses(lambda: mjdiag.Study(short_plan(keep={"records": ["q"]})),
                           "keep.records", "u_x")
        self.assertRefuses(lambda: mjdiag.Study(3), "Study", "int")
        self.assertRefuses(lambda: mjdiag.Study(short_plan(axis=[object()])), "axis")
        self.assertRefuses(lambda: mjdiag.Study(short_plan()).simulate(8), "index", "0 to 7")
        with self.assertRaises(mjdiag.InputError):
            mjdiag.Study("nowhere.toml")

    def test_keys_of_the_setup_may_have_dots(self):
        study = mjdiag.Study(short_plan(set={"sensors.x.noise_power": 0.0}))
        quiet = study.simulate(0)
        again = mjdiag.Study(short_plan()).simulate(0)
        self.assertFalse(np.array_equal(quiet["x"], again["x"]))


class RunTest(Test):
    def test_goes_on_after_it_was_ended(self):
        study = mjdiag.Study(short_plan(points=20))
        told = []

        def stop(fraction, what):
            told.append(what)
            if fraction >= 0.25:
                raise KeyboardInterrupt

        try:
            study.run("ended", progress=stop)
        except KeyboardInterrupt:
            pass
        ended = study.run("ended")
        whole = study.run("whole")
        self.assertTrue(told)
        np.testing.assert_array_equal(ended.features, whole.features)
        if ended.dataset is not None:
            with open(ended.dataset, "rb") as one, open(whole.dataset, "rb") as other:
                self.assertEqual(one.read(), other.read())
        self.assertRefuses(lambda: mjdiag.Study(short_plan()).run("ended"), "another plan")

    def test_has_columns_and_rows(self):
        study = mjdiag.Study(short_plan())
        result = study.run("study")
        runs = result.runs
        self.assertEqual(len(runs["eta_x"]), 8)
        self.assertEqual(set(runs["split"]), {"train", "test"})
        self.assertEqual(set(runs["label"]), {"eta_x"})
        self.assertEqual(result.features.shape, (8, len(result.feature_names)))
        self.assertEqual(result.estimates.shape, (8, 0))
        self.assertEqual(study.describe(3)["values"]["eta_x"], runs["eta_x"][3])
        self.assertNotEqual(study.describe(0)["numbers"], study.describe(7)["numbers"])
        result.report("study.html")
        self.assertGreater(os.path.getsize("study.html"), 1000)
        self.assertIn("<table", result._repr_html_())


class DatasetTest(Test):
    def setUp(self):
        super().setUp()
        try:
            global h5py, pandas
            import h5py
            import pandas
        except ImportError as missing:
            self.skipTest(str(missing))

    def dataset(self, plan):
        result = mjdiag.Study(plan).run("study")
        if result.dataset is None:
            self.skipTest("built without HDF5")
        return result

    def test_opens_in_h5py_and_pandas(self):
        study = mjdiag.Study(short_plan(trajectories=["xy", "x"], duration=0.08))
        result = study.run("study")
        if result.dataset is None:
            self.skipTest("built without HDF5")
        with h5py.File(result.dataset) as data:
            self.assertEqual(data.attrs["schema"], b"mjdiag.dataset/1")
            self.assertEqual(data["plan"][()].decode(), study.plan)
            self.assertIn(b"<mujoco", data["plant"][()])
            frame = pandas.DataFrame({key: value[:] for key, value in data["runs"].items()})
            self.assertEqual(len(frame), 16)
            self.assertEqual(list(frame["index"]), list(range(16)))
            x = data["records/x"]
            self.assertEqual(x.attrs["unit"], b"m")
            self.assertEqual(x.compression, "gzip")
            self.assertTrue(x.shuffle)
            self.assertEqual(x.chunks, (1, x.shape[1]))
            for index in (0, 5, 15):
                record = study.simulate(index)
                np.testing.assert_array_equal(x[index], record["x"][::2])
            np.testing.assert_allclose(data["time"][:3], [0, 2 / 8000, 4 / 8000])
            np.testing.assert_array_equal(data["axes/eta_x"][:], result.runs["eta_x"])
            np.testing.assert_array_equal(data["features"][:], result.features)
            self.assertEqual([name.decode() for name in data["features"].attrs["columns"]],
                             result.feature_names)
            splits = data["machines/split"].asstr()[:]
            for run, machine in enumerate(data["runs/machine"][:]):
                self.assertEqual(data["runs/split"].asstr()[run], splits[machine])

            def documented(name, item):
                if isinstance(item, h5py.Dataset):
                    self.assertIn("description", item.attrs, name)

            data.visititems(documented)

    def test_rows_of_shorter_runs_end_with_nan(self):
        plan = short_plan(trajectories=["xy", "multi"])
        del plan["duration"]
        plan["points"] = 1
        result = self.dataset(plan)
        with h5py.File(result.dataset) as data:
            samples = data["runs/samples"][:]
            for row, count in zip(data["records/x"], samples):
                self.assertEqual(np.isfinite(row).sum(), (count + 1) // 2)

    def test_the_documented_plan_is_one(self):
        with open(os.path.join(ROOT, "docs", "datasets.md")) as file:
            (plan,) = re.findall(r"^```toml\n(.*?)^```$", file.read(),
                                 re.MULTILINE | re.DOTALL)
        os.symlink(MJCF, "mjcf")
        study = mjdiag.Study(plan)
        self.assertEqual(study.runs, 4 * (4 + 8) * 2 * 2)
        study.simulate(study.runs - 1)

    def test_the_plans_that_ship_are_plans(self):
        folder = os.path.join(BONDER, "plans")
        for name in os.listdir(folder):
            with open(os.path.join(folder, name)) as file:
                asks = "\n[ask]\n" in file.read()  # some of one long run
            least = 0 if asks else 10
            self.assertGreater(mjdiag.Study(os.path.join(folder, name)).runs, least)

    def test_a_plan_that_asks_something_makes_no_data_set(self):
        study = mjdiag.Study(os.path.join(BONDER, "plans", "bound.toml"))
        self.assertRefuses(lambda: study.run("asked"), "asks something")


class ClassifierTest(Test):
    """docs/datasets.md, as it is typed there, beside the study `table4`."""

    def test_a_support_vector_machine_learns_from_a_data_set(self):
        try:
            import h5py
            import pandas
            import sklearn
        except ImportError as missing:
            self.skipTest(str(missing))
        if "MJDIAG_OPTIMISED" not in os.environ:
            self.skipTest("takes an optimised build")
        study = mjdiag.Study(os.path.join(BONDER, "plans", "classifier.toml"))
        result = study.run("out/classifier")
        if result.dataset is None:
            self.skipTest("built without HDF5")
        with open(os.path.join(ROOT, "docs", "datasets.md")) as file:
            blocks = BLOCK.findall(file.read())
        typed = {}
        for _, block in blocks:
            exec(compile(block, "docs/datasets.md", "exec"), typed)
        self.check(typed["detection"], typed["isolation"])

    def check(self, detection, isolation):
        # What the study has of 96 runs, 48 of them faulty (--preset table4 --runs 192), and
        # three standard deviations of the difference of two such counts.
        for name, found, study, runs in (("detection", detection, 95 / 96, 96),
                                         ("isolation", isolation, 47 / 48, 48)):
            pooled = (found + study) / 2
            spread = 3 * np.sqrt(2 * pooled * (1 - pooled) / runs)
            self.assertLessEqual(abs(found - study), spread, name)


if __name__ == "__main__":
    unittest.main()
