#include "mjdiag/render/amplification.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

// Deviations below this are rounding, not motion: a factor made of them would show
// noise [m or rad].
constexpr double kNoMotion = 1e-15;

const Channel& JointSamples(const Record& record, const DrawnJoint& joint) {
  const std::string name = JointChannel(joint);
  const Channel* channel = record.Find(name);
  if (channel == nullptr) {
    throw InputError("record", "no channel \"" + name + "\"",
                     "the position of every joint (a run that logs its joints)");
  }
  if (channel->samples.size() == 0) {
    throw InputError("record", "channel \"" + name + "\" is empty", "samples");
  }
  return *channel;
}

void CheckFactors(const std::vector<DrawnJoint>& joints,
                  const AmplificationOptions& options) {
  const auto check = [](const std::string& joint, double factor) {
    if (std::isfinite(factor) && factor >= 0.0) return;
    throw InputError("amplification of " + joint, std::to_string(factor),
                     "a finite number >= 0");
  };
  if (options.all) check("all joints", *options.all);
  for (const auto& [name, factor] : options.factors) {
    check(name, factor);
    std::string names;
    bool found = false;
    for (const DrawnJoint& joint : joints) {
      found = found || joint.name == name;
      names += (names.empty() ? "" : ", ") + joint.name;
    }
    if (!found) {
      throw InputError("amplification", "no joint \"" + name + "\"",
                       "one of: " + names);
    }
  }
}

}  // namespace

std::string JointChannel(const DrawnJoint& joint) { return "joint." + joint.name; }

double RoundDown125(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  // The slack keeps 5 a 5 when it arrives as 4.999999999.
  const double mantissa = value / decade * (1.0 + 1e-9);
  constexpr std::array kSteps{10.0, 5.0, 2.0, 1.0};
  for (const double step : kSteps) {
    if (mantissa >= step) return step * decade;
  }
  return decade;
}

Amplification::Amplification(std::vector<DrawnJoint> joints, const Record& reference,
                             std::span<const Record* const> runs, TimeRange range,
                             const AmplificationOptions& options)
    : joints_(std::move(joints)), reference_(&reference) {
  CheckFactors(joints_, options);
  for (const DrawnJoint& joint : joints_) {
    reference_channels_.push_back(&JointSamples(reference, joint));
  }

  std::map<std::pair<JointRole, JointMotion>, double> peaks;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    double& peak = peaks[{joints_[j].role, joints_[j].motion}];
    peak = std::max(peak, PeakDeviation(j, runs, range));
  }
  const auto fitting = [&](JointRole role, JointMotion motion) {
    const double wanted = motion == JointMotion::kTranslation ? options.drawn_length
                                                              : options.drawn_angle;
    const double peak = peaks[{role, motion}];
    return peak < kNoMotion || wanted < peak ? 1.0 : RoundDown125(wanted / peak);
  };
  const auto moves = [&](JointMotion motion) {
    return peaks[{JointRole::kDriven, motion}] >= kNoMotion;
  };
  const auto choose = [&](const DrawnJoint& joint) {
    const auto own = options.factors.find(joint.name);
    if (own != options.factors.end()) return own->second;
    if (options.all) return *options.all;
    const double factor = fitting(joint.role, joint.motion);
    const JointMotion other = joint.motion == JointMotion::kTranslation
                                  ? JointMotion::kRotation
                                  : JointMotion::kTranslation;
    if (joint.role == JointRole::kCompliant || !moves(joint.motion) || !moves(other)) {
      return factor;
    }
    return std::min(factor, fitting(joint.role, other));
  };
  for (const DrawnJoint& joint : joints_) factors_.push_back(choose(joint));
}

double Amplification::Nominal(std::size_t joint, double time) const {
  const Eigen::VectorXd& samples = reference_channels_[joint]->samples;
  return joints_[joint].role == JointRole::kCompliant
             ? samples[0]
             : SampleAt(*reference_, samples, time);
}

double Amplification::PeakDeviation(std::size_t joint,
                                    std::span<const Record* const> runs,
                                    TimeRange range) const {
  double peak = 0.0;
  for (const Record* run : runs) {
    const Eigen::VectorXd& samples = JointSamples(*run, joints_[joint]).samples;
    const SampleRange within = SamplesWithin(*run, range);
    for (Eigen::Index k = within.first; k <= within.last; ++k) {
      const double time =
          run->start_time() + static_cast<double>(k) * run->sample_time();
      peak = std::max(peak, std::abs(samples[k] - Nominal(joint, time)));
    }
  }
  return peak;
}

std::optional<double> Amplification::GroupFactor(JointRole role,
                                                 JointMotion motion) const {
  std::optional<double> factor;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if (joints_[j].role != role || joints_[j].motion != motion) continue;
    if (factor && *factor != factors_[j]) return std::nullopt;
    factor = factors_[j];
  }
  return factor;
}

Eigen::VectorXd Amplification::DrawnPositions(const Record& run, double time) const {
  Eigen::VectorXd drawn(static_cast<Eigen::Index>(joints_.size()));
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const double nominal = Nominal(j, time);
    const double actual = SampleAt(run, JointSamples(run, joints_[j]).samples, time);
    drawn[static_cast<Eigen::Index>(j)] = nominal + factors_[j] * (actual - nominal);
  }
  return drawn;
}

}  // namespace mjdiag
