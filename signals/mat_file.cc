#include "mjdiag/signals/mat_file.h"

#include <fcntl.h>
#include <matio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/file_replacement.h"
#include "mjdiag/signals/mat_container.h"

namespace mjdiag {
namespace {

using Eigen::Index;

constexpr std::string_view kTimeVariable = "time";
constexpr std::string_view kUnits = "units";
constexpr std::string_view kNames = "names";
/// MATLAB's namelengthmax.
constexpr std::size_t kLongestName = 63;

struct FileDeleter {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct VariableDeleter {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using FilePtr = std::unique_ptr<mat_t, FileDeleter>;
using VariablePtr = std::unique_ptr<matvar_t, VariableDeleter>;

// ---- reading

bool IsRealVector(const matvar_t& variable) {
  return variable.class_type >= MAT_C_DOUBLE && variable.class_type <= MAT_C_UINT64 &&
         !variable.isComplex && variable.rank == 2 &&
         std::min(variable.dims[0], variable.dims[1]) == 1;
}

std::string Describe(const matvar_t& variable) {
  switch (variable.class_type) {
    case MAT_C_CELL:
      return "a cell array";
    case MAT_C_STRUCT:
      return "a struct";
    case MAT_C_CHAR:
      return "text";
    case MAT_C_SPARSE:
      return "a sparse matrix";
    default:
      break;
  }
  std::string text = variable.isComplex ? "a complex array of " : "an array of ";
  for (int i = 0; i < variable.rank; ++i) {
    text += (i > 0 ? " x " : "") + std::to_string(variable.dims[i]);
  }
  return text;
}

template <typename Number>
Eigen::VectorXd ToDoubles(const void* data, Index count) {
  using Vector = Eigen::Matrix<Number, Eigen::Dynamic, 1>;
  return Eigen::Map<const Vector>(static_cast<const Number*>(data), count)
      .template cast<double>();
}

Eigen::VectorXd ToVector(const matvar_t& variable) {
  const auto count = static_cast<Index>(variable.dims[0] * variable.dims[1]);
  switch (variable.data_type) {
    case MAT_T_DOUBLE:
      return ToDoubles<double>(variable.data, count);
    case MAT_T_SINGLE:
      return ToDoubles<float>(variable.data, count);
    case MAT_T_INT8:
      return ToDoubles<std::int8_t>(variable.data, count);
    case MAT_T_UINT8:
      return ToDoubles<std::uint8_t>(variable.data, count);
    case MAT_T_INT16:
      return ToDoubles<std::int16_t>(variable.data, count);
    case MAT_T_UINT16:
      return ToDoubles<std::uint16_t>(variable.data, count);
    case MAT_T_INT32:
      return ToDoubles<std::int32_t>(variable.data, count);
    case MAT_T_UINT32:
      return ToDoubles<std::uint32_t>(variable.data, count);
    case MAT_T_INT64:
      return ToDoubles<std::int64_t>(variable.data, count);
    case MAT_T_UINT64:
      return ToDoubles<std::uint64_t>(variable.data, count);
    default:
      return {};
  }
}

void AppendUtf8(std::string& text, unsigned character) {
  if (character < 0x80U) {
    text += static_cast<char>(character);
  } else if (character < 0x800U) {
    text += static_cast<char>(0xC0U | character >> 6);
    text += static_cast<char>(0x80U | (character & 0x3FU));
  } else {
    text += static_cast<char>(0xE0U | character >> 12);
    text += static_cast<char>(0x80U | (character >> 6 & 0x3FU));
    text += static_cast<char>(0x80U | (character & 0x3FU));
  }
}

std::string ToText(const matvar_t& variable) {
  std::string text;
  if (variable.class_type != MAT_C_CHAR || !variable.data) return text;
  const std::size_t characters = variable.nbytes / sizeof(std::uint16_t);
  if (variable.data_type == MAT_T_UINT16 || variable.data_type == MAT_T_UTF16) {
    const auto* data = static_cast<const std::uint16_t*>(variable.data);
    for (std::size_t i = 0; i < characters; ++i) AppendUtf8(text, data[i]);
  } else {
    text.assign(static_cast<const char*>(variable.data), variable.nbytes);
  }
  // Arrays of characters may be filled up with zeros.
  return text.substr(0, text.find('\0'));
}

/// Field -> text of a scalar struct, in the order of the fields.
std::vector<std::pair<std::string, std::string>> ReadTexts(mat_t* file,
                                                           std::string_view name) {
  std::vector<std::pair<std::string, std::string>> texts;
  const VariablePtr variable(Mat_VarRead(file, std::string(name).c_str()));
  if (!variable || variable->class_type != MAT_C_STRUCT || !variable->data)
    return texts;
  const char* const* fields = Mat_VarGetStructFieldnames(variable.get());
  for (unsigned i = 0; i < Mat_VarGetNumberOfFields(variable.get()); ++i) {
    const matvar_t* field = Mat_VarGetStructFieldByIndex(variable.get(), i, 0);
    if (field) texts.emplace_back(fields[i], ToText(*field));
  }
  return texts;
}

class MatSource : public RecordSource {
 public:
  explicit MatSource(const std::filesystem::path& path)
      : path_(path.string()), file_(Mat_Open(path_.c_str(), MAT_ACC_RDONLY)) {
    if (!file_) throw InputError(path_, "cannot be read", "a MAT file");
    ListVariables();
    ApplyUnits();
    ApplyNames();
    if (columns_.empty()) throw InputError(path_, "has no variables", "real vectors");
  }

