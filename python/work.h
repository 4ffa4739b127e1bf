#pragma once
// What a machine is asked to do and takes long: each as one call, from Python's arguments
// to the result, told and ended as RunLong says.

#include <pybind11/pybind11.h>

#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "mjdiag/render/clip.h"
#include "mjdiag/signals/record.h"
#include "python/diagnosis.h"
#include "python/discovery.h"
#include "python/machine.h"
#include "python/tolerance.h"

namespace mjdiag::python {

/// Name, value and time [s] of each.
using GivenLateFaults = std::vector<std::tuple<std::string, double, double>>;
std::vector<LateFault> LateFaultsOf(const GivenLateFaults& given);
/// Record of a `replay` argument, which the caller holds; null of None. InputError.
const Record* ReplayOf(const pybind11::object& replay);

/// What moves a machine, and how.
struct RunRequest {
  std::string trajectory;          ///< empty: the default one of the setup
  const Record* replay = nullptr;  ///< motion or inputs of this record
  std::optional<double> duration;  ///< [s]
  std::string mode = "both";
  double noise = 1.0;  ///< times that of the sensors
  std::uint64_t seed = 1;
  bool linear = false;
  bool log_joints = false;
  std::vector<LateFault> late_faults;
};

Record SimulateMachine(const MachineObject& machine, const RunRequest& request,
                       const pybind11::object& progress);

/// Of the machine beside another one, or beside a record of it; none: alone.
ClipSummary RenderMachine(const MachineObject& machine, const pybind11::object& other,
                          const pybind11::object& path, const RunRequest& request,
                          ClipOptions options, const pybind11::object& progress);

MachineObject CalibrateMachine(const MachineObject& machine,
                               const pybind11::object& records, bool linear,
                               const pybind11::object& progress);

/// @param data   folder of the records, if `records` is a manifest; else None
/// @param doubt  as in DiscoverOptions; none: unless the plant says that it is exact
DiscoveryObject DiscoverCauses(const MachineObject& machine,
                               const pybind11::object& records,
                               const pybind11::object& data,
                               const pybind11::object& validation,
                               DiscoverOptions options, std::optional<bool> doubt,
                               const pybind11::object& progress);

/// @param machine  the healthy one
/// @param worn     the one that runs; None: that, too
TolerantRunObject TolerateMachine(const MachineObject& machine,
                                  const pybind11::object& worn,
                                  const RunRequest& request,
                                  const DiagnoseRequest& diagnosis,
                                  const pybind11::object& progress);

/// "healthy", or what was put into it: "zeta_x = 1.2, coulomb_friction at X".
std::string Described(const MachineObject& machine);

/// Methods of Machine for all of that.
void BindMachineWork(pybind11::class_<MachineObject>& machine);
/// Those that compare, excite, design and tolerate.
void BindMachineDesign(pybind11::class_<MachineObject>& machine);

}  // namespace mjdiag::python
