#pragma once
// What ReadRecord needs to know about a file format: its columns, and their numbers.

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mjdiag {

/// One column of a file.
struct SourceColumn {
  std::string header;               ///< as it stands in the file
  std::string name;                 ///< without the unit
  std::optional<std::string> unit;  ///< as it stands in the file, if it does
  /// Where the file says it before it is read; else the samples of all columns are as many.
  std::optional<Eigen::Index> samples = std::nullopt;
};

/// What becomes of cells that are empty or not finite.
enum class MissingCells {
  kRefused,
  kNan,  ///< and of a last row that was not written to its end nothing at all
};

class RecordSource {
 public:
  virtual ~RecordSource() = default;
  virtual const std::vector<SourceColumn>& columns() const = 0;
  /// The numbers of the chosen columns, in that order, all of one length. InputError
  /// with the place of a cell that is no number, or of another length.
  virtual std::vector<Eigen::VectorXd> Read(std::span<const std::size_t> chosen,
                                            MissingCells missing) = 0;
  /// Where a sample of the last Read stands, for messages: file, line, column.
  virtual std::string Place(std::size_t column, Eigen::Index sample) const = 0;
};

}  // namespace mjdiag