  const std::vector<SourceColumn>& columns() const override { return columns_; }

  std::vector<Eigen::VectorXd> Read(std::span<const std::size_t> chosen,
                                    MissingCells missing) override {
    std::vector<Eigen::VectorXd> values;
    for (const std::size_t column : chosen) {
      values.push_back(ReadVector(column, missing));
      if (values.back().size() == values.front().size()) continue;
      throw InputError(Variable(column),
                       std::to_string(values.back().size()) + " samples",
                       std::to_string(values.front().size()) + " as variable \"" +
                           columns_[chosen.front()].header + "\" has");
    }
    return values;
  }

  std::string Place(std::size_t column, Index sample) const override {
    return Variable(column) + ", element " + std::to_string(sample + 1);
  }

 private:
  std::string Variable(std::size_t column) const {
    return path_ + ": variable \"" + columns_[column].header + "\"";
  }

  void ListVariables() {
    Mat_Rewind(file_.get());
    while (const VariablePtr info{Mat_VarReadNextInfo(file_.get())}) {
      if (!info->name || info->name == kUnits || info->name == kNames) continue;
      columns_.push_back({info->name, info->name, std::nullopt});
    }
  }

  /// The fields of `units` also give the order: version 7.3 sorts its variables.
  void ApplyUnits() {
    std::size_t position = 0;
    for (const auto& [name, unit] : ReadTexts(file_.get(), kUnits)) {
      const std::string& field = name;  // Clang 14 captures no structured bindings
      const auto from = columns_.begin() + static_cast<std::ptrdiff_t>(position);
      const auto column =
          std::find_if(from, columns_.end(),
                       [&](const SourceColumn& c) { return c.header == field; });
      if (column == columns_.end()) {
        throw InputError(path_, "no variable \"" + field + "\" that `units` names",
                         "a complete file");
      }
      column->unit = unit;
      std::rotate(from, column, column + 1);
      ++position;
    }
  }

  void ApplyNames() {
    for (const auto& [field, name] : ReadTexts(file_.get(), kNames)) {
      for (SourceColumn& column : columns_) {
        if (column.header == field) column.name = name;
      }
    }
  }

  Eigen::VectorXd ReadVector(std::size_t column, MissingCells missing) const {
    const VariablePtr variable(
        Mat_VarRead(file_.get(), columns_[column].header.c_str()));
    if (!variable) throw InputError(Variable(column), "cannot be read", "a vector");
    if (!IsRealVector(*variable)) {
      throw InputError(Variable(column), Describe(*variable), "a real vector");
    }
    if (!variable->data) throw InputError(Variable(column), "has no data", "a vector");
    Eigen::VectorXd values = ToVector(*variable);
    for (Index k = 0; k < values.size(); ++k) {
      if (std::isfinite(values[k])) continue;
      if (missing == MissingCells::kRefused) {
        throw InputError(Place(column, k), std::isnan(values[k]) ? "NaN" : "infinite",
                         "a finite number");
      }
      values[k] = std::numeric_limits<double>::quiet_NaN();
    }
    return values;
  }

