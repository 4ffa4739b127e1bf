// Machine: what it says of a record, of motions and of its own diagnosis.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>

#include "python/comparison.h"
#include "python/excitation.h"
#include "python/filter_design.h"
#include "python/joint_excitation.h"
#include "python/machine.h"
#include "python/tolerance.h"
#include "python/work.h"

namespace mjdiag::python {

namespace py = pybind11;

namespace {

FilterDesignObject DoDesign(const MachineObject& machine, const std::string& method,
                            bool linear, const py::object& filters, bool baseline,
                            const std::string& robust, int nominal_runs,
                            const py::object& progress) {
  return DesignMachine(machine, method,
                       RequestOf(linear, filters, baseline, robust, nominal_runs),
                       progress);
}

TolerantRunObject DoTolerate(const MachineObject& machine, const py::object& worn,
                             std::uint64_t seed, const std::string& trajectory,
                             const py::object& replay, std::optional<double> duration,
                             const std::string& mode, double noise, bool linear,
                             bool log_joints, const GivenLateFaults& late,
                             const py::object& filters, bool baseline,
                             const std::string& robust, int nominal_runs,
                             const py::object& progress) {
  return TolerateMachine(machine, worn,
                         {trajectory, ReplayOf(replay), duration, mode, noise, seed,
                          linear, log_joints, LateFaultsOf(late)},
                         RequestOf(linear, filters, baseline, robust, nominal_runs),
                         progress);
}

using MachineClass = py::class_<MachineObject>;

void BindCompare(MachineClass& machine) {
  machine.def("compare", &CompareRecord, py::arg("record"), py::kw_only(),
              py::arg("open_loop") = false, py::arg("seed") = 1,
              py::arg("progress") = py::none(),
              R"(
              What the simulation gets wrong on a measured record: a Comparison.

              record: a Record, or the path of a measured file. Its reference is followed,
              or its inputs are applied where the machine has no controllers.
              open_loop: its inputs are applied, whatever controllers there are.
              seed: of the noise floor.
              progress: as of simulate.

              InputError: a record that lacks what has to be replayed, or every sensor, or
              has another sample time.)");
}

void BindExcite(MachineClass& machine) {
  machine.def("excite", &ExciteMachine, py::arg("wanted") = py::tuple(), py::kw_only(),
              py::arg("limits") = py::none(), py::arg("max_frequency") = py::none(),
              py::arg("name") = MotionDesignOptions{}.name,
              py::arg("budget") = py::none(), py::arg("progress") = py::none(),
              R"(
              A motion within the limits of the axes, as long as the default one, whose
              run tells most of what is wanted: a MotionDesign (docs/excite.md).

              wanted: fault parameters, or numbers of the plant ("mass@x_stage"), a name
              or a list of names; none: all fault parameters.
              limits: axis -> dict of lowest, highest [m or rad], velocity, acceleration,
              jerk, snap and force [N or N m], in the place of what the default motion
              does: {"x": {"velocity": 0.3}}.
              max_frequency: of a tone [Hz]; None: a quarter of the control rate.
              name: of the trajectory.
              budget: seconds of work after which no further motion is tried, None: all
              are; then, and at Ctrl-C, the best motion so far is given
              (MotionDesign.stopped).
              progress: as of simulate.

              InputError: a machine without controllers or trajectory, names that there
              are not, limits that not even a rest keeps, a trajectory of that name.
              NumericalError if the default motion does not tell the unknowns apart.)");
  machine.def("excite_joints", &ExciteJoints, py::arg("record"), py::kw_only(),
              py::arg("limits") = py::none(), py::arg("max_frequency") = py::none(),
              py::arg("budget") = py::none(), py::arg("progress") = py::none(),
              R"(
              Of a machine whose controllers are not known, an arm: a motion of its joints
              within the limits of a measured one and as long as that, along which the
              forces tell inertial and friction numbers apart best: a JointMotionDesign
              (docs/excite.md).

              record: measured, with what drove the joints, a Record or a path.
              limits: joint -> dict of lowest, highest [m or rad], velocity, acceleration
              and force [N or N m], in the place of what the measured motion does.
              max_frequency: of the Fourier series [Hz]; None: what suits that motion.
              budget: seconds of work after which no further motion is tried, None: all
              are; then, and at Ctrl-C, the best motion so far is given
              (JointMotionDesign.stopped).
              progress: as of simulate.

              InputError: joints that there are not, limits that cannot be kept, a record
              that does not say where the joints are. NumericalError if the measured motion
              does not tell the numbers apart.)");
}

void BindDesign(MachineClass& machine) {
  machine.def("design", &DoDesign, py::kw_only(), py::arg("method") = "svd",
              py::arg("linear") = false, py::arg("filters") = py::none(),
              py::arg("baseline") = false, py::arg("robust") = "",
              py::arg("nominal_runs") = NominalRuns{}.runs,
              py::arg("progress") = py::none(),
              R"(
              Residual filters, prefilters and limits of this machine as the healthy one:
              a FilterDesign.

              method: "svd"; "lp": the linear programs for a parity relation are solved,
              too, and told (FilterDesign.linear_program); the filters are the same.
              linear, filters, robust, nominal_runs: as of diagnose.
              baseline: limits less the residual of healthy runs of the default motion.
              progress: as of simulate.

              InputError: a machine without [diagnosis] or parity relations.)");
}

void BindTolerate(MachineClass& machine) {
  machine.def(
      "tolerate", &DoTolerate, py::arg("worn") = py::none(), py::kw_only(),
      py::arg("seed") = 1, py::arg("trajectory") = "", py::arg("replay") = py::none(),
      py::arg("duration") = py::none(), py::arg("mode") = "both",
      py::arg("noise") = 1.0, py::arg("linear") = false, py::arg("log_joints") = false,
      py::arg("late_faults") = GivenLateFaults(), py::arg("filters") = py::none(),
      py::arg("baseline") = false, py::arg("robust") = "",
      py::arg("nominal_runs") = NominalRuns{}.runs, py::arg("progress") = py::none(),
      R"(
              A run of a worn machine with a diagnosis in it that corrects the
              controllers: a TolerantRun.

              worn: the Machine that runs, this one with faults and effects; None: this
              one, for late_faults. The diagnosis and what acts on it know this one only.
              seed, trajectory, replay, duration [s], mode, noise, log_joints,
              late_faults: of the run, as of simulate.
              linear: both the run and the diagnosis, as of simulate and diagnose.
              filters, baseline, robust, nominal_runs: of the diagnosis, as of diagnose.
              progress: as of simulate.

              Ctrl-C raises KeyboardInterrupt. InputError: a machine without controllers,
              with nothing that may wear, whose diagnosis has no twin, or a worn one with
              other channels. NumericalError if the run diverges.)");
}

}  // namespace

void BindMachineDesign(MachineClass& machine) {
  BindCompare(machine);
  BindExcite(machine);
  BindDesign(machine);
  BindTolerate(machine);
}

}  // namespace mjdiag::python
