#include "mjdiag/signals/mat_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <vector>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/file_replacement.h"
#include "mjdiag/signals/mat_container.h"
#include "mjdiag/signals/mat_library.h"

namespace mjdiag {
namespace {

/// MATLAB's namelengthmax.
constexpr std::size_t kLongestName = 63;

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
  std::vector<std::string> taken{std::string(kMatUnits), std::string(kMatNames),
                                 std::string(kMatTime)};
  for (const Channel& channel : record.channels()) {
    taken.push_back(VariableName(channel.name, taken));
  }
  return {taken.begin() + 2, taken.end()};
}

MatVariablePtr MakeText(std::string text) {
  std::array<std::size_t, 2> dims{1, text.size()};
  return MatVariablePtr(
      Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UTF8, 2, dims.data(), text.data(), 0));
}

MatVariablePtr MakeStruct(std::string_view name, const std::vector<std::string>& fields,
                          const std::vector<std::string>& texts) {
  std::vector<const char*> names;
  names.reserve(fields.size());
  for (const std::string& field : fields) names.push_back(field.c_str());
  std::array<std::size_t, 2> dims{1, 1};
  MatVariablePtr variable(Mat_VarCreateStruct(std::string(name).c_str(), 2, dims.data(),
                                              names.data(),
                                              static_cast<unsigned>(names.size())));
  for (std::size_t i = 0; i < fields.size(); ++i) {
    Mat_VarSetStructFieldByName(variable.get(), names[i], 0,
                                MakeText(texts[i]).release());
  }
  return variable;
}

MatVariablePtr MakeVector(const std::string& name, Eigen::VectorXd values) {
  std::array<std::size_t, 2> dims{static_cast<std::size_t>(values.size()), 1};
  return MatVariablePtr(Mat_VarCreate(name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2,
                                      dims.data(), values.data(), 0));
}

bool WriteVariables(mat_t* file, const Record& record) {
  const std::vector<std::string> variables = VariableNames(record);
  std::vector<std::string> units{"s"};
  std::vector<std::string> names{std::string(kMatTime)};
  for (const Channel& channel : record.channels()) {
    units.push_back(channel.unit);
    names.push_back(channel.name);
  }
  const auto write = [file](const MatVariablePtr& variable) {
    return variable && Mat_VarWrite(file, variable.get(), MAT_COMPRESSION_NONE) == 0;
  };
  // `units` first: it announces the variables, so that a missing one is noticed.
  bool good = write(MakeStruct(kMatUnits, variables, units)) &&
              write(MakeStruct(kMatNames, variables, names)) &&
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

void WriteMat(const std::filesystem::path& file, const Record& record,
              RecordFormat format) {
  FileReplacement replacement(file);
  const std::string temporary = replacement.temporary().string();
  const bool version5 = format == RecordFormat::kMat5;
  if (!version5) RequireRoom(file, temporary, record);
  MatFilePtr mat(
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
