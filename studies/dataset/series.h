#pragma once
// Signals of runs, as a data set keeps them: a row of as many samples for every run,
// NaN behind the end of a shorter one, packed as a chunk of HDF5 with the filters shuffle
// (the first bytes of all samples, then the second ones, ..) and deflate (zlib). So they
// are compressed where the run was made, by all threads, and only copied into the file.

#include <Eigen/Core>
#include <string>

namespace mjdiag {

/// How quick, and how small: a signal with the noise of a sensor gets no smaller than its
/// digits, whatever the level.
inline constexpr int kDeflateLevel = 1;

struct Series {
  std::string group;  ///< of the data set: "records" or "residual"
  std::string name;
  std::string unit;  ///< SI
  Eigen::Index samples = 0;
  bool single = false;  ///< as 32-bit numbers

  std::size_t bytes() const {
    return static_cast<std::size_t>(samples) *
           (single ? sizeof(float) : sizeof(double));
  }
};

/// Whether this build can.
bool PacksSeries();

/// Every `every`th of the values, from the first on.
std::string Pack(const Series& series, const Eigen::VectorXd& values, int every);

}  // namespace mjdiag
