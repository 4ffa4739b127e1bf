#include "mjdiag/studies/dataset/plan_identity.h"

#include <boost/crc.hpp>
#include <filesystem>

#include "mjdiag/signals/text_file.h"

namespace mjdiag {

std::string PlanIdentity(const LoadedPlan& loaded) {
  const Setup& setup = loaded.machine.setup();
  std::string identity = MJDIAG_VERSION;
  for (const std::string& part :
       {loaded.plan.text, ReadTextFile(FindSetupFile(loaded.plan.setup)),
        ReadTextFile(setup.plant)}) {
    identity += "\n--- " + std::to_string(part.size()) + "\n" + part;
  }
  for (const PlanMotion& motion : loaded.plan.motions) {
    if (!motion.record.empty()) identity += "\n---\n" + ReadTextFile(motion.record);
  }
  if (setup.calibration) {
    for (const char* file : {"calibration.json", kCalibratedFilters}) {
      const std::filesystem::path path = setup.folder / file;
      if (std::filesystem::is_regular_file(path))
        identity += "\n---\n" + ReadTextFile(path);
    }
  }
  return identity;
}

std::uint64_t ChecksumOf(const std::string& identity) {
  boost::crc_32_type crc;
  crc.process_bytes(identity.data(), identity.size());
  return crc.checksum();
}

}  // namespace mjdiag
