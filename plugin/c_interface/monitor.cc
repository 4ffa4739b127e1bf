// The functions of mjdiag.h that make a diagnosis.

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "controlled_machine.h"
#include "guard.h"
#include "handle.h"
#include "mjdiag.h"
#include "mjdiag/signals/text_file.h"

namespace {

using mjdiag::NotNull;
using mjdiag::Text;
using mjdiag::Try;
using mjdiag::Watch;
using Monitors = mjdiag::Handles<mjdiag_monitor>;

constexpr double kNever = std::numeric_limits<double>::quiet_NaN();

template <typename Handle>
auto& OpenedMonitor(Handle* handle) {
  return mjdiag::Opened(handle, "an open monitor");
}

/// The list of those names; its addresses are good for as long as the watch lives.
const std::vector<std::string>& NamesOf(const Watch& watch, mjdiag_kind kind) {
  switch (kind) {
    case MJDIAG_OUTPUT:
      return watch.design().outputs;
    case MJDIAG_INPUT:
      return watch.design().inputs;
    case MJDIAG_FAULT:
      return watch.faults();
  }
  throw mjdiag::InputError("mjdiag", "no such kind", "one of mjdiag_kind");
}

void RequireCount(const Watch& watch, int faults) {
  const std::size_t count = watch.faults().size();
  if (faults >= 0 && static_cast<std::size_t>(faults) == count) return;
  throw mjdiag::InputError("mjdiag", "room for " + std::to_string(faults) + " faults",
                           std::to_string(count));
}

/// The status of a tick that was taken (null), or why it was not.
int Answer(const char* refusal) noexcept {
  if (refusal == nullptr) return 0;
  mjdiag::Say(refusal);
  return 1;
}

/// A tick of a monitor, whose calls nest if the program's control callback makes them
/// for data that are not the program's (host_callback.h).
template <typename Work>
int Tick(mjdiag_monitor* monitor, const Work& work) noexcept {
  if (monitor == nullptr || monitor->object == nullptr) {
    return Answer("mjdiag: a monitor that is not open; expected an open one");
  }
  if (mjdiag::Inside::now()) {
    return Answer(
        "mjdiag: a tick from within a tick; expected one of the program's own data");
  }
  const mjdiag::Inside inside;
  return Answer(work(*monitor->object));
}

}  // namespace

mjdiag_monitor* mjdiag_monitor_open(const char* setup, const char* filters, int linear,
                                    int64_t room) {
  mjdiag_monitor* opened = nullptr;
  mjdiag::Guard([&] {
    opened = Monitors::Open(std::make_unique<Watch>(setup, filters, linear != 0, room));
  });
  return opened;
}

int mjdiag_monitor_count(const mjdiag_monitor* monitor, mjdiag_kind kind) {
  int count = -1;
  mjdiag::Guard(
      [&] { count = static_cast<int>(NamesOf(OpenedMonitor(monitor), kind).size()); });
  return count;
}

const char* mjdiag_monitor_name(const mjdiag_monitor* monitor, mjdiag_kind kind,
                                int index) {
  const char* name = nullptr;
  mjdiag::Guard([&] {
    const std::vector<std::string>& names = NamesOf(OpenedMonitor(monitor), kind);
    if (index < 0 || static_cast<std::size_t>(index) >= names.size()) {
      throw mjdiag::InputError("mjdiag", "no name with number " + std::to_string(index),
                               "0 to below " + std::to_string(names.size()));
    }
    name = names[static_cast<std::size_t>(index)].c_str();
  });
  return name;
}

double mjdiag_monitor_sample_time(const mjdiag_monitor* monitor) {
  double time = -1.0;
  mjdiag::Guard([&] { time = OpenedMonitor(monitor).design().sample_time(); });
  return time;
}

