#include "mjdiag/controllers/reconfiguration.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Part of k sd below which a fault that was certain is so no more.
constexpr double kHysteresis = 0.5;

double LawAt(ForceLaw law, double deviation) {
  return law == ForceLaw::kProportional ? deviation : 1.0 / (1.0 + deviation) - 1.0;
}

void CheckForces(const FaultRemedy& remedy, const MatrixXd& forces, Index axes) {
  if (forces.size() == 0 || (forces.rows() == axes && forces.cols() == axes)) return;
  throw InputError("remedy of " + remedy.fault, "forces of another number of axes",
                   std::to_string(axes) + " by " + std::to_string(axes));
}

void Check(const FaultRemedy& remedy, Index axes) {
  const std::string where = "remedy of " + remedy.fault;
  for (const Index drive : remedy.drives) {
    if (drive < 0 || drive >= axes) {
      throw InputError(where, "no axis " + std::to_string(drive),
                       "one of " + std::to_string(axes));
    }
  }
  for (const MatrixXd& forces : {remedy.forces.position, remedy.forces.velocity,
                                 remedy.forces.acceleration, remedy.forces.snap}) {
    CheckForces(remedy, forces, axes);
  }
  for (const RemediedTone& tone : remedy.tones) {
    if (tone.amplitude.size() != axes) {
      throw InputError(where, "a tone on another number of axes", std::to_string(axes));
    }
  }
  if (!(remedy.least > -1.0 && remedy.least <= 0.0 && remedy.most >= 0.0)) {
    throw InputError(where, "its deviations do not hold 0, or reach -1",
                     "-1 < least <= 0 <= most");
  }
}

Index TicksOf(double time, double sample_time) {
  return static_cast<Index>(std::lround(time / sample_time));
}

}  // namespace

Reconfiguration::Reconfiguration(std::vector<RemediedAxis> axes,
                                 std::vector<FaultRemedy> remedies,
                                 const ReconfigurationOptions& options)
    : axes_(std::move(axes)),
      remedies_(std::move(remedies)),
      options_(options),
      decisions_(remedies_.size()),
      states_(remedies_.size()),
      corrections_(axes_.size()) {
  const auto n = static_cast<Index>(axes_.size());
  if (!(options.sample_time > 0.0) || !(options.time_constant > 0.0)) {
    throw InputError("reconfiguration",
                     "a sample time or time constant is not positive", "seconds > 0");
  }
  Index tones = 0;
  for (const FaultRemedy& remedy : remedies_) {
    Check(remedy, n);
    tones += 2 * static_cast<Index>(remedy.tones.size());
  }
  step_ = 1.0 - std::exp(-options.sample_time / options.time_constant);
  persistence_ = std::max<Index>(1, TicksOf(options.persistence, options.sample_time));
  patience_ = TicksOf(options.patience, options.sample_time);
  tones_ = VectorXd::Zero(tones);
  force_ = cancelled_ = position_ = velocity_ = acceleration_ = snap_ =
      VectorXd::Zero(n);
}

FaultEstimates Reconfiguration::MakeEstimates() const {
  const auto faults = static_cast<Index>(remedies_.size());
  return {VectorXd::Zero(faults),
          VectorXd::Constant(faults, std::numeric_limits<double>::quiet_NaN()),
          VectorXd::Zero(tones_.size())};
}

void Reconfiguration::Decide(std::size_t remedy, double deviation, double sd) noexcept {
  Decision& now = decisions_[remedy];
  RemedyState& state = states_[remedy];
  const double chance = options_.sigmas * sd;  // NaN: nothing is known
  const double limit = std::max(chance, options_.least);
  // NaN is no limit that anything is beyond.
  const bool sees = std::isfinite(chance) &&
                    std::abs(deviation) > (state.certain ? kHysteresis * limit : limit);
  if (sees) {
    ++now.seen;
    now.doubted = 0;
  } else {
    now.seen = 0;
    ++now.doubted;
  }
  const bool gone = chance < std::abs(now.held);
  if (!state.certain) {
    if (now.seen < persistence_) return;
    state.certain = true;
    state.until = -1;
    if (state.since < 0) state.since = ticks_;
  } else if (!sees && (gone || now.doubted > patience_)) {
    state.certain = false;
    state.until = ticks_;
    now.held = 0.0;
    return;
  }
  if (!sees) return;
  now.held = std::clamp(deviation, remedies_[remedy].least, remedies_[remedy].most);
}

void Reconfiguration::Observe(const FaultEstimates& estimates) noexcept {
  Index tone = 0;
  for (std::size_t i = 0; i < remedies_.size(); ++i) {
    const auto at = static_cast<Index>(i);
    Decide(i, estimates.deviation[at], estimates.sd[at]);
    RemedyState& state = states_[i];
    state.acting += step_ * (decisions_[i].held - state.acting);
    // As long as an estimate is waited for, tones stay as they are.
    const bool fresh = decisions_[i].doubted == 0;
    for (std::size_t k = 0; k < 2 * remedies_[i].tones.size(); ++k, ++tone) {
      if (!state.certain) {
        tones_[tone] -= step_ * tones_[tone];
      } else if (fresh) {
        tones_[tone] += step_ * (estimates.tones[tone] - tones_[tone]);
      }
    }
  }
  ++ticks_;
}

std::span<const AxisCorrection> Reconfiguration::Correct(
    std::span<const ReferenceSample> references) noexcept {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto at = static_cast<Index>(i);
    corrections_[i].gain = 1.0;
    // Held for a tick, a force is that of its middle.
    const double half = 0.5 * options_.sample_time;
    position_[at] =
        references[i].position + half * references[i].velocity - axes_[i].rest;
    velocity_[at] = references[i].velocity + half * references[i].acceleration;
    acceleration_[at] = references[i].acceleration;
    snap_[at] = references[i].snap;
  }
  force_.setZero();
  cancelled_.setZero();
  const double time = static_cast<double>(ticks_) * options_.sample_time;
  Index tone = 0;
  for (std::size_t i = 0; i < remedies_.size(); ++i) {
    const FaultRemedy& remedy = remedies_[i];
    const double acting = states_[i].acting;
    for (const Index drive : remedy.drives) {
      corrections_[static_cast<std::size_t>(drive)].gain /= 1.0 + acting;
    }
    const double law = LawAt(remedy.law, acting);
    const ReferenceForces& along = remedy.forces;
    if (along.position.size() > 0) force_.noalias() += law * along.position * position_;
    if (along.velocity.size() > 0) force_.noalias() += law * along.velocity * velocity_;
    if (along.acceleration.size() > 0) {
      force_.noalias() += law * along.acceleration * acceleration_;
    }
    if (along.snap.size() > 0) force_.noalias() += law * along.snap * snap_;
    for (const RemediedTone& wave : remedy.tones) {
      const double angle = 2.0 * std::numbers::pi * wave.frequency * time;
      const double level =
          tones_[tone] * std::sin(angle) + tones_[tone + 1] * std::cos(angle);
      cancelled_ += level * wave.amplitude;
      tone += 2;
    }
  }
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto at = static_cast<Index>(i);
    AxisCorrection& correction = corrections_[i];
    correction.gain =
        std::clamp(correction.gain, axes_[i].least_gain, axes_[i].most_gain);
    correction.addition =
        (correction.gain * force_[at] - cancelled_[at]) / axes_[i].drive_gain;
  }
  return corrections_;
}

}  // namespace mjdiag
