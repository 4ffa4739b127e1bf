#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/record_file.h"
#include "mjdiag/signals/text_file.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// A MAT file as another program would write it: no `units`, no `names`.
class ForeignMat {
 public:
  explicit ForeignMat(const std::filesystem::path& file, mat_ft version = MAT_FT_MAT5)
      : file_(Mat_CreateVer(file.c_str(), nullptr, version)) {}
  ~ForeignMat() { Mat_Close(file_); }
  ForeignMat(const ForeignMat&) = delete;
  ForeignMat& operator=(const ForeignMat&) = delete;

  template <typename Number>
  void Add(const char* name, matio_classes kind, matio_types type, std::size_t rows,
           std::size_t columns, std::vector<Number> data,
           matio_compression compression = MAT_COMPRESSION_NONE) {
    std::array<std::size_t, 2> dims{rows, columns};
    matvar_t* variable =
        Mat_VarCreate(name, kind, type, 2, dims.data(), data.data(), 0);
    EXPECT_EQ(Mat_VarWrite(file_, variable, compression), 0);
    Mat_VarFree(variable);
  }
  void AddVector(const char* name, const std::vector<double>& data) {
    Add(name, MAT_C_DOUBLE, MAT_T_DOUBLE, data.size(), 1, data, MAT_COMPRESSION_ZLIB);
  }
  /// A struct with one field.
  void AddStruct(const char* name, const char* field, std::vector<double> data) {
    std::array<std::size_t, 2> one{1, 1};
    std::array<std::size_t, 2> dims{data.size(), 1};
    matvar_t* variable = Mat_VarCreateStruct(name, 2, one.data(), &field, 1);
    Mat_VarSetStructFieldByName(variable, field, 0,
                                Mat_VarCreate(nullptr, MAT_C_DOUBLE, MAT_T_DOUBLE, 2,
                                              dims.data(), data.data(), 0));
    EXPECT_EQ(Mat_VarWrite(file_, variable, MAT_COMPRESSION_NONE), 0);
    Mat_VarFree(variable);
  }

 private:
  mat_t* file_;
};

std::string Error(const std::filesystem::path& file,
                  const std::optional<ColumnMap>& map = std::nullopt) {
  try {
    ReadRecord(file, map);
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_THAT(message, testing::Not(HasSubstr("\n")));
    return message.substr((file.parent_path() / "").string().size());
  }
  return "no error";
}

TEST(MatFile, ReadsVectorsOfOtherPrograms) {
  const test::TemporaryFolder folder;
  for (const mat_ft version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    const auto file = folder / ("foreign" + std::to_string(version) + ".mat");
    {
      ForeignMat mat(file, version);
      mat.AddVector("t", {0.0, 0.5, 1.0});
      mat.Add<float>("f", MAT_C_SINGLE, MAT_T_SINGLE, 1, 3, {1.5F, 2.5F, -3.5F});
      mat.Add<std::int16_t>("i", MAT_C_INT16, MAT_T_INT16, 3, 1, {-1, 0, 1000});
      mat.AddVector("gain", {3.0});
    }
    ColumnMap map;
    map.time.column = "t";
    map.columns = {{"force", "f", "mN", false}, {"count", "i", "", false}};
    const Record record = ReadRecord(file, map);
    EXPECT_EQ(record.sample_time(), 0.5);
    EXPECT_EQ(record.At("force").unit, "N");
    EXPECT_TRUE(record.At("force").samples.isApprox(
        Eigen::Vector3d(1.5e-3, 2.5e-3, -3.5e-3), 1e-15));
    EXPECT_EQ(record.At("count").samples, Eigen::Vector3d(-1.0, 0.0, 1000.0));
  }
}

TEST(MatFile, HasTheColumnsOfMatricesAndTheFieldsOfStructs) {
  const test::TemporaryFolder folder;
  for (const mat_ft version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    const auto file = folder / ("columns" + std::to_string(version) + ".mat");
    {
      ForeignMat mat(file, version);
      mat.AddVector("time", {0.0, 0.5, 1.0});
      mat.Add<double>("q", MAT_C_DOUBLE, MAT_T_DOUBLE, 3, 2, {1, 2, 3, 4, 5, 6});
      mat.Add<double>("along", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, 3, {1, 4, 2, 5, 3, 6});
      mat.AddVector("gain", {3.0});
      mat.Add<char>("note", MAT_C_CHAR, MAT_T_UTF8, 1, 3, {'a', 'b', 'c'});
      mat.AddStruct("log", "u", {7.0, 8.0, 9.0});
    }
    ColumnMap map;
    map.columns = {{"a", "q[0]"}, {"b", "q:1"}, {"c", "along[1]"}, {"d", "log/u"}};
    const Record record = ReadRecord(file, map);
    EXPECT_EQ(record.At("a").samples, Eigen::Vector3d(1.0, 2.0, 3.0));
    EXPECT_EQ(record.At("b").samples, Eigen::Vector3d(4.0, 5.0, 6.0));
    EXPECT_EQ(record.At("c").samples, Eigen::Vector3d(4.0, 5.0, 6.0));
    EXPECT_EQ(record.At("d").samples, Eigen::Vector3d(7.0, 8.0, 9.0));
    const Record all = ReadRecord(file);
    EXPECT_NE(all.Find("q[1]"), nullptr);
    EXPECT_EQ(all.Find("gain"), nullptr) << "no series";
    EXPECT_EQ(all.Find("note"), nullptr);
  }
}

