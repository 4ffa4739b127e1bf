// LinearModel: the linear equations of motion of a machine.

#include "python/linear.h"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "python/arrays.h"
#include "python/bindings.h"

namespace mjdiag::python {

namespace py = pybind11;

namespace {

py::object StateSpaceOf(const LinearObject& linear, bool continuous) {
  const StateSpace system =
      continuous ? ContinuousStateSpace(linear.model)
                 : TickModel(linear.model, linear.rates.step(), linear.rates.substeps);
  return py::module_::import("mjdiag").attr("StateSpace")(
      Copy(system.A), Copy(system.B), Copy(system.C), Copy(system.D),
      continuous ? py::object(py::none())
                 : py::object(py::float_(linear.rates.tick())));
}

py::list ModesOf(const LinearObject& linear) {
  const py::object make = py::module_::import("mjdiag").attr("Mode");
  py::list modes;
  for (const Mode& mode : Modes(linear.model)) {
    modes.append(make(mode.frequency, mode.damping_ratio, Copy(mode.shape)));
  }
  return modes;
}

/// A property that is a view of a matrix of the model.
template <Eigen::MatrixXd MechanicalModel::*Matrix>
py::array_t<double> MatrixOf(const py::object& self) {
  return View(py::cast<const LinearObject&>(self).model.*Matrix, self);
}

}  // namespace

void BindLinear(py::module_& module) {
  py::class_<LinearObject>(module, "LinearModel",
                           R"(
                           M q'' + D q' + K q = Gamma u, y = b.T q: a machine about its
                           rest, q the deviations of its n coordinates, u its m
                           inputs, y its p outputs, in SI units. Matrices are read-only
                           views.)")
      .def_property_readonly("M", &MatrixOf<&MechanicalModel::M>,
                             "Inertia, (n, n) [kg, kg m, kg m^2].")
      .def_property_readonly("D", &MatrixOf<&MechanicalModel::D>,
                             "Damping, (n, n) [N s/m, N m s/rad].")
      .def_property_readonly("K", &MatrixOf<&MechanicalModel::K>,
                             "Stiffness with that of gravity, (n, n) [N/m, N m/rad].")
      .def_property_readonly("Gamma", &MatrixOf<&MechanicalModel::Gamma>,
                             "Generalised force per unit of input, (n, m).")
      .def_property_readonly("b", &MatrixOf<&MechanicalModel::b>,
                             "Outputs, y = b.T q, (n, p).")
      .def_property_readonly(
          "coordinates",
          [](const LinearObject& linear) { return linear.model.coordinates; },
          "Names of the n coordinates.")
      .def_property_readonly(
          "inputs", [](const LinearObject& linear) { return linear.model.inputs; },
          "Names of the m actuator channels.")
      .def_property_readonly(
          "outputs", [](const LinearObject& linear) { return linear.model.outputs; },
          "Names of the p sensor channels.")
      .def_property_readonly("modes", &ModesOf,
                             R"(
          Modes by frequency, rigid ones left out: frequency [Hz], damping_ratio, shape
          (n,).)")
      .def("state_space", &StateSpaceOf, py::kw_only(), py::arg("continuous") = false,
           R"(
          x[k+1] = A x + B u, y = C x + D u with x = [q, q'] of shape (2 n,): the exact
          map of one control tick of dt seconds, as the controllers see the machine.
          continuous: x' = A x + B u, and dt is None. A named tuple (A, B, C, D, dt) as
          scipy.signal takes it: scipy.signal.dlsim(linear.state_space(), u).)")
      .def("__repr__", [](const LinearObject& linear) {
        return "<mjdiag.LinearModel: " +
               std::to_string(linear.model.coordinates.size()) + " coordinates, " +
               std::to_string(linear.model.inputs.size()) + " inputs, " +
               std::to_string(linear.model.outputs.size()) + " outputs>";
      });
}

}  // namespace mjdiag::python
