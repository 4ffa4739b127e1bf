#pragma once
// Motion amplification: small motion drawn large enough to be seen. Each joint j is
// drawn at
//
//   q_drawn(t) = q_nominal(t) + a (q(t) - q_nominal(t))
//
// q          joint position of the run that is drawn [m or rad]
// q_nominal  what the joint would do on an ideal machine:
//            - a compliant joint (stiff spring, moved by no axis on purpose) would stay
//              where the reference run starts, which is at rest;
//            - a driven joint would follow the reference run (the healthy one).
// a          the factor of the joint's group, >= 1
//
// Joints of one role and one kind of motion form a group and share a factor, so that
// they keep their proportions. It follows from the data: the largest deviation of the
// group over the runs and times drawn, times a, is at most the wanted size on the
// picture; a is the largest such number of the form 1, 2 or 5 times 10^n. Driven joints
// share the smaller of their two groups' factors: with one of its own, the rounding
// noise of an axis that follows the reference would look like the fault of another.

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mjdiag/render/record_sampling.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

enum class JointMotion { kTranslation, kRotation };
enum class JointRole { kDriven, kCompliant };

/// A joint as it is drawn. Its record channel is "joint.<name>".
struct DrawnJoint {
  std::string name;
  JointMotion motion = JointMotion::kTranslation;
  JointRole role = JointRole::kDriven;
};

/// "joint.<name>"
std::string JointChannel(const DrawnJoint& joint);

struct AmplificationOptions {
  double drawn_length = 0.0;  ///< wanted largest drawn deviation, translation [m]
  double drawn_angle = 0.0;   ///< the same for rotation [rad]
  /// Joint name -> factor, given by the user; takes the joint out of its group.
  std::map<std::string, double> factors = {};
  std::optional<double> all =
      std::nullopt;  ///< factor of every joint without an own one
};

/// The largest of {1, 2, 5} x 10^n that is <= value; value > 0.
double RoundDown125(double value);

class Amplification {
 public:
  /// @param reference  the run that driven joints are compared with
  /// @param runs       the runs that are drawn, the reference among them or not
  /// InputError names a missing "joint.<name>" channel, an unknown joint in
  /// options.factors, or a factor that is not finite and >= 0.
  Amplification(std::vector<DrawnJoint> joints, const Record& reference,
                std::span<const Record* const> runs, TimeRange range,
                const AmplificationOptions& options);

  const std::vector<DrawnJoint>& joints() const { return joints_; }
  /// Factor of each joint, in the order of joints().
  const std::vector<double>& factors() const { return factors_; }
  /// The factor that all joints of the group share; nothing if the group is empty or
  /// the user split it.
  std::optional<double> GroupFactor(JointRole role, JointMotion motion) const;
  /// Positions [m or rad] to draw `run` with at `time` [s], in the order of joints().
  Eigen::VectorXd DrawnPositions(const Record& run, double time) const;

 private:
  double Nominal(std::size_t joint, double time) const;
  double PeakDeviation(std::size_t joint, std::span<const Record* const> runs,
                       TimeRange range) const;

  std::vector<DrawnJoint> joints_;
  const Record* reference_;
  std::vector<const Channel*> reference_channels_;
  std::vector<double> factors_;
};

}  // namespace mjdiag
