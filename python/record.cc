// Record: a mapping of arrays, in and out of files and pandas.

#include "python/record.h"

#include <pybind11/stl.h>

#include <cmath>
#include <optional>
#include <utility>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/record_file.h"
#include "mjdiag/signals/uniform_time.h"
#include "mjdiag/signals/unit.h"
#include "python/arrays.h"
#include "python/bindings.h"

namespace mjdiag::python {

namespace py = pybind11;

bool IsPath(py::handle object) {
  return py::isinstance<py::str>(object) || py::hasattr(object, "__fspath__");
}

py::object Library(const char* name, const std::string& for_what) {
  try {
    return py::module_::import(name);
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_ImportError)) throw;
    PyErr_SetString(PyExc_ImportError,
                    (for_what + ": " + name + " is not installed").c_str());
    throw py::error_already_set();
  }
}

std::filesystem::path PathOf(py::handle path, const std::string& what) {
  if (!IsPath(path)) {
    throw InputError(what, KindOf(path), "a path");
  }
  const py::object text = py::module_::import("os").attr("fspath")(path);
  return py::cast<std::string>(text);
}

void Warn(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) {
    if (PyErr_WarnEx(PyExc_UserWarning, note.c_str(), 1) != 0) {
      throw py::error_already_set();
    }
  }
}

