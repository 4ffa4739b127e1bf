#pragma once
// numpy arrays in and out. Out: views of what a C++ object holds, read-only, which keep the
// Python object that owns it alive. In: a float64 array as it is, anything else that numpy
// can make one of, or InputError in one line that says which argument, what is wrong with
// it and what was expected. And how other values are called in such lines.

#include <pybind11/numpy.h>

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "mjdiag/signals/record.h"

namespace mjdiag::python {

/// A read-only view, of shape (n,) or (rows, columns).
/// @param owner  the Python object that holds the values
pybind11::array_t<double> View(const Eigen::VectorXd& values, pybind11::handle owner);
pybind11::array_t<double> View(const Eigen::MatrixXd& values, pybind11::handle owner);
/// An array of its own.
pybind11::array_t<double> Copy(const Eigen::VectorXd& values);
pybind11::array_t<double> Copy(const Eigen::MatrixXd& values);
pybind11::array Copy(const SampleMask& values);

/// The finite numbers of a one-dimensional array. InputError begins with `what`.
Eigen::VectorXd VectorOf(pybind11::handle array, const std::string& what);
/// The truth values of one.
SampleMask MaskOf(pybind11::handle array, const std::string& what);

/// The numbers of a float64 array without gaps between them, where they lie; null for
/// anything else, which VectorOf copies. For what is called thousands of times a second.
const double* DataOf(pybind11::handle array, std::size_t* size) noexcept;

/// Numbers by name, of keyword arguments. InputError begins with `what` and the name.
std::map<std::string, double> NumbersOf(const pybind11::kwargs& values,
                                        const std::string& what);

/// "a str", of what is no such thing as was expected, for messages.
std::string KindOf(pybind11::handle object);
/// Up to six significant digits: "1.2". Without Python.
std::string Digits(double value);

}  // namespace mjdiag::python
