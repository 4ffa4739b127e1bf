#include "mjdiag/studies/dataset/hdf5_writer.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "mjdiag/signals/error.h"
#include "mjdiag/studies/dataset/dataset_file.h"
#include "mjdiag/studies/dataset/series.h"

#ifdef MJDIAG_HDF5
#include <hdf5.h>
#endif

namespace mjdiag {
#ifdef MJDIAG_HDF5
namespace {

constexpr hsize_t kChunkRows = 1024;

/// Something of HDF5 that is closed again.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {
    if (id < 0) throw std::runtime_error("HDF5");
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(Handle&& other) noexcept
      : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  operator hid_t() const { return id_; }  // NOLINT: it is its number

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void Check(herr_t status) {
  if (status < 0) throw std::runtime_error("HDF5");
}

/// HDF5 prints what goes wrong, unless somebody says that it shall not.
class ErrorOutputOff {
 public:
  ErrorOutputOff() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~ErrorOutputOff() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  ErrorOutputOff(const ErrorOutputOff&) = delete;
  ErrorOutputOff& operator=(const ErrorOutputOff&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

Handle Scalar() { return {H5Screate(H5S_SCALAR), H5Sclose}; }

Handle Space(const std::vector<hsize_t>& size) {
  return {H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr),
          H5Sclose};
}

Handle TextType(std::size_t length) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  Check(H5Tset_size(type, std::max<std::size_t>(length, 1)));
  Check(H5Tset_strpad(type, H5T_STR_NULLPAD));
  Check(H5Tset_cset(type, H5T_CSET_UTF8));
  return type;
}

Handle Creation(const std::vector<hsize_t>& chunk) {
  Handle list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  Check(H5Pset_obj_track_times(list, 0));
  if (!chunk.empty()) {
    Check(H5Pset_chunk(list, static_cast<int>(chunk.size()), chunk.data()));
    Check(H5Pset_shuffle(list));
    Check(H5Pset_deflate(list, kDeflateLevel));
  }
  return list;
}

}  // namespace

bool WritesDatasets() { return true; }

struct Hdf5Writer::State {
  ErrorOutputOff quiet;
  std::filesystem::path path;
  Handle file;
  Handle links;  // that make groups on the way
  std::vector<Handle> series;

