#include "mjdiag/plugin/effects/structure/force_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using namespace force_curve;

class CurveForce final : public ActiveEffect {
 public:
  CurveForce(const mjModel& model, const JointOf& joint, const EffectValues& values)
      : joint_(joint),
        variable_(static_cast<CurveVariable>(std::lround(values[kVariable]))),
        factor_(static_cast<CurveFactor>(std::lround(values[kFactor]))),
        of_(static_cast<int>(std::lround(values[kOf]))),
        still_(values[kStill]),
        axis_(CurveAxisOf(values)),
        values_(values.segment(kFirst, axis_.knots)) {
    if (variable_ == CurveVariable::kPosition) {
      position_ = model.jnt_qposadr[model.dof_jntid[of_]];
      rest_ = model.qpos0[position_];
    }
  }

  bool FollowsItsJoint() const noexcept override { return of_ == joint_.dof; }
  void Push(const mjModel&, mjData& data) noexcept override {
    const CurveAxis::Weights weights = axis_.At(Variable(data));
    double force = 0.0;
    for (std::size_t i = 0; i < weights.place.size(); ++i) {
      force += weights.weight[i] * values_[weights.place[i]];
    }
    data.qfrc_applied[joint_.dof] +=
        force * FactorOf(factor_, data.qvel[joint_.dof], still_);
  }

 private:
  double Variable(const mjData& data) const noexcept {
    switch (variable_) {
      case CurveVariable::kPosition:
        return data.qpos[position_] - rest_;
      case CurveVariable::kVelocity:
        return data.qvel[of_];
      case CurveVariable::kCommand:
        return data.ctrl[of_];
      case CurveVariable::kTime:
        return data.time;
    }
    return 0.0;
  }

  JointOf joint_;
  CurveVariable variable_;
  CurveFactor factor_;
  int of_;
  int position_ = 0;
  double rest_ = 0.0;
  double still_;
  CurveAxis axis_;
  EffectValues values_;
};

EffectParameter Choice(std::string name, std::string unit, double least, double most,
                       std::optional<double> fallback = std::nullopt) {
  return {std::move(name), Role::kChoice, std::move(unit), least, most, fallback};
}

std::vector<EffectParameter> Parameters() {
  std::vector<EffectParameter> all = {
      Choice("variable", "1", 0.0, 3.0),
      Choice("of", "1", 0.0, kAnySize, 0.0),
      Choice("factor", "1", 0.0, 2.0, 0.0),
      Choice("still", "m/s", 0.0, kAnySize, 0.0),
      Choice("low", "of x", -kAnySize, kAnySize),
      Choice("width", "of x", std::numeric_limits<double>::min(), kAnySize),
      Choice("shape", "1", 0.0, 2.0, 0.0),
      Choice("knots", "1", kFewestKnots, kMostKnots)};
  for (int i = 1; i <= kMostKnots; ++i) {
    all.push_back({"force_" + std::to_string(i), Role::kAmplitude, "N", -kAnySize,
                   kAnySize, 0.0});
  }
  return all;
}

/// The weights of one smooth piece, whose first knot is number `first`, times `share`: the
/// first four of the weights, or behind another piece the last.
void AddPiece(const CurveAxis& piece, double x, int first, double share,
              CurveAxis::Weights& weights) noexcept {
  const bool periodic = piece.shape == CurveShapes::kPeriodic;
  const int cells = periodic ? piece.knots : piece.knots - 1;
  double t = (x - piece.low) / (piece.high - piece.low) * cells;
  t = periodic ? t - cells * std::floor(t / cells)
               : std::clamp(t, 0.0, static_cast<double>(cells));
  const int cell = std::min(static_cast<int>(t), cells - 1);
  t -= cell;
  std::array<double, 4> weight = {
      t * (-0.5 + t * (1.0 - 0.5 * t)), 1.0 + t * t * (-2.5 + 1.5 * t),
      t * (0.5 + t * (2.0 - 1.5 * t)), t * t * (-0.5 + 0.5 * t)};
  // Before its first knot and behind its last the curve goes on as the parabola through
  // three, so that it is as exact in its first cell and its last as between them; of two
  // knots as a line.
  const double near = piece.knots > 2 ? 3.0 : 2.0;
  const double next = piece.knots > 2 ? -3.0 : -1.0;
  const double far = piece.knots > 2 ? 1.0 : 0.0;
  if (!periodic && cell == 0) {
    weight[1] += near * weight[0];
    weight[2] += next * weight[0];
    weight[3] += far * weight[0];
    weight[0] = 0.0;
  }
  if (!periodic && cell == cells - 1) {
    weight[2] += near * weight[3];
    weight[1] += next * weight[3];
    weight[0] += far * weight[3];
    weight[3] = 0.0;
  }
  const std::size_t slot = first == 0 ? 0 : weight.size();
  for (std::size_t i = 0; i < weight.size(); ++i) {
    const int knot = cell - 1 + static_cast<int>(i);
    weights.place[slot + i] = first + (knot + piece.knots) % piece.knots;
    weights.weight[slot + i] = share * weight[i];
  }
}

