#pragma once
// The attributes of a result, from the description of its fields (signals/fields.h): names,
// docstrings, and types, which the stub is made from (stub.py).

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <Eigen/Core>
#include <functional>
#include <string>
#include <utility>

#include "mjdiag/signals/fields.h"
#include "python/arrays.h"

namespace pybind11::detail {

template <typename T>
struct type_caster<mjdiag::IfAny<T>> : optional_caster<mjdiag::IfAny<T>, T> {};

/// A dict in the order of the values.
template <typename T>
struct type_caster<mjdiag::Named<T>> {
  PYBIND11_TYPE_CASTER(mjdiag::Named<T>, const_name("Dict[str, ") +
                                             make_caster<T>::name + const_name("]"));

  static handle cast(const mjdiag::Named<T>& values, return_value_policy /*policy*/,
                     handle /*parent*/) {
    dict made;
    for (const auto& [name, one] : values) made[name.c_str()] = one;
    return made.release();
  }
};

}  // namespace pybind11::detail

namespace mjdiag::python {

/// As Python has it: arrays of numpy.
template <typename T>
T ForPython(T value) {
  return value;
}
inline pybind11::array_t<double> ForPython(const Eigen::VectorXd& value) {
  return Copy(value);
}
inline Named<pybind11::array_t<double>> ForPython(
    const Named<Eigen::VectorXd>& values) {
  Named<pybind11::array_t<double>> arrays;
  for (const auto& [name, value] : values) arrays.emplace_back(name, Copy(value));
  return arrays;
}

/// @param part  of what is bound, the result whose fields these are
template <typename T, typename Bound, typename Part = std::identity>
pybind11::class_<Bound>& BindFields(pybind11::class_<Bound>& bound, Part part = {}) {
  ForEachField<T>([&](const auto& field) {
    if constexpr (std::decay_t<decltype(field)>::kIsInPython) {
      const std::string unit = field.unit;
      const std::string text = field.text + (unit.empty() ? "" : " [" + unit + "]");
      bound.def_property_readonly(
          field.name,
          [get = field.get, part](const Bound& object) {
            return ForPython(
                std::decay_t<decltype(std::invoke(get, std::invoke(part, object)))>(
                    std::invoke(get, std::invoke(part, object))));
          },
          text.c_str());
    }
  });
  return bound;
}

}  // namespace mjdiag::python
