#pragma once
// One joint by itself, on which an effect shows what it does: 2 kg on a slide, or
// 2 kg m^2 on a hinge, without gravity, friction or spring unless they are asked for.
// Motor "motor" with gear 1, encoder "encoder", physics at 10 kHz.

#include <mujoco/mujoco.h>

#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "mjdiag/plugin/effects/active_effect.h"
#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag::test {

/// Compiles MJCF from memory.
inline ModelPtr ModelOf(const std::string& mjcf) {
  mjVFS files;
  mj_defaultVFS(&files);
  mj_makeEmptyFileVFS(&files, "m.xml", static_cast<int>(mjcf.size()));
  std::memcpy(files.filedata[0], mjcf.data(), mjcf.size());
  char error[512] = "";
  ModelPtr model(mj_loadXML("m.xml", &files, error, sizeof(error)));
  mj_deleteVFS(&files);
  if (!model) throw std::runtime_error(error);
  return model;
}

class EffectBench {
 public:
  static constexpr double kMass = 2.0;   // kg, or kg m^2 about the hinge
  static constexpr double kStep = 1e-4;  // s

  explicit EffectBench(const std::vector<std::string>& effects,
                       const std::string& joint = "type=\"slide\"",
                       const std::string& motor = "gear=\"1\"")
      : model_(
            ModelOf("<mujoco><option timestep=\"0.0001\" gravity=\"0 0 0\"/>"
                    "<worldbody><body><joint name=\"q\" " +
                    joint +
                    "/><inertial pos=\"0 0 0\" mass=\"2\" diaginertia=\"2 2 2\"/>"
                    "</body></worldbody><actuator><motor name=\"motor\" joint=\"q\" " +
                    motor +
                    "/></actuator><sensor><jointpos name=\"encoder\" joint=\"q\"/>"
                    "</sensor></mujoco>")) {
    std::vector<PlacedEffect> specs;
    for (const std::string& effect : effects) {
      specs.push_back(ParseEffect(effect));
      ApplyEffect(*model_, specs.back());
    }
    data_ = MakeData(*model_);
    effects_ = std::make_unique<ActiveEffects>(Channels{}, *model_, specs);
  }

  double& q() { return data_->qpos[0]; }
  double& v() { return data_->qvel[0]; }
  double time() const { return data_->time; }
  mjModel& model() { return *model_; }

  /// A step of the physics with that command, as a run of a setup makes it.
  void Step(double command = 0.0) {
    mj_step1(model_.get(), data_.get());
    data_->ctrl[0] = command;
    effects_->Act(*model_, *data_);
    mj_step2(model_.get(), data_.get());
  }
  void StepUntil(double time, double command = 0.0) {
    while (data_->time < time - 0.5 * kStep) Step(command);
  }

  /// What effects, springs and the motor do to the joint at this position and velocity
  /// [N], without dry friction; effects with a memory take a step.
  double ForceAt(double position, double velocity, double command = 0.0) {
    q() = position;
    v() = velocity;
    mj_step1(model_.get(), data_.get());
    data_->ctrl[0] = command;
    effects_->Act(*model_, *data_);
    mj_fwdActuation(model_.get(), data_.get());
    return data_->qfrc_applied[0] + data_->qfrc_passive[0] + data_->qfrc_actuator[0];
  }

 private:
  ModelPtr model_;
  DataPtr data_;
  std::unique_ptr<ActiveEffects> effects_;
};

}  // namespace mjdiag::test
