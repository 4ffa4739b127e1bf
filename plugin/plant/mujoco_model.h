#pragma once
// Ownership of mjModel and mjData, and MuJoCo's errors as exceptions.

#include <mujoco/mujoco.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

namespace mjdiag {

/// Gives a model back: its memory serves the next copy of one of the same sizes.
struct ModelDeleter {
  void operator()(mjModel* model) const;
};
struct DataDeleter {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using ModelPtr = std::unique_ptr<mjModel, ModelDeleter>;
using DataPtr = std::unique_ptr<mjData, DataDeleter>;

/// Loads and compiles an MJCF file, or a URDF as MuJoCo reads it: without actuators and
/// sensors. InputError with file and line of what MuJoCo rejects, or with all that a newer
/// MuJoCo would have known (newer_mjcf.h). From then on errors inside MuJoCo (mju_error) throw NumericalError instead
/// of ending the process, and its warnings are neither printed nor logged.
ModelPtr LoadModel(const std::filesystem::path& mjcf);
ModelPtr CopyModel(const mjModel& model);
DataPtr MakeData(const mjModel& model);

/// mj_name2id that fails with InputError("<model>: no <kind> named ..., expected one of
/// ...") instead of returning -1; where there are none, it says so.
int FindElement(const mjModel& model, mjtObj kind, const std::string& name);
/// Where row `row` of an array of mjModel or mjData begins, of `width` numbers each.
template <typename Number>
Number* RowOf(Number* array, int width, int row) {
  return array + static_cast<std::ptrdiff_t>(width) * row;
}
/// Name of an element, or "<kind> <id>" for a nameless one.
std::string ElementName(const mjModel& model, mjtObj kind, int id);

}  // namespace mjdiag
