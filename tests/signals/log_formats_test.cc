// Logs in JSON and HDF5, and in formats that are not read.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/record_file.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

#ifdef MJDIAG_HDF5
#include <hdf5.h>
#endif

namespace mjdiag {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::vector<std::string> NamesIn(const Record& record) {
  std::vector<std::string> names;
  for (const Channel& channel : record.channels()) names.push_back(channel.name);
  return names;
}

class JsonRecord : public testing::Test {
 protected:
  Record Read(const std::string& text) const {
    return ReadRecord(folder_.Write("r.json", text));
  }
  std::string Error(const std::string& text) const {
    return test::MessageOf<InputError>([&] { Read(text); });
  }
  const test::TemporaryFolder folder_;
};

TEST_F(JsonRecord, IsTheSameAsArraysAsObjectsAndAsLines) {
  const std::array<const char*, 4> texts{
      R"({"time": [0, 0.5], "q": [[1, 2], [3, 4]], "motor": {"u [N m]": [5, 6]},
          "robot": "a", "gains": [9]})",
      R"({"time":[0,0.5],"q":[[1,2],[3,4]],"motor":{"u":[5,6]},"units":{"motor/u":"N m"}})",
      R"([{"time": 0, "q": [1, 2], "motor": {"u [N m]": 5}},
          {"time": 0.5, "q": [3, 4], "motor": {"u [N m]": 6}}])",
      "{\"time\": 0, \"q\": [1, 2], \"motor\": {\"u [N m]\": 5}}\n"
      "{\"time\": 0.5, \"q\": [3, 4], \"motor\": {\"u [N m]\": 6}}\n"
      "{\"time\": 1.0, \"q\": [7, "};  // cut off while it was written
  for (const char* text : texts) {
    SCOPED_TRACE(text);
    const Record record = Read(text);
    EXPECT_EQ(record.sample_time(), 0.5);
    EXPECT_THAT(NamesIn(record), ElementsAre("q[0]", "q[1]", "motor/u"));
    EXPECT_EQ(record.At("q[1]").samples, Eigen::Vector2d(2.0, 4.0));
    EXPECT_EQ(record.At("motor/u").samples, Eigen::Vector2d(5.0, 6.0));
    EXPECT_EQ(record.At("motor/u").unit, "N m");
  }
}

TEST_F(JsonRecord, MarksWhatIsMissing) {
  const auto file = folder_.Write(
      "r.jsonl",
      "{\"time\":0,\"x\":1}\n{\"time\":1,\"x\":NaN}\n\n{\"time\":2,\"x\":3}\n"
      "{\"time\":3}\n{\"time\":4,\"x\":-Infinity}\n{\"time\":5,\"x\":6}\n");
  const MeasuredFile read =
      ReadMeasuredFile(file, std::nullopt, {1.0, {}, {{"x", {}}}});
  const Channel& x = read.record.At("x");
  ASSERT_EQ(x.measured.size(), 6);
  EXPECT_EQ(x.measured.count(), 3);
  EXPECT_TRUE(x.measured[0] && x.measured[2] && x.measured[5]);
  EXPECT_THAT(test::MessageOf<InputError>([&] { ReadRecord(file); }),
              HasSubstr("r.jsonl: line 2, \"x\": no number; expected a finite number"));
}

