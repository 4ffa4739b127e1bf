// Records as MATLAB files. A file is read by matio, and by HDF5 behind it, which are not
// ours.

#include "fuzz/target.h"
#include "mjdiag/signals/record_file.h"

namespace mjdiag::fuzz {

void FuzzMat(Input input) {
  const auto file = WriteFile("record.mat", TextOf(input));
  Done([&] { ReadRecord(file); });
}

}  // namespace mjdiag::fuzz
