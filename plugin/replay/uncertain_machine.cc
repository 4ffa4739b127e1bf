#include "mjdiag/plugin/replay/uncertain_machine.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/plugin/plant/start_state.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// How far a fault may be from healthy, in its logarithm, before it is known to be, and
/// the parts of a tone.
constexpr double kFaultSpread = 0.1;

/// Place of that number in the calibration; -1: it is not in it.
Index InCalibration(const Machine& machine, const std::string& number) {
  const auto& calibration = machine.setup().calibration;
  if (!calibration) return -1;
  const auto& names = calibration->numbers;
  const auto found = std::find(names.begin(), names.end(), number);
  return found == names.end() ? -1 : found - names.begin();
}

double Spread(const Machine& machine, const ModelParameter& number,
              const UncertaintyOptions& options) {
  if (options.unmeasured) return DoubtOf(machine.plant(), number);
  const bool doubt = options.doubt;
  const Index at = InCalibration(machine, ModelParameterName(machine.plant(), number));
  const bool friction = IsFriction(number.kind);
  // Dry friction is another one today than it was in the runs that were calibrated on.
  if (at >= 0 && !doubt && !friction) return machine.setup().calibration->Sd()[at];
  const double declared = SpreadOf(machine.plant(), number);
  return declared > 0.0 || !(doubt || friction) ? declared : UsualSpread(number.kind);
}

UncertainNumber& NumberOf(const Machine& machine, const ModelParameter& number,
                          UncertainMachine& uncertain) {
  const auto found = std::find_if(
      uncertain.numbers.begin(), uncertain.numbers.end(),
      [&](const UncertainNumber& known) { return known.number == number; });
  if (found != uncertain.numbers.end()) return *found;
  UncertainNumber& added = uncertain.numbers.emplace_back(UncertainNumber{number, {}});
  if (!IsFriction(number.kind)) added.part = PartOf(machine, number);
  return added;
}

void AddFaults(const Machine& machine, UncertainMachine& uncertain) {
  for (const FaultParameter& fault : FaultParameters(machine.plant())) {
    const auto unknown = static_cast<Index>(uncertain.unknowns.size());
    for (const int element : fault.elements) {
      NumberOf(machine, {fault.kind, element}, uncertain)
          .part.factors.push_back(unknown);
    }
    uncertain.unknowns.push_back({fault.name, 0.0, kFaultSpread, 1.0, true});
  }
  uncertain.faults = static_cast<Index>(uncertain.unknowns.size());
}

/// Whether the machine answers to it at all.
bool Acts(const ModelPart& part) {
  return part.M.size() + part.D.size() + part.K.size() + part.Gamma.size() +
             part.force.size() >
         0;
}

void AddNumbers(const Machine& machine, const UncertaintyOptions& options,
                UncertainMachine& uncertain) {
  const mjModel& plant = machine.plant();
  for (const ModelParameter& number : ModelParameters(plant)) {
    const bool friction = IsFriction(number.kind);
    if (friction && !options.friction) continue;
    const double spread = Spread(machine, number, options);
    if (!(spread > 0.0)) continue;
    UncertainNumber& uncertain_number = NumberOf(machine, number, uncertain);
    if (!friction && !Acts(uncertain_number.part)) {
      if (uncertain_number.part.factors.empty()) uncertain.numbers.pop_back();
      continue;
    }
    const auto unknown = static_cast<Index>(uncertain.unknowns.size());
    uncertain_number.part.factors.push_back(unknown);
    uncertain.unknowns.push_back(
        {ModelParameterName(plant, number), 0.0, spread, 1.0, friction});
    ++uncertain.known;
  }
}

/// Of friction that effects of the plant make, with that of its joint.
void AddResistances(const Machine& machine, UncertainMachine& uncertain) {
  const mjModel& plant = machine.plant();
  for (const PlacedEffect& effect : machine.effects()) {
    if (effect.effect->family() != Family::kFriction) continue;
    if (effect.effect->element() != mjOBJ_JOINT) continue;
    const int joint = CheckEffect(plant, effect);
    const auto known = [joint](const UncertainResistance& resistance) {
      return resistance.joint == joint;
    };
    if (std::ranges::any_of(uncertain.resistances, known)) continue;
    const ModelParameter number{ModelParameterKind::kFriction, joint};
    const std::string name = ModelParameterName(plant, number);
    auto found = std::ranges::find(uncertain.unknowns, name, &Unknown::name);
    if (found == uncertain.unknowns.end()) {
      const double spread = Spread(machine, number, {});
      if (!(spread > 0.0)) continue;
      uncertain.unknowns.push_back({name, 0.0, spread, 1.0, true});
      ++uncertain.known;
      found = uncertain.unknowns.end() - 1;
    }
    uncertain.resistances.push_back({joint, found - uncertain.unknowns.begin()});
  }
}

void AddTones(const Machine& machine, UncertainMachine& uncertain) {
  for (const MultisineSetup& source : machine.setup().disturbances) {
    const VectorXd amplitude = machine.channels().AmplitudeOf(source);
    for (const double frequency : source.frequencies) {
      uncertain.tones.push_back({frequency, amplitude});
      for (const char* part : {" sine", " cosine"}) {
        uncertain.unknowns.push_back(
            {source.name + part, 0.0, kFaultSpread, 0.0, true});
      }
    }
  }
}

