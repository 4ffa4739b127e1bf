"""Records: what goes in comes out, views, and what is refused."""

import copy
import gc
import pickle
import sys
import unittest
from collections.abc import Mapping
from unittest import mock

import numpy as np

import mjdiag
from support import Test, current


def ramp(**options):
    data = {"x": np.linspace(0, 1, 11), "u": np.arange(11)}
    return mjdiag.Record(data, {"x": "um", "u": "N"}, 0.5, **options)


class RecordTest(Test):
    def test_is_a_mapping_of_arrays_with_units(self):
        record = ramp(start_time=2.0)
        self.assertIsInstance(record, Mapping)
        self.assertEqual((len(record), list(record)), (2, ["x", "u"]))
        self.assertEqual(record.units, {"x": "m", "u": "N"})
        np.testing.assert_allclose(record["x"], np.linspace(0, 1e-6, 11))
        np.testing.assert_array_equal(record.time, 2.0 + 0.5 * np.arange(11))
        self.assertEqual(dict(record).keys(), set(record.keys()))
        for (name, array), value in zip(record.items(), record.values()):
            np.testing.assert_array_equal(array, record[name])
            np.testing.assert_array_equal(array, value)
        self.assertIn("x", record)
        self.assertNotIn("y", record)
        self.assertNotIn(3, record)
        self.assertIsNone(record.get("y"))
        with self.assertRaisesRegex(KeyError, "expected one of x, u"):
            record["y"]

    def test_arrays_are_views_that_keep_the_record_alive(self):
        record = ramp()
        self.assertEqual(record["x"].ctypes.data, record["x"].ctypes.data)
        self.assertFalse(record["x"].flags.writeable)
        array, wanted = record["u"], record["u"].copy()
        del record
        gc.collect()
        np.testing.assert_array_equal(array, wanted)

    def test_does_not_share_memory_with_what_it_was_made_from(self):
        samples = np.zeros(5)
        record = mjdiag.Record({"x": samples}, {"x": "m"}, 1.0)
        samples[:] = 1.0
        self.assertEqual(record["x"].max(), 0.0)

    def test_comes_back_from_files_bitwise(self):
        record = ramp(start_time=0.5)
        for name in ("a.csv", "a.mat"):
            record.write(name)
            back = mjdiag.Record.read(name)
            self.assertEqual(back.units, record.units)
            self.assertEqual(back.sample_time, record.sample_time)
            for channel in record:
                np.testing.assert_array_equal(back[channel], record[channel])

    def test_is_pickled_and_copied(self):
        mask = np.arange(11) < 5
        record = ramp(measured={"x": mask})
        for twin in (pickle.loads(pickle.dumps(record)), copy.deepcopy(record)):
            np.testing.assert_array_equal(twin["x"], record["x"])
            np.testing.assert_array_equal(twin.measured["x"], mask)
            self.assertEqual(list(twin.measured), ["x"])

    def test_takes_lists_and_strided_arrays(self):
        table = np.arange(10).reshape(5, 2)
        record = mjdiag.Record({"a": table[:, 1], "b": [1, 2, 3, 4, 5]},
                               {"a": "1", "b": "1"}, 1.0)
        np.testing.assert_array_equal(record["a"], [1, 3, 5, 7, 9])

    def test_refuses_what_does_not_fit_in_one_line(self):
        def make(data, units=None, time=1.0, **options):
            units = {"x": "m"} if units is None else units
            return lambda: mjdiag.Record(data, units, time, **options)

        self.assertRefuses(make({"x": np.zeros((3, 2))}), '"x"', "(3, 2)", "(n,)")
        self.assertRefuses(make({"x": np.array(["a"])}), '"x"', "dtype <U1")
        self.assertRefuses(make({"x": np.zeros(3, complex)}), '"x"', "complex128")
        self.assertRefuses(make({"x": [[1], [2, 3]]}), '"x"')
        self.assertRefuses(make({"x": [0.0, np.nan]}), '"x"', "NaN at sample 1")
        self.assertRefuses(make({"x": [np.inf, 0.0]}), '"x"', "infinity at sample 0")
        self.assertRefuses(make({"x": [0.0]}, {"x": "parsec"}), '"x"', "parsec")
        self.assertRefuses(make({"x": [0.0]}, {"x": 3}), '"x"', "3")
        self.assertRefuses(make({"x": [0.0]}, {}), 'no unit for channel "x"')
        self.assertRefuses(make({"x": [0.0]}, {"x": "m", "y": "m"}), "'y'")
        self.assertRefuses(make({"x": [0.0], "y": [0, 1]}, {"x": "m", "y": "m"}), '"y"')
        self.assertRefuses(make({"x": [0.0]}, time=0.0), "sample time")
        self.assertRefuses(make([1, 2]), "a list")
        self.assertRefuses(make({1: [0.0]}, {}), "1")
        self.assertRefuses(make({"x": [0.0]}, measured={"x": [1.0]}), "bool")
        self.assertRefuses(lambda: mjdiag.Record.read("none.csv"), "none.csv")
        self.assertRefuses(lambda: mjdiag.Record.read(3), "int")
        self.assertRefuses(lambda: ramp().write("a.xlsx"), "a.xlsx", ".csv or .mat")

    def test_goes_to_pandas_and_back(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("needs pandas")
        record = ramp(start_time=1.0)
        frame = record.to_pandas()
        self.assertEqual(list(frame.columns), ["x", "u"])
        self.assertEqual(frame.attrs["units"], record.units)
        for again in (mjdiag.Record.from_pandas(frame),
                      mjdiag.Record.from_pandas(frame, units=record.units),
                      mjdiag.Record.from_pandas(
                          frame.set_index(pandas.to_timedelta(frame.index, unit="s")))):
            self.assertEqual(again.sample_time, record.sample_time)
            self.assertEqual(again.start_time, record.start_time)
            np.testing.assert_array_equal(again["x"], record["x"])
        uneven = frame.iloc[[0, 1, 3]]
        self.assertRefuses(lambda: mjdiag.Record.from_pandas(uneven), "row")
        bare = pandas.DataFrame({"x": [0.0, 1.0]})
        self.assertRefuses(lambda: mjdiag.Record.from_pandas(bare), "no units")
        self.assertEqual(
            mjdiag.Record.from_pandas(bare, {"x": "m"}, sample_time=0.1).sample_time, 0.1)

    def test_says_that_pandas_is_missing(self):
        try:
            import pandas  # noqa: F401
            self.skipTest("pandas is there")
        except ImportError:
            pass
        with self.assertRaisesRegex(ImportError, "pandas is not installed"):
            ramp().to_pandas()
        self.assertRefuses(lambda: mjdiag.Record.from_pandas({}), "dict", "DataFrame")

    def test_is_drawn_channel_by_channel(self):
        record, axes = ramp(), [mock.Mock(), mock.Mock()]
        self.assertIs(record.plot(axes=axes), axes)
        np.testing.assert_array_equal(axes[0].plot.call_args[0][1], record["x"])
        axes[1].set_ylabel.assert_called_with("u [N]")
        axes[1].set_xlabel.assert_called_with("time [s]")
        self.assertEqual(len(record.plot("u", axes=axes[:1])), 1)
        with self.assertRaises(KeyError):
            record.plot("y", axes=axes)
        with mock.patch.dict(sys.modules, {"matplotlib": None}):
            with self.assertRaisesRegex(ImportError, "matplotlib is not installed"):
                record.plot()

    def test_slice_has_its_own_time(self):
        part = current(0.01).slice(10, 5)
        self.assertEqual(part.samples, 5)
        self.assertAlmostEqual(part.start_time, 10 / 5000)


if __name__ == "__main__":
    unittest.main()
