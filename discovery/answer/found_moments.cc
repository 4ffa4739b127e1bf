#include "mjdiag/discovery/answer/found_moments.h"

#include <cmath>
#include <vector>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/discovery/hypotheses/mass_moments.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kStep = 1e-4;

VectorXd MomentsOf(const Machine& machine) {
  const std::vector<MassMoment> moments = MassMoments(machine.plant());
  VectorXd values(std::ssize(moments));
  for (Index i = 0; i < values.size(); ++i) {
    values[i] = moments[static_cast<std::size_t>(i)].value;
  }
  return values;
}

/// Standard deviations of moments as far as the numbers in doubt were known beforehand.
VectorXd DoubtOfMoments(const AnswerData& data, const VectorXd& as_given) {
  VectorXd square = VectorXd::Zero(as_given.size());
  for (const Block& block : data.blocks) {
    if (!block.number) continue;
    const Machine moved =
        data.machine.WithNumbers({{*block.number, std::exp(kStep * block.doubt)}});
    square += ((MomentsOf(moved) - as_given) / kStep).cwiseAbs2();
  }
  return square.cwiseSqrt();
}

}  // namespace

void AddMoments(const AnswerData& data, const ModelOnRuns& answer,
                const CoordinateErrors& errors, Discovery& discovery) {
  const Model& model = answer.fit.model;
  const auto coordinates = CoordinatesOf(data.blocks, model);
  const VectorXd x = Place(coordinates, model);
  const VectorXd as_given = MomentsOf(data.machine);
  const VectorXd found = MomentsOf(data.With(model));
  MatrixXd slopes = MatrixXd::Zero(found.size(), x.size());
  for (Index i = 0; i < x.size(); ++i) {
    const Coordinate& one = coordinates[static_cast<std::size_t>(i)];
    if (!data.blocks[model[one.member].block].number) continue;
    VectorXd moved = x;
    moved[i] += x[i] + kStep > one.upper ? -kStep : kStep;
    slopes.col(i) = (MomentsOf(data.With(At(coordinates, model, moved))) - found) /
                    (moved[i] - x[i]);
  }
  if (slopes.isZero(0.0)) return;
  const MatrixXd covariance =
      errors.sd.asDiagonal() * errors.correlation * errors.sd.asDiagonal();
  const VectorXd doubt = DoubtOfMoments(data, as_given);
  const std::vector<MassMoment> names = MassMoments(data.machine.plant());
  for (Index m = 0; m < found.size(); ++m) {
    const VectorXd slope = slopes.row(m).transpose();
    if (slope.isZero(0.0)) continue;
    const double half = TwoSidedNormalQuantile(0.05) *
                        std::sqrt(std::max(0.0, slope.dot(covariance * slope)));
    const MassMoment& name = names[static_cast<std::size_t>(m)];
    discovery.moments.push_back({name.joint, name.axis, as_given[m], found[m],
                                 found[m] - half, found[m] + half, doubt[m]});
  }
}

}  // namespace mjdiag
