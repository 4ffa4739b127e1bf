#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "mjdiag/signals/column_name.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/mat_container.h"
#include "mjdiag/signals/mat_file.h"
#include "mjdiag/signals/mat_library.h"

namespace mjdiag {
namespace {

using Eigen::Index;

bool IsRealMatrix(const matvar_t& variable) {
  return variable.class_type >= MAT_C_DOUBLE && variable.class_type <= MAT_C_UINT64 &&
         !variable.isComplex && variable.rank == 2 &&
         std::min(variable.dims[0], variable.dims[1]) > 0;
}

bool IsRealVector(const matvar_t& variable) {
  return IsRealMatrix(variable) && std::min(variable.dims[0], variable.dims[1]) == 1;
}

/// Of a matrix, as it lies in memory: column by column.
struct MatColumns {
  std::size_t samples = 0;
  std::size_t columns = 0;
  bool across = false;  ///< the samples are along a row
};

/// The samples are along the longer dimension.
MatColumns ColumnsIn(const matvar_t& variable) {
  const std::size_t rows = variable.dims[0];
  const std::size_t columns = variable.dims[1];
  return rows < columns ? MatColumns{columns, rows, true}
                        : MatColumns{rows, columns, false};
}

std::string VariableText(const matvar_t& variable) {
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
  const MatVariablePtr variable(Mat_VarRead(file, std::string(name).c_str()));
  if (!variable || variable->class_type != MAT_C_STRUCT || !variable->data)
    return texts;
  const char* const* fields = Mat_VarGetStructFieldnames(variable.get());
  for (unsigned i = 0; i < Mat_VarGetNumberOfFields(variable.get()); ++i) {
    const matvar_t* field = Mat_VarGetStructFieldByIndex(variable.get(), i, 0);
    if (field) texts.emplace_back(fields[i], ToText(*field));
  }
  return texts;
}

Eigen::VectorXd ColumnOf(const Eigen::VectorXd& values, const MatColumns& matrix,
                         std::size_t column) {
  const auto samples = static_cast<Index>(matrix.samples);
  const auto i = static_cast<Index>(column);
  if (!matrix.across) return values.segment(i * samples, samples);
  Eigen::VectorXd one(samples);
  for (Index k = 0; k < samples; ++k) {
    one[k] = values[k * static_cast<Index>(matrix.columns) + i];
  }
  return one;
}

/// Where a column is.
struct MatPlace {
  std::string path;  ///< of the variable, through structs
  std::size_t column = 0;
  bool matrix = false;
};

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
    while (const MatVariablePtr info{Mat_VarReadNextInfo(file_.get())}) {
      if (!info->name || info->name == kMatUnits || info->name == kMatNames) continue;
      List(*info, info->name, 0);
    }
  }

  /// A variable, the columns of a matrix, or the fields of a struct, "log/q".
  void List(const matvar_t& variable, const std::string& path, int depth) {
    constexpr int kDeepest = 8;
    constexpr std::size_t kWidest = 256;  // pictures are none
    if (variable.class_type == MAT_C_STRUCT && depth < kDeepest && variable.rank == 2 &&
        variable.dims[0] * variable.dims[1] == 1) {
      auto* of =
          const_cast<matvar_t*>(&variable);  // NOLINT: matio reads, and says not so
      const char* const* fields = Mat_VarGetStructFieldnames(of);
      for (unsigned i = 0; i < Mat_VarGetNumberOfFields(of); ++i) {
        const matvar_t* field = Mat_VarGetStructFieldByIndex(of, i, 0);
        if (field) List(*field, path + "/" + fields[i], depth + 1);
      }
      return;
    }
    if (!IsRealMatrix(variable) || IsRealVector(variable)) {
      const std::size_t samples =
          IsRealMatrix(variable) ? ColumnsIn(variable).samples : 0;
      columns_.push_back({path, path, std::nullopt, static_cast<Index>(samples)});
      places_.push_back({path, 0, false});
      return;
    }
    const MatColumns matrix = ColumnsIn(variable);
    if (matrix.columns > kWidest) return;
    for (std::size_t i = 0; i < matrix.columns; ++i) {
      columns_.push_back(MatrixColumn(path, i));
      columns_.back().samples = static_cast<Index>(matrix.samples);
      places_.push_back({path, i, true});
    }
  }

  /// The fields of `units` also give the order: version 7.3 sorts its variables.
  void ApplyUnits() {
    std::size_t position = 0;
    for (const auto& [name, unit] : ReadTexts(file_.get(), kMatUnits)) {
      const std::string& field = name;  // Clang 14 captures no structured bindings
      const auto from = columns_.begin() + static_cast<std::ptrdiff_t>(position);
      const auto column =
          std::find_if(from, columns_.end(),
                       [&](const SourceColumn& c) { return c.header == field; });
      const auto place = places_.begin() + (column - columns_.begin());
      if (column == columns_.end()) {
        throw InputError(path_, "no variable \"" + field + "\" that `units` names",
                         "a complete file");
      }
      column->unit = unit;
      std::rotate(from, column, column + 1);
      std::rotate(places_.begin() + static_cast<std::ptrdiff_t>(position), place,
                  place + 1);
      ++position;
    }
  }

  void ApplyNames() {
    for (const auto& [field, name] : ReadTexts(file_.get(), kMatNames)) {
      for (SourceColumn& column : columns_) {
        if (column.header == field) column.name = name;
      }
    }
  }

  /// A variable, or a field of one, with its data; null if it cannot be read.
  const matvar_t* Fetch(const std::string& path) {
    const std::size_t end = path.find('/');
    const std::string name = path.substr(0, end);
    if (!variable_ || variable_->name != name) {
      variable_.reset(Mat_VarRead(file_.get(), name.c_str()));
    }
    const matvar_t* found = variable_.get();
    for (std::size_t at = end; found && at != std::string::npos;) {
      const std::size_t next = path.find('/', at + 1);
      found = Mat_VarGetStructFieldByName(
          const_cast<matvar_t*>(found),  // NOLINT: matio reads, and says not so
          path.substr(at + 1, next - at - 1).c_str(), 0);
      at = next;
    }
    return found;
  }

  Eigen::VectorXd ReadVector(std::size_t column, MissingCells missing) {
    const MatPlace& place = places_[column];
    const matvar_t* variable = Fetch(place.path);
    if (!variable) throw InputError(Variable(column), "cannot be read", "a vector");
    if (!IsRealMatrix(*variable) || (!place.matrix && !IsRealVector(*variable))) {
      throw InputError(Variable(column), VariableText(*variable), "a real vector");
    }
    if (!variable->data) throw InputError(Variable(column), "has no data", "a vector");
    Eigen::VectorXd values = ToVector(*variable);
    if (place.matrix) values = ColumnOf(values, ColumnsIn(*variable), place.column);
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
  MatFilePtr file_;
  MatVariablePtr variable_;  ///< that was read last
  std::vector<SourceColumn> columns_;
  std::vector<MatPlace> places_;
};

}  // namespace

std::unique_ptr<RecordSource> OpenMat(const std::filesystem::path& file) {
  const auto version = DetectMatVersion(file);
  if (!version) throw InputError(file.string(), "not a MAT file", "version 5 or 7.3");
  RequireCompleteMat(file, *version);
  return std::make_unique<MatSource>(file);
}

}  // namespace mjdiag