TEST(MatFile, SaysWhichVariableIsWrong) {
  const test::TemporaryFolder folder;
  const auto file = folder / "r.mat";
  {
    ForeignMat mat(file);
    mat.AddVector("time", {0.0, 1.0, 2.0, 3.0});
    mat.Add<double>("matrix", MAT_C_DOUBLE, MAT_T_DOUBLE, 3, 2, {1, 2, 3, 4, 5, 6});
    mat.Add<char>("text", MAT_C_CHAR, MAT_T_UTF8, 1, 3, {'a', 'b', 'c'});
    mat.AddVector("short", {0.0, 1.0});
    mat.AddVector("bad", {0.0, NAN, 1.0, 2.0});
    mat.AddVector("infinite", {0.0, 1.0, INFINITY, 2.0});
    mat.AddVector("jump", {0.0, 1.0, 3.0, 4.0});
  }
  const auto error = [&](const std::string& variable) {
    ColumnMap map;
    map.columns = {{"x", variable, "m", false}};
    return Error(file, map);
  };
  EXPECT_EQ(
      error("matrix[0]"),
      "r.mat: variable \"matrix:0\": 3 samples; expected 4 as variable \"time\" has");
  EXPECT_EQ(error("text"), "r.mat: variable \"text\": text; expected a real vector");
  EXPECT_EQ(error("short"),
            R"(r.mat: variable "short": 2 samples; expected 4 as variable "time" has)");
  EXPECT_EQ(error("bad"),
            "r.mat: variable \"bad\", element 2: NaN; expected a finite number");
  EXPECT_EQ(
      error("infinite"),
      "r.mat: variable \"infinite\", element 3: infinite; expected a finite number");
  EXPECT_THAT(error("none"), StartsWith("r.mat: no column \"none\"; expected one of"));
  ColumnMap map;
  map.time.column = "jump";
  map.columns = {{"x", "time", "s", false}};
  EXPECT_THAT(Error(file, map),
              StartsWith("r.mat: variable \"jump\", element 3: time is not uniform"));
}

class TruncatedMat : public testing::TestWithParam<RecordFormat> {};

TEST_P(TruncatedMat, IsRefusedAtEveryLength) {
  const test::TemporaryFolder folder;
  Record record(1.0 / 8000.0);
  record.Add({"x", "m", Eigen::VectorXd::LinSpaced(60, 0.0, 1.0)});
  record.Add({"joint.u", "N", Eigen::VectorXd::LinSpaced(60, 1.0, 2.0)});
  WriteRecord(folder / "r.mat", record, GetParam());
  const std::string whole = ReadTextFile(folder / "r.mat");
  // Every length where the structure is, every 61st in the long parts.
  testing::internal::CaptureStderr();
  for (std::size_t size = 0; size < whole.size();
       size += size < 800 || whole.size() - size < 200 ? 1 : 61) {
    WriteTextFile(folder / "cut.mat", whole.substr(0, size));
    EXPECT_NE(Error(folder / "cut.mat"), "no error") << size << " bytes";
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  WriteTextFile(folder / "cut.mat", whole);
  EXPECT_EQ(Error(folder / "cut.mat"), "no error");
}

TEST_P(TruncatedMat, IsCalledTruncated) {
  const test::TemporaryFolder folder;
  Record record(1.0);
  record.Add({"x", "m", Eigen::VectorXd::Zero(100)});
  WriteRecord(folder / "r.mat", record, GetParam());
  const std::string whole = ReadTextFile(folder / "r.mat");
  WriteTextFile(folder / "r.mat", whole.substr(0, whole.size() / 2));
  EXPECT_THAT(Error(folder / "r.mat"), StartsWith("r.mat: truncated MAT file"));
}

INSTANTIATE_TEST_SUITE_P(Formats, TruncatedMat,
                         testing::Values(RecordFormat::kMat5, RecordFormat::kMat73));

}  // namespace
}  // namespace mjdiag