int mjdiag_monitor_watch(mjdiag_monitor* monitor, mjdiag_instance* instance) {
  return Try([&] {
    Watch& watch = OpenedMonitor(monitor);
    mjdiag::ControlledMachine& machine =
        mjdiag::Opened(instance, "an attached instance");
    mjdiag::RequireSameMachine("monitor", watch.design(), machine.setup);
    machine.relay.SendTo(*monitor);
    watch.TakeFrom(&machine.relay);
  });
}

int mjdiag_monitor_listen(mjdiag_monitor* monitor, const mjModel* model) {
  return Try([&] { OpenedMonitor(monitor).ListenTo(*NotNull(model, "a model")); });
}

int mjdiag_monitor_hear(mjdiag_monitor* monitor, const mjModel* model,
                        const mjData* data) {
  return Tick(monitor, [=](Watch& watch) noexcept {
    return model == nullptr || data == nullptr
               ? "mjdiag: a null pointer; expected a model and its data"
               : watch.Hear(*model, *data);
  });
}

int mjdiag_monitor_step(mjdiag_monitor* monitor, const double* y, int outputs,
                        const double* u, int inputs) {
  return Tick(monitor, [=](Watch& watch) noexcept {
    if (y == nullptr || u == nullptr || outputs < 0 || inputs < 0) {
      return "mjdiag: no readings or commands; expected two arrays";
    }
    return watch.TakeSample({y, static_cast<std::size_t>(outputs)},
                            {u, static_cast<std::size_t>(inputs)});
  });
}

int mjdiag_monitor_read(const mjdiag_monitor* monitor, mjdiag_reading* reading) {
  return Try([&] {
    const mjdiag::DiagnosisMonitor& seen = OpenedMonitor(monitor).monitor();
    const mjdiag::DiagnosisLimits& limits = seen.design().limits;
    const auto time_of = [&](const std::optional<Eigen::Index>& tick) {
      return tick ? static_cast<double>(*tick) * seen.design().sample_time() : kNever;
    };
    *NotNull(reading, "a mjdiag_reading") = {seen.samples(),
                                             seen.residuals()[0],
                                             limits.residual.limits.min,
                                             limits.residual.limits.max,
                                             seen.integral(),
                                             limits.integral,
                                             seen.residual_alarm() ? 1 : 0,
                                             seen.lasting_alarm() ? 1 : 0,
                                             time_of(seen.first_detection()),
                                             time_of(seen.first_lasting())};
  });
}

int mjdiag_monitor_estimates(const mjdiag_monitor* monitor, double* values, double* sd,
                             int faults) {
  return Try([&] {
    const Watch& watch = OpenedMonitor(monitor);
    RequireCount(watch, faults);
    NotNull(values, "an array of values");
    const mjdiag::DiagnosisMonitor& seen = watch.monitor();
    for (int i = 0; i < faults; ++i) {
      values[i] = seen.design().Healthy(i) + seen.estimate()[i];
      if (sd != nullptr) sd[i] = seen.estimate_sd()[i];
    }
  });
}

int mjdiag_monitor_named(const mjdiag_monitor* monitor, int* named, int faults) {
  return Try([&] {
    const Watch& watch = OpenedMonitor(monitor);
    RequireCount(watch, faults);
    NotNull(named, "an array of int");
    for (const mjdiag::FaultVerdict& fault : JudgeFaults(watch.monitor())) {
      *named++ = fault.detected ? 1 : 0;
    }
  });
}

const char* mjdiag_monitor_conclude(mjdiag_monitor* monitor) {
  const char* verdict = nullptr;
  mjdiag::Guard([&] { verdict = OpenedMonitor(monitor).Conclude().c_str(); });
  return verdict;
}

int mjdiag_monitor_write(const mjdiag_monitor* monitor, const char* file) {
  return Try(
      [&] { mjdiag::WriteTextFile(Text(file), OpenedMonitor(monitor).Json() + "\n"); });
}

int mjdiag_monitor_restart(mjdiag_monitor* monitor) {
  return Try([&] { OpenedMonitor(monitor).Restart(); });
}

void mjdiag_monitor_close(mjdiag_monitor* monitor) {
  if (monitor != nullptr) Monitors::Close(*monitor);
}
