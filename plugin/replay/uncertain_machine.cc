#include "mjdiag/plugin/replay/uncertain_machine.h"

#include <algorithm>
#include <cmath>

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
Index InCalibration(const Machine& machine, const PlantNumber& number) {
  const auto& calibration = machine.setup().calibration;
  if (!calibration) return -1;
  const auto& names = calibration->numbers;
  const auto found =
      std::find(names.begin(), names.end(), PlantNumberName(machine.plant(), number));
  return found == names.end() ? -1 : found - names.begin();
}

double Spread(const Machine& machine, const PlantNumber& number, bool doubt) {
  if (const Index at = InCalibration(machine, number); at >= 0 && !doubt) {
    return std::sqrt(machine.setup().calibration->covariance(at, at));
  }
  const double declared = SpreadOf(machine.plant(), number);
  const bool friction = number.kind == PlantNumberKind::kFriction;
  return declared > 0.0 || !(doubt || friction) ? declared : UsualSpread(number.kind);
}

UncertainNumber& NumberOf(const Machine& machine, const PlantNumber& number,
                          UncertainMachine& uncertain) {
  const auto found = std::find_if(
      uncertain.numbers.begin(), uncertain.numbers.end(),
      [&](const UncertainNumber& known) { return known.number == number; });
  if (found != uncertain.numbers.end()) return *found;
  UncertainNumber& added = uncertain.numbers.emplace_back(UncertainNumber{number, {}});
  if (number.kind != PlantNumberKind::kFriction) added.part = PartOf(machine, number);
  return added;
}

void AddFaults(const Machine& machine, UncertainMachine& uncertain) {
  for (const FaultParameter& fault : FaultParameters(machine.plant())) {
    const auto unknown = static_cast<Index>(uncertain.unknowns.size());
    for (const int element : fault.elements) {
      NumberOf(machine, {fault.kind, element}, uncertain)
          .part.factors.push_back(unknown);
    }
    uncertain.unknowns.push_back({fault.name, 1.0, kFaultSpread, true, true});
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
  for (const PlantNumber& number : PlantNumbers(plant)) {
    const bool friction = number.kind == PlantNumberKind::kFriction;
    if (friction && !options.friction) continue;
    const double spread = Spread(machine, number, options.doubt);
    if (!(spread > 0.0)) continue;
    UncertainNumber& uncertain_number = NumberOf(machine, number, uncertain);
    if (!friction && !Acts(uncertain_number.part)) {
      if (uncertain_number.part.factors.empty()) uncertain.numbers.pop_back();
      continue;
    }
    const auto unknown = static_cast<Index>(uncertain.unknowns.size());
    uncertain_number.part.factors.push_back(unknown);
    uncertain.unknowns.push_back(
        {PlantNumberName(plant, number), 1.0, spread, true, friction});
    ++uncertain.known;
  }
}

void AddTones(const Machine& machine, UncertainMachine& uncertain) {
  for (const MultisineSetup& source : machine.setup().disturbances) {
    const VectorXd amplitude = machine.channels().AmplitudeOf(source);
    for (const double frequency : source.frequencies) {
      uncertain.tones.push_back({frequency, amplitude});
      for (const char* part : {" sine", " cosine"}) {
        uncertain.unknowns.push_back(
            {source.name + part, 0.0, kFaultSpread, false, true});
      }
    }
  }
}

/// Numbers that were calibrated together are known together.
MatrixXd PriorOf(const Machine& machine, const UncertainMachine& uncertain,
                 bool doubt) {
  const auto p = static_cast<Index>(uncertain.unknowns.size());
  MatrixXd prior = MatrixXd::Zero(p, p);
  for (Index i = 0; i < p; ++i) {
    prior(i, i) = std::pow(uncertain.unknowns[static_cast<std::size_t>(i)].prior_sd, 2);
  }
  const auto& calibration = machine.setup().calibration;
  if (!calibration || doubt) return prior;
  std::vector<Index> places;
  for (Index i = uncertain.faults; i < uncertain.first_tone(); ++i) {
    const std::string& name = uncertain.unknowns[static_cast<std::size_t>(i)].name;
    const auto& names = calibration->numbers;
    const auto found = std::find(names.begin(), names.end(), name);
    places.push_back(found == names.end() ? -1 : found - names.begin());
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (places[i] < 0 || places[k] < 0) continue;
      prior(uncertain.faults + static_cast<Index>(i),
            uncertain.faults + static_cast<Index>(k)) =
          calibration->covariance(places[i], places[k]);
    }
  }
  return prior;
}

/// Without what rounding leaves of entries that do not change; empty if none does.
MatrixXd Changed(const MatrixXd& moved, const MatrixXd& base, double by) {
  constexpr double kRounding = 1e-12;
  const double least = kRounding * base.cwiseAbs().maxCoeff();
  const MatrixXd change = moved - base;
  if (!(change.cwiseAbs().maxCoeff() > least)) return {};
  return (change.array().abs() > least).select(change / by, 0.0);
}

}  // namespace

UncertainMachine MakeUncertainMachine(const Machine& machine,
                                      const UncertaintyOptions& options) {
  UncertainMachine uncertain;
  if (options.faults) AddFaults(machine, uncertain);
  AddNumbers(machine, options, uncertain);
  if (options.faults) AddTones(machine, uncertain);
  uncertain.start = MatrixXd::Zero(2 * machine.plant().nv, 0);
  if (options.start_energy > 0.0) {
    uncertain.start = StartDirections(machine.linear(), options.start_energy);
  }
  for (Index i = 0; i < uncertain.start.cols(); ++i) {
    uncertain.unknowns.push_back(
        {"start " + std::to_string(i + 1), 0.0, 1.0, false, false});
  }
  uncertain.prior = PriorOf(machine, uncertain, options.doubt);
  return uncertain;
}

ModelPart PartOf(const Machine& machine, const PlantNumber& number) {
  // Half of it tells more than a small step: the model is affine in it.
  constexpr double kMoved = -0.5;
  // Of a rest found by Newton's method.
  constexpr double kSameRest = 1e-9;
  const Machine moved = machine.WithNumbers({{number, 1.0 + kMoved}});
  const MechanicalModel& from = machine.linear();
  const MechanicalModel& to = moved.linear();
  ModelPart part;
  part.M = Changed(to.M, from.M, kMoved);
  part.D = Changed(to.D, from.D, kMoved);
  part.K = Changed(to.K, from.K, kMoved);
  part.Gamma = Changed(to.Gamma, from.Gamma, kMoved);
  const VectorXd way = moved.rest() - machine.rest();
  if (way.norm() > kSameRest * (1.0 + machine.rest().norm())) {
    part.force = to.K * way / kMoved;
  }
  return part;
}

UncertainModel MakeUncertainModel(const Machine& machine,
                                  const UncertainMachine& uncertain) {
  UncertainModel model;
  model.nominal = machine.linear();
  model.timing = {machine.rates().step(), machine.rates().substeps};
  model.rest = SensorReadings(machine.channels(), machine.plant(), machine.rest());
  for (const UncertainNumber& number : uncertain.numbers) {
    if (number.number.kind == PlantNumberKind::kFriction) continue;
    model.parts.push_back(number.part);
  }
  model.unknowns = uncertain.unknowns;
  model.tones = uncertain.tones;
  model.start = uncertain.start;
  return model;
}

}  // namespace mjdiag
