#pragma once
// The data set of a study: one HDF5 file, whose bytes are the same whoever made the runs,
// in whatever order. docs/datasets.md describes what is in it.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "mjdiag/studies/dataset/run_result.h"
#include "mjdiag/studies/dataset/run_work.h"

namespace mjdiag {

/// Where the results of all runs are.
struct DatasetSource {
  std::function<const RunResult&(std::int64_t index)> result;
  std::function<std::vector<std::string>(std::int64_t index)> series;
};

/// Whether this build has HDF5.
bool WritesDatasets();

/// InputError if the file cannot be written.
void WriteDataset(const std::filesystem::path& file, const RunWork& work,
                  const DatasetSource& source);

}  // namespace mjdiag
