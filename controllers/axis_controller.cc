#include "mjdiag/controllers/axis_controller.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

bool AllFinite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](double value) { return std::isfinite(value); });
}

/// C(z) in the transposed direct form II: as many states as the order of C.
class Compensator {
 public:
  explicit Compensator(const DiscreteCompensator& c) {
    const std::size_t order = c.denominator.size() - 1;
    const double lead = c.denominator.front();
    denominator_.assign(c.denominator.begin() + 1, c.denominator.end());
    numerator_.assign(order + 1 - c.numerator.size(), 0.0);
    numerator_.insert(numerator_.end(), c.numerator.begin(), c.numerator.end());
    for (double& a : denominator_) a /= lead;
    for (double& b : numerator_) b /= lead;
    // One state more than the order; the last one stays 0 and ends the recursion.
    state_.assign(order + 1, 0.0);
  }

  void Reset() noexcept { std::fill(state_.begin(), state_.end(), 0.0); }

  double Update(double error) noexcept {
    const double output = numerator_[0] * error + state_[0];
    for (std::size_t i = 0; i < denominator_.size(); ++i) {
      state_[i] = numerator_[i + 1] * error - denominator_[i] * output + state_[i + 1];
    }
    return output;
  }

 private:
  std::vector<double> numerator_;    ///< b0 .. bn
  std::vector<double> denominator_;  ///< a1 .. an; a0 = 1
  std::vector<double> state_;
};

class FeedforwardFeedback final : public AxisController {
 public:
  FeedforwardFeedback(const FeedforwardGains& feedforward,
                      const DiscreteCompensator& feedback, ControlMode mode)
      : feedforward_(feedforward), feedback_(feedback), mode_(mode) {}

  void Reset(double /*position*/) noexcept override { feedback_.Reset(); }

  double Update(const ReferenceSample& reference, double measured,
                double disturbance) noexcept override {
    double command = disturbance;
    if (mode_ != ControlMode::kFeedback) {
      command += gain_ * (feedforward_.snap * reference.snap +
                          feedforward_.acceleration * reference.acceleration +
                          feedforward_.velocity * reference.velocity);
    }
    if (mode_ != ControlMode::kFeedforward) {
      command += feedback_.Update(gain_ * (reference.position - measured));
    }
    return command;
  }

  void SetGain(double gain) noexcept override { gain_ = gain; }

 private:
  FeedforwardGains feedforward_;
  Compensator feedback_;
  ControlMode mode_;
  double gain_ = 1.0;
};

class NestedLoopController final : public AxisController {
 public:
  NestedLoopController(const NestedLoops& gains, double sample_time)
      : gains_(gains), rate_(1.0 / sample_time) {}

  void Reset(double position) noexcept override {
    previous_ = position;
    previous_mean_ = position;
  }

  double Update(const ReferenceSample& reference, double measured,
                double disturbance) noexcept override {
    const double mean = 0.5 * (measured + previous_);
    const double velocity = (mean - previous_mean_) * rate_;
    previous_ = measured;
    previous_mean_ = mean;
    const double command = gain_ * (gains_.position_gain * gains_.velocity_gain *
                                        (reference.position - measured) -
                                    gains_.velocity_gain * velocity) +
                           disturbance;
    if (gains_.saturation == 0.0) return command;
    return std::clamp(command, -gains_.saturation, gains_.saturation);
  }

  void SetGain(double gain) noexcept override { gain_ = gain; }

 private:
  NestedLoops gains_;
  double rate_;                 ///< [Hz]
  double previous_ = 0.0;       ///< q(k-1)
  double previous_mean_ = 0.0;  ///< qf(k-1)
  double gain_ = 1.0;
};

}  // namespace

std::unique_ptr<AxisController> MakeFeedforwardFeedback(
    const FeedforwardGains& feedforward, const DiscreteCompensator& feedback,
    ControlMode mode) {
  const std::string where = "feedback";
  if (feedback.numerator.empty() || feedback.denominator.empty()) {
    throw InputError(where, "numerator or denominator is empty",
                     "coefficients in descending powers of z");
  }
  if (!AllFinite(feedback.numerator) || !AllFinite(feedback.denominator)) {
    throw InputError(where, "a coefficient is not finite", "numbers");
  }
  if (feedback.denominator.front() == 0.0) {
    throw InputError(where, "the first coefficient of the denominator is 0",
                     "the coefficient of its highest power of z");
  }
  if (feedback.numerator.size() > feedback.denominator.size()) {
    throw InputError(where, "the numerator is of higher order than the denominator",
                     "a proper compensator");
  }
  return std::make_unique<FeedforwardFeedback>(feedforward, feedback, mode);
}

std::unique_ptr<AxisController> MakeNestedLoops(const NestedLoops& gains,
                                                double sample_time) {
  const std::string where = "nested loops";
  if (!(sample_time > 0.0)) {
    throw InputError(where, "sample time is not positive", "seconds > 0");
  }
  if (!std::isfinite(gains.position_gain) || !std::isfinite(gains.velocity_gain)) {
    throw InputError(where, "a gain is not finite", "numbers");
  }
  if (!(gains.saturation >= 0.0)) {
    throw InputError(where, "saturation is negative", "a number >= 0; 0 for none");
  }
  return std::make_unique<NestedLoopController>(gains, sample_time);
}

}  // namespace mjdiag
