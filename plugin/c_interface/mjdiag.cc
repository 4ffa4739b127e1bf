#include "mjdiag.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "mjdiag/plugin/plant/time_step.h"
#include "mjdiag/plugin/runtime/instance.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/record_file.h"

struct mjdiag_instance {
  const mjModel* model;
  mjData* data;
  std::unique_ptr<mjdiag::Instance> instance;
};

namespace {

thread_local std::string last_error;

// Nothing may be thrown into a C program.
template <typename Work>
bool Guard(const Work& work) noexcept {
  try {
    work();
    last_error.clear();
    return true;
  } catch (const std::exception& error) {
    last_error = error.what();
  } catch (...) {
    last_error = "unknown error";
  }
  return false;
}

const char* Text(const char* text) {
  if (text != nullptr) return text;
  throw mjdiag::InputError("mjdiag", "a null pointer", "a text");
}

}  // namespace

const char* mjdiag_version(void) { return MJDIAG_VERSION; }

const char* mjdiag_last_error(void) { return last_error.c_str(); }

int mjdiag_prepare(mjModel* model, const char* setup) {
  return Guard([&] {
    mjdiag::PreparePlant(mjdiag::ReadSetup(Text(setup)).physics, *model);
  })
             ? 0
             : 1;
}

int mjdiag_set_fault(mjModel* model, const char* parameter, double value) {
  return Guard([&] { mjdiag::ApplyFault(*model, {Text(parameter), value}); }) ? 0 : 1;
}

mjdiag_instance* mjdiag_attach(const mjModel* model, mjData* data, const char* setup,
                               const char* trajectory, uint64_t seed) {
  auto made = std::make_unique<mjdiag_instance>(mjdiag_instance{model, data, nullptr});
  const bool good = Guard([&] {
    mjdiag::Setup parts = mjdiag::ReadSetup(Text(setup));
    mjdiag::CheckTimeStep(parts, *model);
    const mjdiag::Machine machine(std::move(parts), *model);
    const mjdiag::Trajectories& known = machine.setup().trajectories;
    const mjdiag::Excitation excitation = mjdiag::FollowTrajectory(
        machine.setup(), known.Find(trajectory ? trajectory : known.fallback));
    mjdiag::RunOptions options;
    options.seed = seed;
    made->instance = std::make_unique<mjdiag::Instance>(machine, excitation, options);
    const Eigen::VectorXd& start = machine.rest();
    mj_resetData(model, data);
    std::copy(start.begin(), start.end(), data->qpos);
    mjdiag::Attach(*model, *data, *made->instance);
  });
  return good ? made.release() : nullptr;
}

int64_t mjdiag_ticks(const mjdiag_instance* instance) {
  return instance->instance->loop().ticks_done();
}

int mjdiag_write_record(const mjdiag_instance* instance, const char* file) {
  return Guard([&] {
    const std::filesystem::path path(file);
    mjdiag::WriteRecord(path, instance->instance->ToRecord(*instance->model),
                        path.extension() == ".mat" ? mjdiag::RecordFormat::kMat5
                                                   : mjdiag::RecordFormat::kCsv);
  })
             ? 0
             : 1;
}

void mjdiag_detach(mjdiag_instance* instance) {
  if (instance == nullptr) return;
  mjdiag::Detach(*instance->model, *instance->data);
  instance->instance->Release(*instance->data);
  delete instance;
}