class ForceCurveEffect final : public Effect {
 public:
  ForceCurveEffect()
      : Effect({.name = "force_curve",
                .family = Family::kStructure,
                .kind = Kind::kUnknownForce,
                .variable = LawVariable::kTime,
                .parameters = Parameters(),
                .meaning = "a force that follows a curve over what predicts it: no "
                           "name, learned where no law is left",
                .odds = kLearned}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int joint,
                                         const EffectValues& values) const override {
    const auto variable = static_cast<CurveVariable>(std::lround(values[kVariable]));
    const int most = variable == CurveVariable::kCommand ? model.nu : model.nv;
    const std::string where = Where(*this, ElementName(model, mjOBJ_JOINT, joint));
    if (std::lround(values[kOf]) >= most) {
      throw InputError(where, "of is " + std::to_string(std::lround(values[kOf])),
                       "a number below " + std::to_string(most));
    }
    const CurveAxis axis = CurveAxisOf(values);
    if (axis.shape == CurveShapes::kSplit && !(axis.low < 0.0 && axis.high > 0.0)) {
      throw InputError(where, "is split at 0, where it is not",
                       "low < 0 < low + width");
    }
    return std::make_unique<CurveForce>(model, JointOf(model, joint), values);
  }
  std::vector<Site> CandidateSites(const SiteMap&) const override { return {}; }
  // Over the velocity of the first joint.
  Sized Draw(const Scales& k, Random& r) const override {
    EffectValues values = EffectValues::Zero(kFirst + kMostKnots);
    values[kVariable] = static_cast<double>(CurveVariable::kVelocity);
    values[kLow] = -k.speed;
    values[kWidth] = 2.0 * k.speed;
    values[kKnots] = kFewestKnots + 1;
    for (int i = 0; i <= kFewestKnots; ++i) {
      values[kFirst + i] = r.Uniform(-1.0, 1.0) * k.FrictionForce();
    }
    return [values](double s) {
      EffectValues sized = values;
      sized.tail(kMostKnots) *= s;
      return sized;
    };
  }
};

}  // namespace

CurveAxis::Weights CurveAxis::At(double x) const noexcept {
  Weights weights;
  if (shape != CurveShapes::kSplit) {
    AddPiece({low, high, shape, knots}, x, 0, 1.0, weights);
    return weights;
  }
  const int half = knots / 2;
  const double above = 0.5 * (1.0 + FactorOf(CurveFactor::kDirection, x, still));
  AddPiece({low, 0.0, CurveShapes::kPlain, half}, x, 0, 1.0 - above, weights);
  AddPiece({0.0, high, CurveShapes::kPlain, half}, x, half, above, weights);
  return weights;
}

double CurveAxis::KnotAt(int place) const noexcept {
  if (shape == CurveShapes::kPeriodic) return low + (high - low) * place / knots;
  if (shape == CurveShapes::kPlain) return low + (high - low) * place / (knots - 1);
  const int half = knots / 2;
  return place < half ? low - low * place / (half - 1)
                      : high * (place - half) / (half - 1);
}

CurveAxis CurveAxisOf(const Eigen::VectorXd& values) {
  return {values[kLow], values[kLow] + values[kWidth],
          static_cast<CurveShapes>(std::lround(values[kShape])),
          static_cast<int>(std::lround(values[kKnots])), values[kStill]};
}

double FactorOf(CurveFactor factor, double velocity, double still) noexcept {
  switch (factor) {
    case CurveFactor::kNone:
      return 1.0;
    case CurveFactor::kDirection:
      return still > 0.0 ? std::tanh(velocity / still)
                         : static_cast<double>((velocity > 0.0) - (velocity < 0.0));
    case CurveFactor::kVelocity:
      return velocity;
  }
  return 1.0;
}

const Effect& ForceCurve() {
  static const ForceCurveEffect effect;
  return effect;
}

}  // namespace mjdiag
