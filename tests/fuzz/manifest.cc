// Lists of records, each with changes of the setup of stage/.

#include "fuzz/target.h"
#include "mjdiag/plugin/setup/record_manifest.h"
#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag::fuzz {

void FuzzManifest(Input input) {
  const auto file = WriteFile("records.toml", TextOf(input));
  Done([&] {
    for (const ManifestRecord& record : ReadRecordManifest(file, Folder())) {
      ReadSetup(Folder(), record.overrides);
    }
  });
}

}  // namespace mjdiag::fuzz
