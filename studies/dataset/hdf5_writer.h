#pragma once
// Of HDF5 what a data set needs: groups, columns, matrices, texts and attributes. Chunks
// are compressed, and nothing is written that depends on when it was.

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace mjdiag {

/// What attributes say of a data set.
struct Hdf5Notes {
  std::string description;
  std::string unit{};                  ///< SI; empty: none
  std::vector<std::string> columns{};  ///< of a matrix
};

class Hdf5Writer {
 public:
  /// InputError if the file cannot be made.
  explicit Hdf5Writer(const std::filesystem::path& file);
  ~Hdf5Writer();

  /// "a/b": groups on the way are made. All of these throw InputError if the disk is full.
  void Column(const std::string& path, const std::vector<double>& values,
              const Hdf5Notes& notes);
  void Column(const std::string& path, const std::vector<std::int64_t>& values,
              const Hdf5Notes& notes);
  void Column(const std::string& path, const std::vector<std::uint64_t>& values,
              const Hdf5Notes& notes);
  void Column(const std::string& path, const std::vector<std::uint8_t>& values,
              const Hdf5Notes& notes);
  void Column(const std::string& path, const std::vector<std::string>& values,
              const Hdf5Notes& notes);
  /// @param columns  rows x columns, row by row
  void Matrix(const std::string& path, const std::vector<double>& values,
              std::size_t columns, const Hdf5Notes& notes);
  void Matrix(const std::string& path, const std::vector<std::uint8_t>& values,
              std::size_t columns, const Hdf5Notes& notes);
  void Text(const std::string& path, const std::string& text, const Hdf5Notes& notes);

  /// Rows of numbers that come packed (series.h), NaN where none comes.
  /// @return the number by which SeriesRow knows it
  std::size_t BeginSeries(const std::string& path, std::size_t rows,
                          std::size_t samples, bool single, const Hdf5Notes& notes);
  void SeriesRow(std::size_t series, std::size_t row, const std::string& packed);

  /// Of the file, a group or a data set that is there.
  void Attribute(const std::string& path, const std::string& name,
                 const std::string& value);
  void Attribute(const std::string& path, const std::string& name, double value);

  /// Closes the file, complete.
  void Finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mjdiag
