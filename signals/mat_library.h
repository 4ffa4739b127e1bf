#pragma once
// matio's files and variables, closed and freed again.

#include <matio.h>

#include <memory>
#include <string_view>

namespace mjdiag {

constexpr std::string_view kMatTime = "time";
/// Structs with a text a variable: its unit, and the name of its channel.
constexpr std::string_view kMatUnits = "units";
constexpr std::string_view kMatNames = "names";

struct MatFileDeleter {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct MatVariableDeleter {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using MatFilePtr = std::unique_ptr<mat_t, MatFileDeleter>;
using MatVariablePtr = std::unique_ptr<matvar_t, MatVariableDeleter>;

}  // namespace mjdiag
