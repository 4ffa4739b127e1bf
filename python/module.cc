// The module: its exceptions, and all classes.

#include <pybind11/pybind11.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>

#include "mjdiag/signals/error.h"
#include "python/bindings.h"

namespace mjdiag::python {
namespace {

namespace py = pybind11;

/// Messages are one line, whatever they quote.
void Raise(const py::object& type, std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  PyErr_SetString(type.ptr(), message.c_str());
}

/// A subclass of one of Python's errors. It lives as long as the process does.
py::object& NewError(py::module_& module, const char* name, PyObject* base,
                     const char* doc) {
  const std::string full = std::string("mjdiag.") + name;
  auto* type = new py::object(py::reinterpret_steal<py::object>(
      PyErr_NewExceptionWithDoc(full.c_str(), doc, base, nullptr)));
  module.attr(name) = *type;
  return *type;
}

void BindErrors(py::module_& module) {
  static const py::object& input_error =
      NewError(module, "InputError", PyExc_ValueError,
               "Bad input. The message is one line: where, what is wrong there, and "
               "what was expected.");
  static const py::object& numerical_error =
      NewError(module, "NumericalError", PyExc_ArithmeticError,
               "The input was good and the computation failed on it: diverged, "
               "singular, not converged.");
  py::register_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(std::move(pointer));
    } catch (const InputError& error) {
      Raise(input_error, error.what());
    } catch (const std::filesystem::filesystem_error& error) {
      Raise(input_error, error.what());
    } catch (const NumericalError& error) {
      Raise(numerical_error, error.what());
    }
  });
}

}  // namespace
}  // namespace mjdiag::python

PYBIND11_MODULE(_mjdiag, module) {
  module.attr("__version__") = MJDIAG_VERSION;
  mjdiag::python::BindErrors(module);
  mjdiag::python::BindRecord(module);
  mjdiag::python::BindLinear(module);
  mjdiag::python::BindDiagnosis(module);
  mjdiag::python::BindDiscovery(module);
  mjdiag::python::BindComparison(module);
  mjdiag::python::BindFilterDesign(module);
  mjdiag::python::BindTolerance(module);
  mjdiag::python::BindExcitation(module);
  mjdiag::python::BindJointExcitation(module);
  mjdiag::python::BindMachine(module);
  mjdiag::python::BindMonitor(module);
  mjdiag::python::BindStudy(module);
}
