// The C interface, call by call in any order. The only rules kept are those of its header
// that no library can check: what is handed over as a model or its data is that, data are
// deleted when nothing is attached to them, and handles come from the library.
//
// Input: calls of two bytes, which one and what with.

#include <mujoco/mujoco.h>

#include <array>
#include <limits>
#include <vector>

#include "fuzz/target.h"
#include "mjdiag.h"

namespace mjdiag::fuzz {
namespace {

constexpr int kMostCalls = 64;
/// Handles are kept for good, and to open is slow: so many of each an input.
constexpr int kMostOpened = 2;
constexpr int kRoom = 32;  // ticks

const char* StageFolder() {
  static const std::string folder = Folder().string();
  return folder.c_str();
}
const char* StageFilters() {
  static const std::string file = (Folder() / "filters.json").string();
  return file.c_str();
}

/// Opened with the setup, which takes longer: one for all inputs.
mjdiag_monitor* LastingMonitor() {
  static mjdiag_monitor* const monitor =
      mjdiag_monitor_open(StageFolder(), StageFilters(), 1, kRoom);
  Require(monitor != nullptr, std::string("no monitor: ") + mjdiag_last_error());
  return monitor;
}

const mjModel* FreshModel() {
  static const mjModel* const model = [] {
    std::array<char, 500> error{};
    return mj_loadXML((Folder() / "plant.xml").c_str(), nullptr, error.data(),
                      error.size());
  }();
  return model;
}

/// What a program has in its hands.
class Program {
 public:
  Program() : model_(mj_copyModel(nullptr, FreshModel())) {}
  ~Program() {
    for (mjdiag_instance* instance : instances_) mjdiag_detach(instance);
    for (std::size_t i = 1; i < monitors_.size(); ++i) {
      mjdiag_monitor_close(monitors_[i]);
    }
    if (data_ != nullptr) mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void Call(std::size_t which, std::uint8_t with);

 private:
  mjdiag_monitor*& Monitor(std::uint8_t with) {
    return monitors_[with % monitors_.size()];
  }
  mjdiag_instance*& Instance(std::uint8_t with) {
    return instances_[with % instances_.size()];
  }
  void MakeData();
  void OpenMonitor(std::uint8_t with);
  void Attach(std::uint8_t with);
  void Restart(std::uint8_t with);
  void Hear(std::uint8_t with);
  void Sample(std::uint8_t with);
  void Ask(std::uint8_t with);
  /// A call that failed says why.
  static void Status(int status) {
    Require(status == 0 || mjdiag_last_error()[0] != '\0', "a failure without a word");
  }

  mjModel* model_;
  mjData* data_ = nullptr;
  /// The first is the one that lasts.
  std::array<mjdiag_monitor*, 3> monitors_{};
  std::array<mjdiag_instance*, 2> instances_{};
  bool prepared_ = false;
  int opened_ = 0;
  int attached_ = 0;
};

void Program::MakeData() {
  for (mjdiag_instance* instance : instances_) mjdiag_detach(instance);
  if (data_ != nullptr) mj_deleteData(data_);
  data_ = mj_makeData(model_);
}

void Program::OpenMonitor(std::uint8_t with) {
  mjdiag_monitor*& monitor = monitors_[1 + with % 2U];
  if (opened_++ >= kMostOpened) return;
  mjdiag_monitor_close(monitor);
  const bool file = with % 16 != 15;
  monitor = mjdiag_monitor_open(nullptr, file ? StageFilters() : nullptr, 0,
                                with % 8 == 7 ? -1 : with % kRoom);
}

void Program::Attach(std::uint8_t with) {
  if (attached_++ >= kMostOpened) return;
  const char* const names[] = {nullptr, "default", "none", ""};
  mjdiag_instance* made =
      mjdiag_attach(model_, data_, StageFolder(), names[with / 2U % 4U], with);
  if (made == nullptr) return Status(1);
  mjdiag_detach(Instance(with));
  Instance(with) = made;
}

void Program::Restart(std::uint8_t with) {
  if (with % monitors_.size() != 0) {
    return Status(mjdiag_monitor_restart(Monitor(with)));
  }
  // Its twin is made anew, which takes a while.
  if (monitors_[0] != nullptr) return;
  monitors_[0] = LastingMonitor();
  Status(mjdiag_monitor_restart(monitors_[0]));
}

void Program::Hear(std::uint8_t with) {
  if (data_ == nullptr) {
    return Status(mjdiag_monitor_hear(Monitor(with), model_, data_));
  }
  mj_step1(model_, data_);
  Status(mjdiag_monitor_hear(Monitor(with), model_, data_));
  mj_step2(model_, data_);
  for (int i = 0; i < with / 16; ++i) mj_step(model_, data_);
}

void Program::Sample(std::uint8_t with) {
  constexpr std::array<double, 8> kReadings{0.0,
                                            1e-3,
                                            -1e-3,
                                            1.0,
                                            1e300,
                                            -1e300,
                                            std::numeric_limits<double>::infinity(),
                                            std::numeric_limits<double>::quiet_NaN()};
  const std::array<double, 2> y{kReadings[with / 4U % 8U], 0.0};
  const std::array<double, 2> u{kReadings[with / 32U], 0.0};
  for (int k = 0; k < 8; ++k) {
    Status(mjdiag_monitor_step(Monitor(with), y.data(), with % 64 == 63 ? 2 : 1,
                               u.data(), 1));
  }
}

void Program::Ask(std::uint8_t with) {
  const mjdiag_monitor* monitor = Monitor(with);
  mjdiag_reading reading;
  Status(mjdiag_monitor_read(monitor, &reading));
  mjdiag_monitor_sample_time(monitor);
  const auto kind = static_cast<mjdiag_kind>(with / 4U % 3U);
  const int count = mjdiag_monitor_count(monitor, kind);
  for (int i = -1; i <= count; ++i) mjdiag_monitor_name(monitor, kind, i);
  const int faults = mjdiag_monitor_count(monitor, MJDIAG_FAULT);
  std::vector<double> values(static_cast<std::size_t>(std::max(faults, 0)));
  std::vector<int> named(values.size());
  const int asked = with % 32 == 31 ? faults + 1 : faults;
  Status(mjdiag_monitor_estimates(monitor, values.data(), nullptr, asked));
  Status(mjdiag_monitor_named(monitor, named.data(), asked));
}

void Program::Call(std::size_t which, std::uint8_t with) {
  switch (which) {
    case 0:
      if (prepared_) return;  // once, the header says
      prepared_ = with != 255;
      return Status(mjdiag_prepare(prepared_ ? model_ : nullptr, StageFolder()));
    case 1:
      return MakeData();
    case 2:
      return Status(mjdiag_rest(model_, data_, StageFolder()));
    case 3:
      return Attach(with);
    case 4:
      return mjdiag_detach(Instance(with));
    case 5:
      for (int i = 0; data_ != nullptr && i <= with / 8; ++i) mj_step(model_, data_);
      return;
    case 6:
      mjdiag_ticks(Instance(with));
      return Status(
          mjdiag_write_record(Instance(with), (Folder() / "written.csv").c_str()));
    case 7:
      return OpenMonitor(with);
    case 8:
      if (with % monitors_.size() != 0) mjdiag_monitor_close(Monitor(with));
      return;
    case 9:
      return Status(mjdiag_monitor_watch(Monitor(with), Instance(with / 4)));
    case 10:
      return Status(mjdiag_monitor_listen(Monitor(with), model_));
    case 11:
      return Hear(with);
    case 12:
      return Sample(with);
    case 13:
      return Ask(with);
    case 14:
      return Status(mjdiag_monitor_conclude(Monitor(with)) == nullptr ? 1 : 0);
    case 15:
      return Status(
          mjdiag_monitor_write(Monitor(with), (Folder() / "written.json").c_str()));
    case 16:
      return Restart(with);
    case 17:
      return Status(
          mjdiag_set_fault(model_, with % 2 == 0 ? "zeta" : "none", 0.02 * (with - 4)));
    default:
      if (data_ != nullptr) mj_resetData(model_, data_);
      return;
  }
}

}  // namespace

void FuzzCInterface(Input input) {
  Choices choices(input);
  Program program;
  for (int call = 0; call < kMostCalls && !choices.empty(); ++call) {
    const std::size_t which = choices.Below(19);
    program.Call(which, choices.Byte());
  }
}

}  // namespace mjdiag::fuzz