/// Entries that rounding leaves of what does not change are dropped; empty if none does.
/// @param rows, columns  sizes of the coordinates; an entry may be as large as their
///                       product
MatrixXd Derivative(const MatrixXd& up, const MatrixXd& down, double by,
                    const VectorXd& rows, const VectorXd& columns) {
  constexpr double kRounding = 1e-12;
  const MatrixXd change = up - down;
  const Eigen::ArrayXXd least = kRounding * (rows * columns.transpose()).array();
  if (!(change.array().abs() > least).any()) return {};
  return (change.array().abs() > least).select(change / by, 0.0);
}

}  // namespace

UncertainMachine MakeUncertainMachine(const Machine& machine,
                                      const UncertaintyOptions& options) {
  UncertainMachine uncertain;
  if (options.faults) AddFaults(machine, uncertain);
  AddNumbers(machine, options, uncertain);
  if (options.faults && options.friction) AddResistances(machine, uncertain);
  if (options.faults) AddTones(machine, uncertain);
  uncertain.start = MatrixXd::Zero(2 * machine.plant().nv, 0);
  if (options.start_energy > 0.0) {
    uncertain.start = StartDirections(machine.linear(), options.start_energy);
  }
  for (Index i = 0; i < uncertain.start.cols(); ++i) {
    uncertain.unknowns.push_back(
        {"start " + std::to_string(i + 1), 0.0, 1.0, 0.0, false});
  }
  return uncertain;
}

KnownTogether AsCalibrated(const Machine& machine, const UncertainMachine& uncertain) {
  const auto p = static_cast<Index>(uncertain.unknowns.size());
  std::vector<Index> together;  // of the unknowns
  std::vector<Index> rows;      // of the root
  for (Index i = uncertain.faults; i < uncertain.first_tone(); ++i) {
    const Unknown& unknown = uncertain.unknowns[static_cast<std::size_t>(i)];
    const Index row = InCalibration(machine, unknown.name);
    if (row < 0 || unknown.wears) continue;
    together.push_back(i);
    rows.push_back(row);
  }
  KnownTogether known;
  if (together.empty()) {
    known.unknowns = uncertain.unknowns;
    known.T = MatrixXd::Identity(p, p);
    return known;
  }
  const MatrixXd root = machine.setup().calibration->root(rows, Eigen::all);
  known.T = MatrixXd::Zero(p, p - static_cast<Index>(together.size()) + root.cols());
  Index column = 0;
  for (Index i = 0; i < p; ++i) {
    if (i == together.front()) {
      for (Index k = 0; k < root.cols(); ++k) {
        for (std::size_t row = 0; row < together.size(); ++row) {
          known.T(together[row], column) = root(static_cast<Index>(row), k);
        }
        known.unknowns.push_back({"calibration " + std::to_string(k + 1), 0.0, 1.0,
                                  root.col(k).cwiseAbs().maxCoeff(), false});
        ++column;
      }
    }
    if (std::find(together.begin(), together.end(), i) != together.end()) continue;
    known.T(i, column++) = 1.0;
    known.unknowns.push_back(uncertain.unknowns[static_cast<std::size_t>(i)]);
  }
  return known;
}

ModelPart PartOf(const Machine& machine, const ModelParameter& number) {
  // Central differences. Where the machine stays where it is, the model is affine in
  // the number, and the step does not matter.
  constexpr double kStep = 1e-3;
  // Of a rest found by Newton's method, m or rad.
  constexpr double kSameRest = 1e-11;
  // What nothing holds has a stiffness and a damping of this time constant.
  constexpr double kRate = 1.0;  // 1/s
  const Machine more = machine.WithNumbers({{number, 1.0 + kStep}});
  const Machine less = machine.WithNumbers({{number, 1.0 - kStep}});
  const MechanicalModel& up = more.linear();
  const MechanicalModel& down = less.linear();
  const MechanicalModel& model = machine.linear();
  const VectorXd mass = model.M.diagonal();
  const VectorXd inertia = mass.cwiseSqrt();
  const VectorXd damper = (model.D.diagonal().cwiseAbs() + kRate * mass).cwiseSqrt();
  const VectorXd spring =
      (model.K.diagonal().cwiseAbs() + kRate * kRate * mass).cwiseSqrt();
  const double by = 2.0 * kStep;
  ModelPart part;
  part.M = Derivative(up.M, down.M, by, inertia, inertia);
  part.D = Derivative(up.D, down.D, by, damper, damper);
  part.K = Derivative(up.K, down.K, by, spring, spring);
  part.Gamma = Derivative(up.Gamma, down.Gamma, by,
                          VectorXd::Constant(mass.size(), model.Gamma.norm()),
                          VectorXd::Ones(model.Gamma.cols()));
  const VectorXd way = more.rest() - less.rest();
  if (way.cwiseAbs().maxCoeff() > kSameRest) part.force = model.K * way / by;
  return part;
}

UncertainModel MakeUncertainModel(const Machine& machine,
                                  const UncertainMachine& uncertain) {
  UncertainModel model;
  model.nominal = machine.linear();
  model.timing = {machine.rates().step(), machine.rates().substeps};
  model.rest = SensorReadings(machine.channels(), machine.plant(), machine.rest());
  for (const UncertainNumber& number : uncertain.numbers) {
    if (IsFriction(number.number.kind)) continue;
    model.parts.push_back(number.part);
  }
  model.unknowns = uncertain.unknowns;
  model.tones = uncertain.tones;
  model.start = uncertain.start;
  return model;
}

}  // namespace mjdiag
