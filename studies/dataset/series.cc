#include "mjdiag/studies/dataset/series.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "mjdiag/signals/error.h"

#ifdef MJDIAG_HDF5
#include <zlib.h>
#endif

namespace mjdiag {
#ifdef MJDIAG_HDF5
namespace {

template <typename Number>
std::string Shuffled(const Series& series, const Eigen::VectorXd& values, int every) {
  const auto count = static_cast<std::size_t>(series.samples);
  std::vector<Number> row(count, std::numeric_limits<Number>::quiet_NaN());
  for (std::size_t i = 0; i < count; ++i) {
    const auto k = static_cast<Eigen::Index>(i) * every;
    if (k >= values.size()) break;
    row[i] = static_cast<Number>(values[k]);
  }
  const auto* bytes = reinterpret_cast<const char*>(row.data());
  std::string shuffled(count * sizeof(Number), '\0');
  for (std::size_t byte = 0; byte < sizeof(Number); ++byte) {
    char* to = shuffled.data() + byte * count;
    for (std::size_t i = 0; i < count; ++i) to[i] = bytes[i * sizeof(Number) + byte];
  }
  return shuffled;
}

}  // namespace

bool PacksSeries() { return true; }

std::string Pack(const Series& series, const Eigen::VectorXd& values, int every) {
  const std::string plain = series.single ? Shuffled<float>(series, values, every)
                                          : Shuffled<double>(series, values, every);
  uLongf size = compressBound(plain.size());
  std::string packed(size, '\0');
  const int failed = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                               reinterpret_cast<const Bytef*>(plain.data()),
                               plain.size(), kDeflateLevel);
  if (failed != Z_OK) {
    throw NumericalError("series '" + series.name + "': cannot be compressed");
  }
  packed.resize(size);
  return packed;
}
#else
bool PacksSeries() { return false; }

std::string Pack(const Series& series, const Eigen::VectorXd&, int) {
  throw InputError("series '" + series.name + "'", "mjdiag was built without HDF5",
                   "a build with libhdf5-dev");
}
#endif

}  // namespace mjdiag