  std::string path_;
  FilePtr file_;
  std::vector<SourceColumn> columns_;
};

// ---- writing

/// The name with what MATLAB does not allow replaced, and not one of `taken`.
std::string VariableName(const std::string& channel,
                         const std::vector<std::string>& taken) {
  std::string base = channel.substr(0, kLongestName);
  for (char& c : base) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_') c = '_';
  }
  if (base.empty() || !std::isalpha(static_cast<unsigned char>(base.front()))) {
    base = ("x" + base).substr(0, kLongestName);
  }
  std::string name = base;
  for (int i = 2; std::find(taken.begin(), taken.end(), name) != taken.end(); ++i) {
    const std::string suffix = "_" + std::to_string(i);
    name = base.substr(0, kLongestName - suffix.size()) + suffix;
  }
  return name;
}

/// Variable names: of the time, then of every channel.
std::vector<std::string> VariableNames(const Record& record) {
  std::vector<std::string> taken{std::string(kUnits), std::string(kNames),
                                 std::string(kTimeVariable)};
  for (const Channel& channel : record.channels()) {
    taken.push_back(VariableName(channel.name, taken));
  }
  return {taken.begin() + 2, taken.end()};
}

VariablePtr MakeText(std::string text) {
  std::array<std::size_t, 2> dims{1, text.size()};
  return VariablePtr(
      Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UTF8, 2, dims.data(), text.data(), 0));
}

VariablePtr MakeStruct(std::string_view name, const std::vector<std::string>& fields,
                       const std::vector<std::string>& texts) {
  std::vector<const char*> names;
  names.reserve(fields.size());
  for (const std::string& field : fields) names.push_back(field.c_str());
  std::array<std::size_t, 2> dims{1, 1};
  VariablePtr variable(Mat_VarCreateStruct(std::string(name).c_str(), 2, dims.data(),
                                           names.data(),
                                           static_cast<unsigned>(names.size())));
  for (std::size_t i = 0; i < fields.size(); ++i) {
    Mat_VarSetStructFieldByName(variable.get(), names[i], 0,
                                MakeText(texts[i]).release());
  }
  return variable;
}

VariablePtr MakeVector(const std::string& name, Eigen::VectorXd values) {
  std::array<std::size_t, 2> dims{static_cast<std::size_t>(values.size()), 1};
  return VariablePtr(Mat_VarCreate(name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2,
                                   dims.data(), values.data(), 0));
}

bool WriteVariables(mat_t* file, const Record& record) {
  const std::vector<std::string> variables = VariableNames(record);
  std::vector<std::string> units{"s"};
  std::vector<std::string> names{std::string(kTimeVariable)};
  for (const Channel& channel : record.channels()) {
    units.push_back(channel.unit);
    names.push_back(channel.name);
  }
  const auto write = [file](const VariablePtr& variable) {
    return variable && Mat_VarWrite(file, variable.get(), MAT_COMPRESSION_NONE) == 0;
  };
  // `units` first: it announces the variables, so that a missing one is noticed.
  bool good = write(MakeStruct(kUnits, variables, units)) &&
              write(MakeStruct(kNames, variables, names)) &&
              write(MakeVector(variables.front(), record.Time()));
  for (std::size_t i = 0; good && i < record.channels().size(); ++i) {
    good = write(MakeVector(variables[i + 1], record.channels()[i].samples));
  }
  return good;
}

/// HDF5 crashes where matio closes a file that the disk had no room for. What is asked
/// for here is given back when matio makes the file anew, and is there for it.
void RequireRoom(const std::filesystem::path& file, const std::string& temporary,
                 const Record& record) {
  constexpr off_t kHeads = 1 << 17;      // of the file, units and names
  constexpr off_t kOfChannel = 1 << 14;  // besides its samples
  const auto channels = static_cast<off_t>(record.channels().size()) + 1;
  const off_t bytes =
      kHeads + channels * (kOfChannel + static_cast<off_t>(sizeof(double)) *
                                            static_cast<off_t>(record.samples()));
  const int descriptor = open(temporary.c_str(), O_WRONLY | O_CLOEXEC);
  const int error = descriptor < 0 ? errno : posix_fallocate(descriptor, 0, bytes);
  if (descriptor >= 0) close(descriptor);
  if (error == 0) return;
  throw InputError(file.string(),
                   std::string("cannot be written (") + std::strerror(error) + ")",
                   "space for " + std::to_string(bytes) + " bytes");
}

}  // namespace

std::unique_ptr<RecordSource> OpenMat(const std::filesystem::path& file) {
  const auto version = DetectMatVersion(file);
  if (!version) throw InputError(file.string(), "not a MAT file", "version 5 or 7.3");
  RequireCompleteMat(file, *version);
  return std::make_unique<MatSource>(file);
}

void WriteMat(const std::filesystem::path& file, const Record& record,
              RecordFormat format) {
  FileReplacement replacement(file);
  const std::string temporary = replacement.temporary().string();
  const bool version5 = format == RecordFormat::kMat5;
  if (!version5) RequireRoom(file, temporary, record);
  FilePtr mat(
      Mat_CreateVer(temporary.c_str(), nullptr, version5 ? MAT_FT_MAT5 : MAT_FT_MAT73));
  bool good = mat && WriteVariables(mat.get(), record);
  good = Mat_Close(mat.release()) == 0 && good;
  if (!good) {
    throw InputError(file.string(), "cannot be written as MAT", "a writable file");
  }
  // matio does not report a full disk.
  RequireCompleteMat(temporary, version5 ? MatVersion::k5 : MatVersion::k73);
  replacement.Commit();
}

}  // namespace mjdiag