  explicit State(const std::filesystem::path& where)
      : path(where),
        file(H5Fcreate(where.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
             H5Fclose),
        links(H5Pcreate(H5P_LINK_CREATE), H5Pclose) {
    Check(H5Pset_create_intermediate_group(links, 1));
  }

  template <typename Work>
  void Do(const Work& work) {
    try {
      work();
    } catch (const std::runtime_error&) {
      throw InputError(path.string(), "cannot be written", "a disk with room");
    }
  }

  void Note(hid_t object, const std::string& name, const std::string& value) const {
    const Handle type = TextType(value.size());
    const Handle attribute(
        H5Acreate2(object, name.c_str(), type, Scalar(), H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
    const std::string bytes = value.empty() ? std::string(1, '\0') : value;
    Check(H5Awrite(attribute, type, bytes.data()));
  }

  void NoteNames(hid_t object, const std::vector<std::string>& names) const {
    const auto [type, bytes] = Fixed(names);
    const Handle attribute(H5Acreate2(object, "columns", type, Space({names.size()}),
                                      H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose);
    Check(H5Awrite(attribute, type, bytes.data()));
  }

  void Note(hid_t object, const Hdf5Notes& notes) const {
    Note(object, "description", notes.description);
    if (!notes.unit.empty()) Note(object, "unit", notes.unit);
    if (!notes.columns.empty()) NoteNames(object, notes.columns);
  }

  /// Texts of one length.
  static std::pair<Handle, std::string> Fixed(const std::vector<std::string>& texts) {
    std::size_t length = 1;
    for (const std::string& text : texts) length = std::max(length, text.size());
    std::string bytes;
    bytes.reserve(texts.size() * length);
    for (const std::string& text : texts) {
      bytes += text;
      bytes.append(length - text.size(), '\0');
    }
    return {TextType(length), std::move(bytes)};
  }

  Handle Make(const std::string& name, hid_t type, const std::vector<hsize_t>& size,
              const std::vector<hsize_t>& chunk, const Hdf5Notes& notes) const {
    Handle set(H5Dcreate2(file, name.c_str(), type, Space(size), links, Creation(chunk),
                          H5P_DEFAULT),
               H5Dclose);
    Note(set, notes);
    return set;
  }

  void Write(const std::string& name, hid_t stored, hid_t type, const void* values,
             std::size_t rows, std::size_t columns, const Hdf5Notes& notes) {
    Do([&] {
      std::vector<hsize_t> size{rows};
      if (columns > 0) size.push_back(columns);
      std::vector<hsize_t> chunk = size;
      chunk.front() = std::min<hsize_t>(chunk.front(), kChunkRows);
      const Handle set = Make(name, stored, size, chunk, notes);
      Check(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
    });
  }
};

Hdf5Writer::Hdf5Writer(const std::filesystem::path& file) {
  try {
    state_ = std::make_unique<State>(file);
  } catch (const std::runtime_error&) {
    throw InputError(file.string(), "cannot be written", "a folder that can be");
  }
}

Hdf5Writer::~Hdf5Writer() = default;

void Hdf5Writer::Column(const std::string& path, const std::vector<double>& values,
                        const Hdf5Notes& notes) {
  state_->Write(path, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data(), values.size(),
                0, notes);
}

void Hdf5Writer::Column(const std::string& path,
                        const std::vector<std::int64_t>& values,
                        const Hdf5Notes& notes) {
  state_->Write(path, H5T_STD_I64LE, H5T_NATIVE_INT64, values.data(), values.size(), 0,
                notes);
}

void Hdf5Writer::Column(const std::string& path,
                        const std::vector<std::uint64_t>& values,
                        const Hdf5Notes& notes) {
  state_->Write(path, H5T_STD_U64LE, H5T_NATIVE_UINT64, values.data(), values.size(), 0,
                notes);
}

void Hdf5Writer::Column(const std::string& path,
                        const std::vector<std::uint8_t>& values,
                        const Hdf5Notes& notes) {
  state_->Write(path, H5T_STD_U8LE, H5T_NATIVE_UINT8, values.data(), values.size(), 0,
                notes);
}

void Hdf5Writer::Column(const std::string& path, const std::vector<std::string>& values,
                        const Hdf5Notes& notes) {
  state_->Do([&] {
    const auto [type, bytes] = State::Fixed(values);
    const std::vector<hsize_t> size{values.size()};
    const Handle set = state_->Make(
        path, type, size, {std::min<hsize_t>(values.size(), kChunkRows)}, notes);
    Check(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()));
  });
}

void Hdf5Writer::Matrix(const std::string& path, const std::vector<double>& values,
                        std::size_t columns, const Hdf5Notes& notes) {
  state_->Write(path, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data(),
                values.size() / columns, columns, notes);
}

void Hdf5Writer::Matrix(const std::string& path,
                        const std::vector<std::uint8_t>& values, std::size_t columns,
                        const Hdf5Notes& notes) {
  state_->Write(path, H5T_STD_U8LE, H5T_NATIVE_UINT8, values.data(),
                values.size() / columns, columns, notes);
}

void Hdf5Writer::Text(const std::string& path, const std::string& text,
                      const Hdf5Notes& notes) {
  state_->Do([&] {
    const Handle type = TextType(text.size());
    const Handle set(H5Dcreate2(state_->file, path.c_str(), type, Scalar(),
                                state_->links, Creation({}), H5P_DEFAULT),
                     H5Dclose);
    state_->Note(set, notes);
    const std::string bytes = text.empty() ? std::string(1, '\0') : text;
    Check(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()));
  });
}

std::size_t Hdf5Writer::BeginSeries(const std::string& path, std::size_t rows,
                                    std::size_t samples, bool single,
                                    const Hdf5Notes& notes) {
  state_->Do([&] {
    const hid_t type = single ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
    const Handle list = Creation({1, samples});
    const double none = std::numeric_limits<double>::quiet_NaN();
    Check(H5Pset_fill_value(list, H5T_NATIVE_DOUBLE, &none));
    // A row that is not there takes no room.
    Check(H5Pset_alloc_time(list, H5D_ALLOC_TIME_INCR));
    state_->series.emplace_back(
        H5Dcreate2(state_->file, path.c_str(), type, Space({rows, samples}),
                   state_->links, list, H5P_DEFAULT),
        H5Dclose);
    state_->Note(state_->series.back(), notes);
  });
  return state_->series.size() - 1;
}

void Hdf5Writer::SeriesRow(std::size_t series, std::size_t row,
                           const std::string& packed) {
  state_->Do([&] {
    const std::array<hsize_t, 2> offset{row, 0};
    Check(H5Dwrite_chunk(state_->series[series], H5P_DEFAULT, 0, offset.data(),
                         packed.size(), packed.data()));
  });
}

void Hdf5Writer::Attribute(const std::string& path, const std::string& name,
                           const std::string& value) {
  state_->Do([&] {
    const Handle object(H5Oopen(state_->file, path.c_str(), H5P_DEFAULT), H5Oclose);
    state_->Note(object, name, value);
  });
}

void Hdf5Writer::Attribute(const std::string& path, const std::string& name,
                           double value) {
  state_->Do([&] {
    const Handle object(H5Oopen(state_->file, path.c_str(), H5P_DEFAULT), H5Oclose);
    const Handle attribute(H5Acreate2(object, name.c_str(), H5T_IEEE_F64LE, Scalar(),
                                      H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose);
    Check(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value));
  });
}

void Hdf5Writer::Finish() {
  state_->Do([&] { Check(H5Fflush(state_->file, H5F_SCOPE_GLOBAL)); });
  state_.reset();
}
#else
bool WritesDatasets() { return false; }
#endif

}  // namespace mjdiag
