#pragma once
// Where effects act on a machine: the joints, actuators and sensors at which one makes
// sense physically.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

struct Site {
  std::string name;  ///< of the MJCF element
  /// Joint that is acted on most, for signatures and plots; of an encoder error the
  /// joint that its sensor sees; nq index.
  Eigen::Index joint = 0;
  /// Its place among the setup's actuators or sensors, if it is one; else -1.
  Eigen::Index channel = -1;
};

/// The joint (nq index) that every actuator of the setup moves most, and the one that
/// every sensor sees most.
std::vector<Eigen::Index> DrivenJoints(const MechanicalModel& model);
std::vector<Eigen::Index> SeenJoints(const MechanicalModel& model);
/// Joints that the sensors tell: of every sensor the one that it sees most, of one that sees
/// most what another has told already the next one: a second encoder, behind a gear that
/// gives, tells how far that does.
std::vector<Eigen::Index> ToldJoints(const MechanicalModel& model);

/// A machine as effects look for their sites on it. Does not own what it is made of.
class SiteMap {
 public:
  /// @param with_seen  joints that sensors see count as driven, and those that no spring of
  ///                   their own holds: what hangs on a machine rubs too
  SiteMap(const mjModel& plant, const MechanicalModel& model, const Channels& channels,
          bool with_seen = false);

  const mjModel& plant() const { return plant_; }
  const MechanicalModel& model() const { return model_; }
  const Channels& channels() const { return channels_; }

  std::vector<Site> Actuators() const;
  /// Those that read positions.
  std::vector<Site> Sensors() const;
  /// Sites of the joints with those indices that are slides or hinges.
  std::vector<Site> Joints(const std::vector<Eigen::Index>& joints) const;
  /// Those that an actuator moves, each once.
  const std::vector<Eigen::Index>& driven() const { return driven_; }
  /// Those with a spring.
  std::vector<Eigen::Index> Held() const;
  /// Those of bodies that stand on the world.
  std::vector<Eigen::Index> Ground() const;

 private:
  const mjModel& plant_;
  const MechanicalModel& model_;
  const Channels& channels_;
  std::vector<Eigen::Index> driven_;
};

/// The joints that are not among the others.
std::vector<Eigen::Index> Without(std::vector<Eigen::Index> joints,
                                  const std::vector<Eigen::Index>& others);

}  // namespace mjdiag