TEST_F(JsonRecord, SaysWhereItIsWrong) {
  EXPECT_THAT(Error("{\"time\": [0,\n 1], \"x\": [0 1]}"),
              HasSubstr("r.json: line 2: is not JSON; expected an object of arrays"));
  EXPECT_THAT(Error("{\"time\": 0}\nnothing\n{\"time\": 1}\n"),
              HasSubstr("r.json: line 2: is not JSON"));
  EXPECT_THAT(Error("{\"name\": \"a\"}"), HasSubstr("has no numbers"));
  EXPECT_THAT(Error("{\"t\": [0, 1], \"x\": [0, 1]}"),
              HasSubstr("no column \"time\"; expected one of t, x"));
  EXPECT_THAT(Error("{\"time\": [0, 1, 2], \"x\": [0, 1]}"),
              HasSubstr("\"x\": 2 samples; expected 3 as \"time\" has"));
  EXPECT_THAT(Error(std::string(100'000, '[')), HasSubstr("is not JSON"));
  EXPECT_THAT(Error(std::string(1000, '[') + std::string(1000, ']')),
              HasSubstr("nests deeper"));
}

TEST(ForeignFormat, SaysHowToConvertIt) {
  const test::TemporaryFolder folder;
  const auto error = [&](const std::string& name, std::string head) {
    head += std::string(100, '\0');
    const auto file = folder.Write(name, head);
    return test::MessageOf<InputError>([&] { ReadRecord(file); });
  };
  EXPECT_THAT(
      error("a.parquet", "PAR1"),
      HasSubstr("a.parquet: a Parquet file; expected CSV, JSON, HDF5 or MAT; in "
                "Python: pandas.read_parquet(\"a.parquet\").to_csv(\"a.csv\""));
  EXPECT_THAT(error("a.npz", "PK\x03\x04"),
              HasSubstr("scipy.io.savemat(\"a.mat\", dict(numpy.load(\"a.npz\")))"));
  EXPECT_THAT(error("a.npy", "\x93NUMPY"), HasSubstr("numpy.load(\"a.npy\")"));
  for (const auto& [name, head] :
       {std::pair{"a.bag", "#ROSBAG V2.0\n"}, std::pair{"a.mcap", "\x89MCAP0\r\n"},
        std::pair{"a.db3", "SQLite format 3"}}) {
    EXPECT_THAT(error(name, head), AllOf(HasSubstr("rosbags"), Not(HasSubstr("\n"))));
  }
  EXPECT_THAT(error("a.bin", "PK\x03\x04"),
              HasSubstr("unknown format; expected CSV, JSON, HDF5 or MAT"));
}

#ifdef MJDIAG_HDF5

/// An HDF5 file as another program would write it.
class ForeignHdf5 {
 public:
  explicit ForeignHdf5(const std::filesystem::path& file)
      : file_(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {}
  ~ForeignHdf5() { H5Fclose(file_); }
  ForeignHdf5(const ForeignHdf5&) = delete;
  ForeignHdf5& operator=(const ForeignHdf5&) = delete;

  void Group(const char* name) const {
    H5Gclose(H5Gcreate2(file_, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  }
  void Add(const char* name, const std::vector<hsize_t>& size,
           const std::vector<double>& data, hid_t type = H5T_IEEE_F64LE,
           const char* unit = nullptr) const {
    const hid_t space =
        H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr);
    const hid_t set =
        H5Dcreate2(file_, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data());
    if (unit != nullptr) AddText(set, unit);
    H5Dclose(set);
    H5Sclose(space);
  }

 private:
  static void AddText(hid_t set, const char* text) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t attribute =
        H5Acreate2(set, "units", type, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, type, static_cast<const void*>(&text));
    H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
  }
  hid_t file_;
};

TEST(Hdf5Record, HasSetsOfGroupsAndColumnsOfMatrices) {
  const test::TemporaryFolder folder;
  const auto file = folder / "r.h5";
  {
    const ForeignHdf5 hdf5(file);
    hdf5.Add("time", {3}, {0.0, 500.0, 1000.0}, H5T_STD_I32LE, "ms");
    hdf5.Add("q", {3, 2}, {1, 4, 2, 5, 3, 6}, H5T_IEEE_F32LE, "deg");
    hdf5.Group("motor");
    hdf5.Add("motor/u", {3, 1}, {7, 8, 9});
    hdf5.Add("motor/across", {2, 3}, {1, 2, 3, 4, 5, 6});
    hdf5.Add("gain", {1}, {3});
  }
  const Record all = ReadRecord(file);
  EXPECT_EQ(all.sample_time(), 0.5);
  EXPECT_THAT(NamesIn(all),
              testing::UnorderedElementsAre("q[0]", "q[1]", "motor/u",
                                            "motor/across[0]", "motor/across[1]"));
  EXPECT_EQ(all.At("q[0]").unit, "rad");
  ColumnMap map;
  map.columns = {{"a", "q:1", "rad"}, {"u", "motor/u", "N"}, {"b", "motor/across[1]"}};
  const Record record = ReadRecord(file, map);
  EXPECT_EQ(record.At("a").samples, Eigen::Vector3d(4.0, 5.0, 6.0));
  EXPECT_EQ(record.At("u").samples, Eigen::Vector3d(7.0, 8.0, 9.0));
  EXPECT_EQ(record.At("b").samples, Eigen::Vector3d(4.0, 5.0, 6.0));
}

TEST(Hdf5Record, SaysWhatIsWrong) {
  const test::TemporaryFolder folder;
  const auto file = folder / "r.h5";
  {
    const ForeignHdf5 hdf5(file);
    hdf5.Add("time", {3}, {0, 1, 2});
    hdf5.Add("x", {3}, {0, NAN, 2});
    hdf5.Add("y", {2}, {0, 1});
  }
  const auto error = [&](const std::string& column) {
    ColumnMap map;
    map.columns = {{"c", column}};
    return test::MessageOf<InputError>([&] { ReadRecord(file, map); });
  };
  EXPECT_THAT(error("x"), HasSubstr("\"x\", sample 1: NaN; expected a finite number"));
  EXPECT_THAT(error("y"), HasSubstr("\"y\": 2 samples; expected 3 as \"time\" has"));
  EXPECT_THAT(error("z"), HasSubstr("no column \"z\"; expected one of"));
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  testing::internal::CaptureStderr();
  EXPECT_THAT(error("x"), HasSubstr("cut off"));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

#endif

}  // namespace
}  // namespace mjdiag
