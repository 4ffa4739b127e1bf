// mjdiag linearize: the linear equations of motion of a machine.

#include "mjdiag/plugin/plant/linearize.h"

#include <Eigen/Core>
#include <algorithm>
#include <memory>

#include "app/command.h"
#include "app/exit_status.h"
#include "app/format.h"
#include "app/linearize_compare.h"
#include "app/linearize_point.h"
#include "app/output.h"
#include "app/subject.h"
#include "mjdiag/diagnosis/json_matrix.h"
#include "mjdiag/plugin/plant/transition.h"
#include "mjdiag/plugin/runtime/closed_loop.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/listed.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag::app {
namespace {

struct LinearizeOptions {
  MachineOptions machine;
  OutputOptions output;
  std::string at = "rest";
  bool compare = false;
  bool published = false;
};

nlohmann::json ModelJson(const MechanicalModel& model) {
  nlohmann::json modes = nlohmann::json::array();
  for (const Mode& mode : Modes(model)) {
    modes.push_back(
        {{"frequency", mode.frequency}, {"damping_ratio", mode.damping_ratio}});
  }
  return {{"coordinates", model.coordinates},
          {"inputs", model.inputs},
          {"outputs", model.outputs},
          {"M", MatrixJson(model.M)},
          {"D", MatrixJson(model.D)},
          {"K", MatrixJson(model.K)},
          {"Gamma", MatrixJson(model.Gamma)},
          {"b", MatrixJson(model.b)},
          {"modes", modes}};
}

/// The joint that moves most in a mode, in energy: unlike amplitudes, energies of
/// slides and hinges compare.
std::string Dominant(const MechanicalModel& model, const Mode& mode) {
  Eigen::Index joint = 0;
  (mode.shape.array().square() * model.M.diagonal().array()).maxCoeff(&joint);
  return model.coordinates[static_cast<std::size_t>(joint)];
}

std::string ModeTable(const MechanicalModel& model) {
  const std::vector<Mode> modes = Modes(model);
  if (modes.empty()) return "no modes: nothing pulls it back or damps it\n";
  Table table({"mode", "frequency", "damping ratio", "moves most"});
  int number = 0;
  for (const Mode& mode : modes) {
    table.Add({std::to_string(++number), FormatQuantity(mode.frequency, "Hz"),
               Short(mode.damping_ratio), Dominant(model, mode)});
  }
  return table.ToString();
}

nlohmann::json StateSpaceJson(const StateSpace& system) {
  return {{"A", MatrixJson(system.A)},
          {"B", MatrixJson(system.B)},
          {"C", MatrixJson(system.C)},
          {"D", MatrixJson(system.D)},
          {"sample_time", system.sample_time}};
}

/// How coordinates that constraints tie follow the others.
nlohmann::json TiesJson(const Linearization& linear) {
  nlohmann::json ties = nlohmann::json::object();
  for (std::size_t i = 0; i < linear.dependent.size(); ++i) {
    nlohmann::json row = nlohmann::json::object();
    for (std::size_t j = 0; j < linear.model.coordinates.size(); ++j) {
      const double slope =
          linear.ties(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      if (slope != 0.0) row[linear.model.coordinates[j]] = slope;
    }
    ties[linear.dependent[i]] = row;
  }
  return ties;
}

std::string TiesText(const Linearization& linear) {
  if (linear.dependent.empty()) return "";
  const std::string free = Listed(linear.model.coordinates);
  return "\nindependent coordinates: " + (free.empty() ? "none" : free) +
         "; constraints tie " + Listed(linear.dependent);
}

/// The plant that the controllers see. The exact map where there is one: a tree of slides
/// and hinges at rest whose Euler steps take all of its damping implicitly.
StateSpace PlantTick(const Machine& machine, const NamedPoint& named,
                     const Linearization& linear, const Transition& transition) {
  const mjModel& plant = machine.plant();
  const bool scalar =
      std::all_of(plant.jnt_type, plant.jnt_type + plant.njnt,
                  [](int type) { return type == mjJNT_SLIDE || type == mjJNT_HINGE; });
  const Eigen::VectorXd damping = Eigen::VectorXd::Map(plant.dof_damping, plant.nv);
  if (!scalar || plant.opt.integrator == mjINT_RK4 || !named.point.rests ||
      plant.na > 0 || !linear.dependent.empty() ||
      !(linear.model.D - Eigen::MatrixXd(damping.asDiagonal()))
           .isZero(1e-12 * damping.norm())) {
    return transition.tick;
  }
  return TickModel(linear.model, machine.rates().step(), machine.rates().substeps);
}

void Linearize(LinearizeOptions& options) {
  std::vector<std::string> notes =
      DraftMachine(options.machine, RecordOfPoint(options.at));
  const Subject subject = LoadSubject(options.machine);
  const Machine& machine = subject.machine;
  if (!machine.changes().effects.empty() || !subject.options.disturbances.empty() ||
      !subject.options.late_faults.empty()) {
    throw InputError("linearize",
                     "effects, disturbances and late faults are not linear",
                     "fault parameters of the plant only");
  }
  const NamedPoint named = FindPoint(machine, options.at, notes);
  const Linearization linear =
      LinearizeAbout(machine.plant(), machine.channels(), named.point);
  const Transition transition = TransitionAbout(machine.plant(), machine.channels(),
                                                named.point, machine.rates().substeps);
  notes.insert(notes.end(), linear.notes.begin(), linear.notes.end());

  nlohmann::json document = ModelJson(linear.model);
  document.update(ToJson(subject));
  document["schema"] = "mjdiag.linearize/1";
  document["command"] = CommandLine();
  document["setup"] = machine.setup().name;
  document["about"] = PointJson(machine, named, linear.stable);
  if (!linear.dependent.empty()) {
    document["independent"] = linear.model.coordinates;
    document["dependent"] = TiesJson(linear);
  }
  document["states"] = StateNames(machine.plant());
  document["step"] = StateSpaceJson(transition.step);
  document["tick"] = StateSpaceJson(transition.tick);
  std::string text = machine.setup().name + ", " + SubjectText(subject) + "\n" +
                     PlaceText(machine, named, linear.stable) + TiesText(linear) +
                     "\n\n" + ModeTable(linear.model);
  if (!machine.setup().control.axes.empty()) {
    const double radius = SpectralRadius(ClosedLoopMatrix(
        PlantTick(machine, named, linear, transition), machine.setup()));
    document["closed_loop"] = {{"largest_eigenvalue", radius}};
    text += "\nclosed loop: largest eigenvalue " + Short(radius) +
            (radius < 1.0 ? ", stable\n" : ", unstable\n");
  }
  bool good = true;
  for (const auto& [wanted, compare] :
       {std::pair{options.compare, &CompareWithAnalytic},
        std::pair{options.published, &ComparePublished}}) {
    if (!wanted) continue;
    const Answer answer = compare(machine, document);
    text += "\n" + answer.text;
    good = good && answer.good;
  }
  AddNotes(notes, document, text);
  PrepareOutput(options.output);
  Publish(options.output, "linearize", document, text);
  if (!good) throw NegativeAnswer();
}

}  // namespace

void AddLinearize(CLI::App& app) {
  auto options = std::make_shared<LinearizeOptions>();
  CLI::App* command = app.add_subcommand(
      "linearize",
      "M, D, K, Gamma, b, the modes, and A, B, C, D of a step and a control tick");
  AddMachineOrPlantOptions(*command, options->machine);
  AddOutputOptions(*command, options->output, false);
  command->add_option("--at", options->at,
                      "Where: rest, start (as the MJCF draws it), keyframe:NAME or "
                      "RECORD@TIME [s] (default: rest; the pose drawn where nothing "
                      "rests, held)");
  command->add_flag(
      "--compare", options->compare,
      "Against the setup's analytic model and MuJoCo's finite differences; "
      "exit status 1 if they differ by more than 1e-9, 1e-8");
  command->add_flag("--published", options->published,
                    "Against the setup's published parity relation; exit status 1 if a "
                    "coefficient differs by more than a unit of its last digit");
  command->callback([options] { Linearize(*options); });
}

}  // namespace mjdiag::app
