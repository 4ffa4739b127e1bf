#include "python/arrays.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "mjdiag/signals/error.h"

namespace mjdiag::python {
namespace {

namespace py = pybind11;

py::array ReadOnly(py::array array) {
  array.attr("flags").attr("writeable") = false;
  return array;
}

std::string ShapeText(const py::array& array) {
  return py::str(py::tuple(array.attr("shape")));
}

/// Anything as a one-dimensional array of that type, without converting what has no
/// numbers in it.
py::array Converted(py::handle object, const std::string& what, const char* kinds,
                    const char* expected, const char* type) {
  const py::object numpy = py::module_::import("numpy");
  py::object made;
  try {
    made = numpy.attr("asarray")(object);
  } catch (const py::error_already_set&) {
    throw InputError(what, "no array can be made of it", expected);
  }
  const auto array = py::cast<py::array>(made);
  const std::string kind = py::str(made.attr("dtype").attr("kind"));
  if (std::string(kinds).find(kind) == std::string::npos) {
    throw InputError(
        what, "values of dtype " + std::string(py::str(made.attr("dtype"))), expected);
  }
  if (array.ndim() != 1) {
    throw InputError(what, "an array of shape " + ShapeText(array),
                     std::string(expected) + " of shape (n,)");
  }
  return made.attr("astype")(type);
}

double NumberOf(py::handle value, const std::string& what, const std::string& name) {
  const double number = PyFloat_AsDouble(value.ptr());
  if (PyErr_Occurred() == nullptr) return number;
  PyErr_Clear();
  throw InputError(what + " " + name, KindOf(value), "a number");
}

}  // namespace

py::array_t<double> View(const Eigen::VectorXd& values, py::handle owner) {
  return ReadOnly(py::array(py::dtype::of<double>(), {values.size()}, {sizeof(double)},
                            values.data(), owner));
}

py::array_t<double> View(const Eigen::MatrixXd& values, py::handle owner) {
  const auto size = static_cast<py::ssize_t>(sizeof(double));
  return ReadOnly(py::array(py::dtype::of<double>(), {values.rows(), values.cols()},
                            {size, size * values.rows()}, values.data(), owner));
}

py::array_t<double> Copy(const Eigen::VectorXd& values) {
  return py::array_t<double>(values.size(), values.data());
}

py::array_t<double> Copy(const Eigen::MatrixXd& values) {
  const auto size = static_cast<py::ssize_t>(sizeof(double));
  return {{values.rows(), values.cols()}, {size, size * values.rows()}, values.data()};
}

py::array Copy(const SampleMask& values) {
  return {py::dtype::of<bool>(), {values.size()}, values.data()};
}

Eigen::VectorXd VectorOf(py::handle object, const std::string& what) {
  std::size_t size = 0;
  const double* data = DataOf(object, &size);
  py::array kept;
  if (data == nullptr) {
    kept = Converted(object, what, "fiu", "an array of real numbers", "float64");
    data = static_cast<const double*>(kept.data());
    size = static_cast<std::size_t>(kept.size());
  }
  const Eigen::Map<const Eigen::VectorXd> values(data, static_cast<Eigen::Index>(size));
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    if (std::isfinite(values[k])) continue;
    const char* name = std::isnan(values[k]) ? "NaN" : "infinity";
    throw InputError(what, std::string(name) + " at sample " + std::to_string(k),
                     "finite numbers");
  }
  return values;
}

SampleMask MaskOf(py::handle object, const std::string& what) {
  const py::array kept = Converted(object, what, "b", "an array of bool", "bool");
  return Eigen::Map<const SampleMask>(static_cast<const bool*>(kept.data()),
                                      kept.size());
}

const double* DataOf(py::handle object, std::size_t* size) noexcept {
  if (!py::detail::npy_api::get().PyArray_Check_(object.ptr())) return nullptr;
  const auto* array = py::detail::array_proxy(object.ptr());
  const auto* type = py::detail::array_descriptor_proxy(array->descr);
  const bool is_plain =
      array->nd == 1 && type->type == 'd' && type->byteorder != '>' &&
      (array->flags & py::detail::npy_api::NPY_ARRAY_C_CONTIGUOUS_) != 0 &&
      (array->flags & py::detail::npy_api::NPY_ARRAY_ALIGNED_) != 0;
  if (!is_plain) return nullptr;
  *size = static_cast<std::size_t>(array->dimensions[0]);
  return reinterpret_cast<const double*>(array->data);
}

std::map<std::string, double> NumbersOf(const py::kwargs& values,
                                        const std::string& what) {
  std::map<std::string, double> numbers;
  for (const auto& [key, value] : values) {
    const std::string name = py::str(key);
    numbers[name] = NumberOf(value, what, name);
  }
  return numbers;
}

std::string KindOf(py::handle object) {
  return "a " + std::string(py::str(py::type::of(object).attr("__name__")));
}

std::string Digits(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

}  // namespace mjdiag::python
