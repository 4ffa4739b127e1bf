#include "mjdiag/discovery/hypotheses/number_sensitivity.h"

#include <algorithm>
#include <span>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/replay/plant_twin.h"
#include "mjdiag/plugin/replay/uncertain_machine.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of which nothing is unknown but these numbers, one factor each.
UncertainMachine WithUnknown(const Machine& machine,
                             const std::vector<PlantNumber>& numbers) {
  UncertainMachine uncertain;
  uncertain.numbers.resize(numbers.size());
  ParallelFor(static_cast<int>(numbers.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    uncertain.numbers[i].number = numbers[i];
    if (!IsFriction(numbers[i].kind)) {
      uncertain.numbers[i].part = PartOf(machine, numbers[i]);
    }
    uncertain.numbers[i].part.factors = {number};
  });
  for (const PlantNumber& number : numbers) {
    uncertain.unknowns.push_back(
        {PlantNumberName(machine.plant(), number), 0.0, 1.0, 1.0, false});
  }
  uncertain.known = static_cast<Index>(numbers.size());
  uncertain.start = MatrixXd::Zero(2 * machine.plant().nv, 0);
  return uncertain;
}

/// One record, into rows of J from its first block on.
class RecordSensitivity {
 public:
  RecordSensitivity(const Machine& machine, const UncertainMachine& uncertain,
                    const Observer& observer, Index block)
      : twin_(machine, uncertain, {{observer.L, observer.innovation_covariance}},
              block),
        block_(block),
        known_(static_cast<Index>(uncertain.unknowns.size())) {}

  /// @param J  (ny blocks) x numbers, of zeros: means over the blocks are added
  void Run(const MeasuredRun& record, Eigen::Ref<MatrixXd> J) {
    const Index ny = record.outputs.rows();
    const VectorXd theta = VectorXd::Zero(known_);
    TwinState start = twin_.MakeState();
    VectorXd reading = record.outputs.col(0);
    twin_.StateAt(reading, start);
    twin_.Start(theta, start, 0);
    for (Index k = 0; k < (J.rows() / ny) * block_; ++k) {
      twin_.Predict(reading);
      VectorXd innovation = record.outputs.col(k) - reading;
      if (record.measured.size() > 0) {
        innovation = record.measured.col(k).select(innovation, 0.0);
      }
      const VectorXd inputs = record.inputs.col(k);
      twin_.Step(std::span<const double>(inputs.data(), inputs.size()), innovation);
      if ((k + 1) % block_ != 0) continue;
      const MatrixXd& of_ticks = twin_.EndBlock();
      auto mean = J.middleRows(ny * (k / block_), ny);
      for (Index tick = 0; tick < block_; ++tick) {
        mean -= of_ticks.middleRows(ny * tick, ny) / static_cast<double>(block_);
      }
    }
  }

 private:
  PlantTwin twin_;
  Index block_;
  Index known_;
};

}  // namespace

bool StaysNearRest(const Machine& machine, const Track& track) {
  constexpr Index kLooks = 200;
  constexpr double kNear = 0.1;
  const mjModel& plant = machine.plant();
  const DataPtr data = MakeData(plant);
  const MatrixXd& M = machine.linear().M;
  MatrixXd now(plant.nv, plant.nv);
  // Of an energy: units of the joints cancel.
  const VectorXd scale = M.diagonal().cwiseSqrt().cwiseInverse();
  const Index samples = track.position.cols();
  for (Index look = 0; look < kLooks; ++look) {
    VectorXd::Map(data->qpos, plant.nv) =
        track.position.col(look * (samples - 1) / (kLooks - 1));
    mj_fwdPosition(&plant, data.get());
    mj_fullM(&plant, now.data(), data->qM);
    const MatrixXd change = scale.asDiagonal() * (now - M) * scale.asDiagonal();
    if (change.cwiseAbs().maxCoeff() > kNear) return false;
  }
  return true;
}

MatrixXd NumberSensitivity(const Machine& machine, const Observer& observer,
                           const MeasuredRun& run,
                           const std::vector<PlantNumber>& numbers, Index block) {
  const UncertainMachine uncertain = WithUnknown(machine, numbers);
  const Index ny = run.outputs.rows();
  MatrixXd J =
      MatrixXd::Zero(ny * (run.samples() / block), static_cast<Index>(numbers.size()));
  ParallelFor(static_cast<int>(run.records.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    const MeasuredRun record = Part(run, i, run.SamplesOf(i));
    // A record begins with a block of its own but for one that began before.
    const Index first = (run.records[i].sample + block - 1) / block;
    const Index late = first * block - run.records[i].sample;
    const Index blocks =
        std::min((record.samples() - late) / block, J.rows() / ny - first);
    if (blocks <= 0) return;
    RecordSensitivity(machine, uncertain, observer, block)
        .Run(record, J.middleRows(ny * first, ny * blocks));
  });
  return J;
}

}  // namespace mjdiag
