#pragma once
// A diagnosis as a program in C has it: a monitor with its recorder, where its ticks
// come from, and what becomes of those that are no good.
//
// A monitor needs one tick after the other. One that is bad or missing ends its run: what
// it said until then can be read and concluded, and a restart begins another run.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/diagnosis_result.h"
#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {

class Watch {
 public:
  /// @param setup    null: filters alone, without a twin
  /// @param filters  null: designed now, with limits from simulated runs
  /// @param linear   the machine is taken as linear
  /// @param room     ticks that a conclusion can look back on
  /// InputError if both are null, or as PrepareDiagnosis.
  Watch(const char* setup, const char* filters, bool linear, Eigen::Index room);

  const DiagnosisDesign& design() const { return prepared_.design; }
  const DiagnosisMonitor& monitor() const { return recording_->monitor; }
  /// Names of the faults, in the order of all that is said of them.
  const std::vector<std::string>& faults() const { return faults_; }
  /// Where its ticks come from; null: not known yet.
  const void* source() const { return source_; }

  /// As it was when it was made.
  void Restart();

  /// Its ticks will come from that source. InputError if they have one.
  void TakeFrom(const void* source);
  /// They will be those of data of this model (Hear). InputError if it is not as the
  /// setup says.
  void ListenTo(const mjModel& model);

  /// One control tick. Does not allocate, lock, throw or do I/O.
  /// @return null, or why the tick was not taken
  const char* Take(const void* source, std::span<const double> outputs,
                   std::span<const double> inputs) noexcept;
  /// The same of a monitor without a source: samples are its source from then on.
  const char* TakeSample(std::span<const double> outputs,
                         std::span<const double> inputs) noexcept;
  /// The same from the sensors and controls in `data`, at the first of the physics
  /// steps of a tick; the others are passed over.
  const char* Hear(const mjModel& model, const mjData& data) noexcept;

  /// Ends the run; the verdict in a sentence. InputError without ticks, or with more than
  /// there is room for, or as Conclude.
  const std::string& Conclude();
  /// diagnosis.json. InputError if the run is not concluded.
  std::string Json() const;

 private:
  const char* Add(std::span<const double> outputs,
                  std::span<const double> inputs) noexcept;
  const char* End(const char* why) noexcept { return ended_ = why; }

  std::optional<Machine> machine_;
  PreparedDiagnosis prepared_;
  std::vector<std::string> faults_;
  Eigen::Index room_;
  std::optional<DiagnosisRecording> recording_;
  const void* source_ = nullptr;
  const char* ended_ = nullptr;  // why no more ticks are taken
  bool finished_ = false;
  std::optional<DiagnosisResult> result_;
  std::string verdict_;
  // Of data that it listens to.
  std::vector<int> sensors_;    // addresses
  std::vector<int> actuators_;  // addresses
  std::vector<double> outputs_;
  std::vector<double> inputs_;
  std::optional<double> heard_;  // time of the last tick [s]
};

}  // namespace mjdiag
