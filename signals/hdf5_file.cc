#include "mjdiag/signals/hdf5_file.h"

#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mjdiag/signals/column_name.h"
#include "mjdiag/signals/error.h"

#ifdef MJDIAG_HDF5
#include <hdf5.h>
#endif

namespace mjdiag {
namespace {

#ifdef MJDIAG_HDF5

using Eigen::Index;

constexpr const char* kExpectedHdf5 = "datasets of numbers, one value a sample";

/// Something of HDF5 that is closed again; negative where HDF5 said no.
class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }
  Hdf5Handle(Hdf5Handle&& other) noexcept
      : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Hdf5Handle& operator=(Hdf5Handle&&) = delete;
  operator hid_t() const { return id_; }  // NOLINT: it is its number
  bool good() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// HDF5 prints what goes wrong, unless somebody says that it shall not.
class QuietHdf5 {
 public:
  QuietHdf5() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~QuietHdf5() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  QuietHdf5(const QuietHdf5&) = delete;
  QuietHdf5& operator=(const QuietHdf5&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// Where the numbers of a column are in a dataset.
struct Hdf5Column {
  std::string dataset;
  hsize_t samples = 0;
  hsize_t columns = 1;  ///< of the dataset
  hsize_t column = 0;
  int along = 0;  ///< dimension of the samples
};

/// The text attribute of an object, or nothing.
std::optional<std::string> TextAttribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return std::nullopt;
  const Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Hdf5Handle type(H5Aget_type(attribute), H5Tclose);
  const Hdf5Handle space(H5Aget_space(attribute), H5Sclose);
  if (!type.good() || H5Tget_class(type) != H5T_STRING ||
      H5Sget_simple_extent_npoints(space) != 1) {
    return std::nullopt;
  }
  const Hdf5Handle memory(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_cset(memory, H5Tget_cset(type));
  if (H5Tis_variable_str(type) > 0) {
    H5Tset_size(memory, H5T_VARIABLE);
    char* text = nullptr;
    if (H5Aread(attribute, memory, static_cast<void*>(&text)) < 0 || text == nullptr) {
      return std::nullopt;
    }
    const std::string copy(text);
    H5free_memory(text);
    return copy;
  }
  constexpr std::size_t kLongestUnit = 256;
  const std::size_t size = H5Tget_size(type);
  if (size == 0 || size > kLongestUnit) return std::nullopt;
  H5Tset_size(memory, size + 1);
  std::string text(size + 1, '\0');
  if (H5Aread(attribute, memory, text.data()) < 0) return std::nullopt;
  return std::string(text.c_str());
}

class Hdf5Source : public RecordSource {
 public:
  explicit Hdf5Source(const std::filesystem::path& path)
      : path_(path.string()),
        file_(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose) {
    if (!file_.good()) {
      throw InputError(path_, "cannot be read: cut off, damaged or still open",
                       "a complete HDF5 file");
    }
    List(file_, "", 0);
    if (columns_.empty()) throw InputError(path_, "has no numbers", kExpectedHdf5);
  }

  const std::vector<SourceColumn>& columns() const override { return columns_; }

  std::vector<Eigen::VectorXd> Read(std::span<const std::size_t> chosen,
                                    MissingCells missing) override {
    const QuietHdf5 quiet;
    std::vector<Eigen::VectorXd> values;
    for (const std::size_t column : chosen) {
      const Hdf5Column& place = places_[column];
      if (place.samples != places_[chosen.front()].samples) {
        throw InputError(Where(column), std::to_string(place.samples) + " samples",
                         std::to_string(places_[chosen.front()].samples) + " as \"" +
                             columns_[chosen.front()].name + "\" has");
      }
      values.push_back(ReadColumn(column));
      for (Index k = 0; k < values.back().size(); ++k) {
        double& value = values.back()[k];
        if (std::isfinite(value)) continue;
        if (missing == MissingCells::kRefused) {
          throw InputError(Place(column, k), std::isnan(value) ? "NaN" : "infinite",
                           "a finite number");
        }
        value = std::numeric_limits<double>::quiet_NaN();
      }
    }
    return values;
  }

  std::string Place(std::size_t column, Index sample) const override {
    return Where(column) + ", sample " + std::to_string(sample);
  }

 private:
  std::string Where(std::size_t column) const {
    return path_ + ": \"" + columns_[column].name + "\"";
  }

  void List(hid_t group, const std::string& path, int depth) {
    constexpr int kDeepest = 8;  // a group may link to one that it is in
    constexpr int kMostObjects = 10'000;
    H5G_info_t info{};
    if (depth > kDeepest || H5Gget_info(group, &info) < 0) return;
    // In the order in which they were made, where the file knows it.
    const Hdf5Handle how(H5Gget_create_plist(group), H5Pclose);
    unsigned order = 0;
    const bool ordered = how.good() && H5Pget_link_creation_order(how, &order) >= 0 &&
                         (order & H5P_CRT_ORDER_INDEXED) != 0;
    for (hsize_t i = 0; i < info.nlinks && objects_ < kMostObjects; ++i, ++objects_) {
      std::array<char, 1024> name{};
      if (H5Lget_name_by_idx(group, ".", ordered ? H5_INDEX_CRT_ORDER : H5_INDEX_NAME,
                             H5_ITER_INC, i, name.data(), name.size(),
                             H5P_DEFAULT) <= 0) {
        continue;
      }
      const std::string_view called = name.data();
      if (called.starts_with('#')) continue;  // MATLAB's own
      const Hdf5Handle object(H5Oopen(group, name.data(), H5P_DEFAULT), H5Oclose);
      if (!object.good()) continue;
      std::string inner = path;
      inner.append(path.empty() ? "" : "/").append(called);
      const H5I_type_t kind = H5Iget_type(object);
      if (kind == H5I_GROUP) List(object, inner, depth + 1);
      if (kind == H5I_DATASET) Add(object, inner);
    }
  }

  void Add(hid_t dataset, const std::string& path) {
    constexpr hsize_t kMostColumns = 256;  // pictures are none
    constexpr hsize_t kMostSamples = 1U << 28;
    const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
    const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
    const H5T_class_t kind = H5Tget_class(type);
    if (kind != H5T_INTEGER && kind != H5T_FLOAT) return;
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 1 || rank > 2) return;
    std::array<hsize_t, 2> size{0, 1};
    H5Sget_simple_extent_dims(space, size.data(), nullptr);
    Hdf5Column place{path, size[0], size[1]};
    if (place.columns > place.samples) {
      std::swap(place.columns, place.samples);
      place.along = 1;
    }
    if (place.samples < 2 || place.samples > kMostSamples ||
        place.columns > kMostColumns) {
      return;
    }
    std::optional<std::string> unit = TextAttribute(dataset, "unit");
    if (!unit) unit = TextAttribute(dataset, "units");
    for (; place.column < place.columns; ++place.column) {
      columns_.push_back(place.columns > 1 ? MatrixColumn(path, place.column)
                                           : ParseColumnHeader(path));
      if (unit && !unit->empty()) columns_.back().unit = unit;
      columns_.back().samples = static_cast<Index>(place.samples);
      places_.push_back(place);
    }
  }

  Eigen::VectorXd ReadColumn(std::size_t column) const {
    const Hdf5Column& place = places_[column];
    const Hdf5Handle dataset(H5Dopen2(file_, place.dataset.c_str(), H5P_DEFAULT),
                             H5Dclose);
    const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
    Eigen::VectorXd values(static_cast<Index>(place.samples));
    const Hdf5Handle memory(H5Screate_simple(1, &place.samples, nullptr), H5Sclose);
    std::array<hsize_t, 2> start{0, 0};
    std::array<hsize_t, 2> count{1, 1};
    start[static_cast<std::size_t>(1 - place.along)] = place.column;
    count[static_cast<std::size_t>(place.along)] = place.samples;
    if (H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(),
                            nullptr) < 0 ||
        H5Dread(dataset, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values.data()) <
            0) {
      throw InputError(Where(column), "cannot be read", "a complete HDF5 file");
    }
    return values;
  }

  std::string path_;
  QuietHdf5 quiet_;
  Hdf5Handle file_;
  int objects_ = 0;
  std::vector<SourceColumn> columns_;
  std::vector<Hdf5Column> places_;
};

#endif

}  // namespace

bool IsHdf5(const std::filesystem::path& file) {
  constexpr std::string_view kResidualDependence = "\x89HDF\r\n\x1a\n";
  std::ifstream stream(file, std::ios::binary);
  std::string head(kResidualDependence.size(), '\0');
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  return stream && head == kResidualDependence;
}

std::unique_ptr<RecordSource> OpenHdf5(const std::filesystem::path& file) {
#ifdef MJDIAG_HDF5
  return std::make_unique<Hdf5Source>(file);
#else
  throw InputError(file.string(), "is HDF5, and this mjdiag was built without it",
                   "CSV, JSON or MAT version 5, or a build with libhdf5-dev");
#endif
}

}  // namespace mjdiag
