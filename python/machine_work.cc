// Machine: what can be asked of it.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/plugin/plant/linearize.h"
#include "mjdiag/signals/error.h"
#include "python/arrays.h"
#include "python/linear.h"
#include "python/machine.h"
#include "python/record.h"
#include "python/work.h"

namespace mjdiag::python {

namespace py = pybind11;

namespace {

Record DoSimulate(const MachineObject& machine, std::uint64_t seed,
                  const std::string& trajectory, const py::object& replay,
                  std::optional<double> duration, const std::string& mode, double noise,
                  bool linear, bool log_joints, const GivenLateFaults& late,
                  const py::object& progress) {
  return SimulateMachine(machine,
                         {trajectory, ReplayOf(replay), duration, mode, noise, seed,
                          linear, log_joints, LateFaultsOf(late)},
                         progress);
}

py::dict DoRender(const MachineObject& machine, const py::object& other,
                  const py::object& path, const std::string& trajectory,
                  const py::object& replay, std::optional<double> duration,
                  std::uint64_t seed, bool linear, std::optional<double> begin,
                  std::optional<double> end, double speed, double fps, int width,
                  int height, const std::string& camera, bool ghost,
                  const py::object& amplify, const py::object& progress) {
  ClipOptions options;
  options.picture.width = width;
  options.picture.height = height;
  options.picture.camera = camera;
  options.picture.begin = begin;
  options.picture.end = end;
  options.picture.ghost = ghost;
  options.speed = speed;
  options.fps = fps;
  if (py::isinstance<py::dict>(amplify)) {
    options.picture.amplify = NumbersOf(py::kwargs(amplify), "amplify");
  } else if (!amplify.is_none()) {
    options.picture.amplify_all = py::cast<double>(amplify);
  }
  RunRequest request;
  request.trajectory = trajectory;
  request.replay = ReplayOf(replay);
  request.duration = duration;
  request.seed = seed;
  request.linear = linear;
  const ClipSummary summary =
      RenderMachine(machine, other, path, request, options, progress);
  py::dict told;
  told["frames"] = summary.frames;
  told["codec"] = summary.codec;
  told["amplification"] = summary.amplification;
  return told;
}

DiagnosisObject DoDiagnose(const MachineObject& machine, const py::object& record,
                           bool linear, const py::object& filters, bool baseline,
                           const std::string& robust, int nominal_runs,
                           const py::object& progress) {
  machine.RequireQuiet("diagnose");
  const DiagnoseRequest request =
      RequestOf(linear, filters, baseline, robust, nominal_runs);
  MeasuredFile measured = MeasuredOf(machine.setup(), record, "diagnose");
  std::optional<DiagnosisObject> made;
  RunLong(progress, false, [&](LongCall& call) {
    made = DiagnoseRecord(machine, std::move(measured), request, call);
  });
  return std::move(*made);
}

DiscoveryObject DoDiscover(const MachineObject& machine, const py::object& records,
                           const py::object& validation, const py::object& data,
                           double budget, std::vector<std::string> only,
                           std::vector<std::string> without,
                           std::vector<std::string> known, std::optional<bool> doubt,
                           std::optional<int> most_causes, double train_share,
                           std::uint64_t seed, const py::object& progress) {
  DiscoverOptions options;
  options.budget = budget;
  options.choice.only = std::move(only);
  options.choice.without = std::move(without);
  options.known = std::move(known);
  options.most_causes = most_causes;
  options.train_share = train_share;
  options.seed = seed;
  if (!(train_share >= 0.1 && train_share <= 0.95)) {
    throw InputError("train_share", std::to_string(train_share), "0.1 to 0.95");
  }
  return DiscoverCauses(machine, records, data, validation, options, doubt, progress);
}

}  // namespace

void BindMachineWork(py::class_<MachineObject>& machine) {
  machine
      .def("simulate", &DoSimulate, py::kw_only(), py::arg("seed") = 1,
           py::arg("trajectory") = "", py::arg("replay") = py::none(),
           py::arg("duration") = py::none(), py::arg("mode") = "both",
           py::arg("noise") = 1.0, py::arg("linear") = false,
           py::arg("log_joints") = false, py::arg("late_faults") = GivenLateFaults(),
           py::arg("progress") = py::none(),
           R"(
          A run of the machine, as a Record at the control rate: references, sensors,
          actuators. The same seed gives the same bits.

          seed: of the sensor noise.
          trajectory: of the setup; "": its default one.
          replay: a Record whose references are followed, or, of a machine without
          controllers, whose inputs drive it.
          duration: of the run [s].
          mode: "both", "feedback" or "feedforward".
          noise: factor on that of the sensors.
          linear: of the linearised plant.
          log_joints: joints, too.
          late_faults: list of (name, value, time [s]) from which on they act.
          progress: a callable of (fraction, text); True: a bar of tqdm.

          Ctrl-C raises KeyboardInterrupt. InputError; NumericalError if it diverges.)")
      .def("diagnose", &DoDiagnose, py::arg("record"), py::kw_only(),
           py::arg("linear") = false, py::arg("filters") = py::none(),
           py::arg("baseline") = false, py::arg("robust") = "",
           py::arg("nominal_runs") = NominalRuns{}.runs,
           py::arg("progress") = py::none(),
           R"(
          What has worn, beside this machine as the healthy one: a Diagnosis.

          record: a Record, or the path of a measured file.
          linear: the machine is taken as linear.
          filters: filters.json of `mjdiag design`; None: made now, and kept for the
          next call.
          baseline: less the residual of healthy runs of the same motion.
          robust: fault for which the residual is the one that friction excites least.
          nominal_runs: healthy runs that limits come from.
          progress: as of simulate.

          InputError: channels or rates that do not fit, a machine without [diagnosis].)")
      .def("calibrate", &CalibrateMachine, py::arg("records"), py::kw_only(),
           py::arg("linear") = false, py::arg("progress") = py::none(),
           R"(
           How well the machine is known, from healthy runs: the Machine with what they
           say of its numbers, its noise and its limits, to diagnose with.

           records: list of Record or paths.
           linear: as of diagnose.
           progress: as of simulate.

           InputError: records that do not fit.)")
      .def("discover", &DoDiscover, py::arg("records"), py::kw_only(),
           py::arg("validation") = py::none(), py::arg("data") = py::none(),
           py::arg("budget") = 60.0, py::arg("only") = std::vector<std::string>(),
           py::arg("without") = std::vector<std::string>(),
           py::arg("known") = std::vector<std::string>(), py::arg("doubt") = py::none(),
           py::arg("most_causes") = py::none(),
           py::arg("train_share") = DiscoverOptions{}.train_share, py::arg("seed") = 1,
           py::arg("progress") = py::none(),
           R"(
           What the model gets wrong on measured records, and why: a Discovery.

           records: list of Record or paths; or the path of a manifest, *.toml, that
           lists files with what was set in each (docs/setup.md).
           validation: those of other motions, to which nothing is fitted.
           data: folder of the files of a manifest.
           budget: seconds; then the best answer so far is given, and so it is at Ctrl-C
           (Discovery.stopped).
           only, without: families, effects, effects at a site or fault parameters that
           may or may not be named.
           known: numbers of the plant that are as it says.
           doubt: whether the others may be wrong; None: unless the plant says that it is
           exact.
           most_causes: that are looked for; None: 8 for every degree of freedom.
           train_share: of a single record, that fits see.
           seed: of the noise floor.
           progress: as of simulate.

           InputError: records that cannot be judged, which says why.)")
      .def("render", &DoRender, py::arg("other"), py::arg("path"), py::kw_only(),
           py::arg("trajectory") = "", py::arg("replay") = py::none(),
           py::arg("duration") = 0.06, py::arg("seed") = 1, py::arg("linear") = false,
           py::arg("begin") = py::none(), py::arg("end") = py::none(),
           py::arg("speed") = ClipOptions{}.speed, py::arg("fps") = ClipOptions{}.fps,
           py::arg("width") = PictureOptions{}.width,
           py::arg("height") = PictureOptions{}.height, py::arg("camera") = "",
           py::arg("ghost") = false, py::arg("amplify") = py::none(),
           py::arg("progress") = py::none(),
           R"(
           Writes a clip, *.mp4: this machine beside another one on the same motion,
           small motion enlarged.

           other: a Machine, a Record of this one, or None.
           trajectory, replay, duration [s], seed, linear: of the runs, as of simulate.
           begin, end: what is shown [s].
           speed: seconds of the machine a second of clip.
           width, height: [px], even.
           ghost: one in the other.
           amplify: factor on the motion of all joints, or joint -> factor; None: from
           the data.
           progress: as of simulate.

           Returns a dict: frames, codec, amplification.
           InputError; no screen is needed.)")
      .def(
          "linearize",
          [](const MachineObject& object) {
            if (!object.machine().changes().effects.empty()) {
              throw InputError("linearize", "effects are not linear",
                               "a machine with fault parameters only");
            }
            const Machine& own = object.machine();
            const OperatingPoint rest =
                HeldAt(own.plant(), own.channels(), own.rest_pose());
            return LinearObject{LinearizeAbout(own.plant(), own.channels(), rest).model,
                                object.setup().rates};
          },
          R"(
          The machine about its rest, else held as it is drawn: a LinearModel, in
          independent coordinates where constraints tie others. InputError for one that
          was given effects.)");
}

}  // namespace mjdiag::python