namespace {

/// A mapping, or InputError.
py::dict DictOf(const py::object& object, const std::string& what,
                const char* expected) {
  if (!py::hasattr(object, "keys")) {
    throw InputError(what, KindOf(object), expected);
  }
  return py::reinterpret_borrow<py::object>((PyObject*)&PyDict_Type)(object);
}

std::string NameOf(py::handle name) {
  if (py::isinstance<py::str>(name)) return py::cast<std::string>(name);
  throw InputError("record", "a channel called " + std::string(py::repr(name)),
                   "names that are str");
}

std::string Named(const std::string& name) {
  return "record: channel \"" + name + "\"";
}

/// The unit that was given for a channel.
Unit UnitOf(const py::dict& units, const std::string& name) {
  if (!units.contains(name)) {
    throw InputError("record", "no unit for channel \"" + name + "\"",
                     R"(one in units, "1" for pure numbers)");
  }
  const py::object unit = units[name.c_str()];
  if (!py::isinstance<py::str>(unit)) {
    throw InputError(Named(name), "the unit is " + std::string(py::repr(unit)),
                     "a text such as \"m\"");
  }
  try {
    return ParseUnit(py::cast<std::string>(unit));
  } catch (const InputError& error) {
    throw InputError(Named(name) + ": " + error.what());
  }
}

void RefuseUnknown(const py::dict& named, const py::dict& data, const char* what) {
  for (const auto& [name, value] : named) {
    if (data.contains(name)) continue;
    throw InputError("record",
                     std::string(what) + " for " + std::string(py::repr(name)) +
                         ", which is no channel",
                     "names of data");
  }
}

Record MakeRecord(const py::object& data, const py::object& units, double sample_time,
                  double start_time, const py::object& measured) {
  const py::dict columns = DictOf(data, "record: data", "a mapping of names to arrays");
  const py::dict unit_of =
      DictOf(units, "record: units", "a mapping of names to units");
  const py::dict masks = measured.is_none()
                             ? py::dict()
                             : DictOf(measured, "record: measured",
                                      "a mapping of names to arrays of bool");
  RefuseUnknown(unit_of, columns, "a unit");
  RefuseUnknown(masks, columns, "measured samples");
  Record record(sample_time, start_time);
  for (const auto& [key, array] : columns) {
    const std::string name = NameOf(key);
    const Unit unit = UnitOf(unit_of, name);
    Channel channel{name, unit.si, VectorOf(array, Named(name))};
    if (unit.factor != 1.0) channel.samples *= unit.factor;
    if (masks.contains(key)) channel.measured = MaskOf(masks[key], Named(name));
    record.Add(std::move(channel));
  }
  return record;
}

py::dict UnitsOf(const Record& record) {
  py::dict units;
  for (const Channel& channel : record.channels()) {
    units[channel.name.c_str()] = channel.unit;
  }
  return units;
}

py::array ArrayOf(const py::object& self, const std::string& name) {
  const auto& record = py::cast<const Record&>(self);
  if (const Channel* channel = record.Find(name)) return View(channel->samples, self);
  std::string known;
  for (const Channel& channel : record.channels()) {
    known += (known.empty() ? "" : ", ") + channel.name;
  }
  throw py::key_error("record: no channel \"" + name + "\"; expected one of " + known);
}

py::dict MasksOf(const Record& record) {
  py::dict masks;
  for (const Channel& channel : record.channels()) {
    if (channel.measured.size() > 0) {
      masks[channel.name.c_str()] = Copy(channel.measured);
    }
  }
  return masks;
}

py::list NamesOf(const Record& record) {
  py::list names;
  for (const Channel& channel : record.channels()) names.append(channel.name);
  return names;
}

py::list ArraysOf(const py::object& self, bool with_names) {
  py::list arrays;
  for (const Channel& channel : py::cast<const Record&>(self).channels()) {
    const py::array array = View(channel.samples, self);
    if (with_names) {
      arrays.append(py::make_tuple(channel.name, array));
    } else {
      arrays.append(array);
    }
  }
  return arrays;
}

py::object ToPandas(const py::object& self) {
  const py::object pandas = Library("pandas", "Record.to_pandas");
  const auto& record = py::cast<const Record&>(self);
  py::dict columns;
  for (const Channel& channel : record.channels()) {
    columns[channel.name.c_str()] = View(channel.samples, self);
  }
  py::object frame = pandas.attr("DataFrame")(
      columns, py::arg("index") = pandas.attr("Index")(Copy(record.Time()),
                                                       py::arg("name") = "time [s]"));
  frame.attr("attrs")["units"] = UnitsOf(record);
  return frame;
}

/// The times of a frame: those of its index, in seconds.
UniformTime TimeOf(const py::object& index) {
  const std::string kind = py::str(index.attr("dtype").attr("kind"));
  const py::object seconds = kind == "m" ? py::object(index.attr("total_seconds")())
                                         : py::object(index.attr("to_numpy")());
  return FitUniformTime(VectorOf(seconds, "frame: the index"), [](Eigen::Index k) {
    return "frame: row " + std::to_string(k);
  });
}

Record FromPandas(const py::object& frame, const py::object& units,
                  const std::optional<double>& sample_time) {
  if (!py::hasattr(frame, "index") || !py::hasattr(frame, "columns")) {
    throw InputError("frame", KindOf(frame), "a pandas.DataFrame");
  }
  py::object unit_of = units;
  if (unit_of.is_none()) {
    const py::object attributes = frame.attr("attrs");
    if (!attributes.contains("units")) {
      throw InputError("frame", "no units", "units=, or attrs[\"units\"]");
    }
    unit_of = attributes["units"];
  }
  py::dict columns;
  for (const py::handle name : frame.attr("columns")) {
    columns[name] = frame[py::reinterpret_borrow<py::object>(name)].attr("to_numpy")();
  }
  const UniformTime time =
      sample_time ? UniformTime{0.0, *sample_time} : TimeOf(frame.attr("index"));
  return MakeRecord(columns, unit_of, time.sample_time, time.start, py::none());
}

void Write(const Record& record, const py::object& path) {
  const std::filesystem::path file = PathOf(path, "Record.write");
  const std::string ending = file.extension().string();
  if (ending != ".csv" && ending != ".mat") {
    throw InputError(file.string(), "a record in no known format", ".csv or .mat");
  }
  const py::gil_scoped_release others_run;
  WriteRecord(file, record,
              ending == ".csv" ? RecordFormat::kCsv : RecordFormat::kMat5);
}

Record Read(const py::object& path) {
  const std::filesystem::path file = PathOf(path, "Record.read");
  const py::gil_scoped_release others_run;
  return ReadRecord(file);
}

/// All of it, for pickle and copy.
py::tuple StateOf(const py::object& self) {
  const auto& record = py::cast<const Record&>(self);
  py::dict data;
  for (const Channel& channel : record.channels()) {
    data[channel.name.c_str()] = Copy(channel.samples);
  }
  return py::make_tuple(data, UnitsOf(record), record.sample_time(),
                        record.start_time(), MasksOf(record));
}

std::string Text(const Record& record) {
  std::string text = "<mjdiag.Record: " + std::to_string(record.samples()) +
                     " samples every " +
                     std::string(py::str(py::float_(record.sample_time()))) + " s of";
  for (const Channel& channel : record.channels()) {
    text += (&channel == &record.channels().front() ? " " : ", ") + channel.name +
            " [" + channel.unit + "]";
  }
  return text + ">";
}

}  // namespace

void BindRecord(py::module_& module) {
  py::class_<Record>(module, "Record",
                     R"(
                     Named channels that were sampled together, at t[k] = start_time + k
                     sample_time, in SI units. A mapping of names to read-only float64
                     arrays of shape (samples,), which are views: they cost nothing and
                     keep the record alive. A record does not change; take
                     record["x"].copy() to work on.)")
      .def(py::init(&MakeRecord), py::arg("data"), py::arg("units"),
           py::arg("sample_time"), py::kw_only(), py::arg("start_time") = 0.0,
           py::arg("measured") = py::none(),
           R"(
           data: name -> array of shape (samples,), finite real numbers.
           units: name -> unit of every channel, such as "m", "um", "N m", "1"; values
           are converted to SI.
           sample_time: time between samples [s].
           start_time: of the first [s].
           measured: name -> array of bool, False where a sample only bridges those
           beside it and counts for nothing; channels left out were measured throughout.

           InputError: shapes, dtypes, units or names that do not fit; NaN, infinity.)")
      .def_static("read", &Read, py::arg("path"),
                  R"(
          The record in a CSV file with a header such as `time [s],x [um],u_x [N]`, or
          in a MAT file (v5, v7.3). For files with other names or gaps see Machine.read.
          InputError says file and line.)")
      .def("write", &Write, py::arg("path"),
           R"(
           Writes *.csv or *.mat (v5); read back it is the same to the last bit.
           InputError if the file cannot be written.)")
      .def_static("from_pandas", &FromPandas, py::arg("frame"),
                  py::arg("units") = py::none(), py::kw_only(),
                  py::arg("sample_time") = py::none(),
                  R"(
          frame: a DataFrame with a column for every channel; its index is the time,
          numbers in s or a TimedeltaIndex, uniform to 1 % of a sample.
          units: as of Record; None: those of frame.attrs["units"].
          sample_time: in the place of the index [s]. InputError as Record, and on times
          that are not uniform.)")
      .def("to_pandas", &ToPandas,
           R"(
           A DataFrame with a column for every channel over the time [s], with
           attrs["units"]. ImportError without pandas.)")
      .def("__getitem__", &ArrayOf, py::arg("name"),
           "The samples of a channel, read-only, of shape (samples,). KeyError.")
      .def("__contains__",
           [](const Record& record, const py::object& name) {
             return py::isinstance<py::str>(name) &&
                    record.Find(py::cast<std::string>(name)) != nullptr;
           })
      .def("__len__", [](const Record& record) { return record.channels().size(); })
      .def("__iter__", [](const Record& record) { return py::iter(NamesOf(record)); })
      .def("keys", &NamesOf, "Names of the channels, in their order.")
      .def(
          "values", [](const py::object& self) { return ArraysOf(self, false); },
          "Their arrays.")
      .def(
          "items", [](const py::object& self) { return ArraysOf(self, true); },
          "Pairs of name and array.")
      .def(
          "get",
          [](const py::object& self, const std::string& name,
             const py::object& fallback) -> py::object {
            if (py::cast<const Record&>(self).Find(name) == nullptr) return fallback;
            return ArrayOf(self, name);
          },
          py::arg("name"), py::arg("default") = py::none(),
          "The array of that name, or the default.")
      .def_property_readonly("units", &UnitsOf, "Name -> SI unit.")
      .def_property_readonly("measured", &MasksOf,
                             R"(
                             Name -> array of bool, of channels of which not every
                             sample was measured.)")
      .def_property_readonly("sample_time", &Record::sample_time,
                             "Time between samples [s].")
      .def_property_readonly("start_time", &Record::start_time,
                             "Time of the first sample [s].")
      .def_property_readonly("samples", &Record::samples, "Samples of every channel.")
      .def_property_readonly("duration", &Record::duration,
                             "samples * sample_time [s].")
      .def_property_readonly(
          "time", [](const Record& record) { return Copy(record.Time()); },
          "Time of every sample [s], of shape (samples,).")
      .def("slice", &Record::Slice, py::arg("first"), py::arg("count"),
           "Samples first .. first + count - 1 of every channel, as a record of its "
           "own.")
      .def(py::pickle(&StateOf,
                      [](const py::tuple& state) {
                        return MakeRecord(state[0], state[1],
                                          py::cast<double>(state[2]),
                                          py::cast<double>(state[3]), state[4]);
                      }))
      .def("__repr__", &Text);
}

}  // namespace mjdiag::python
