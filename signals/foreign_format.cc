#include "mjdiag/signals/foreign_format.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using std::string_view_literals::operator""sv;

struct ForeignFormat {
  std::string_view begins;  ///< the file
  std::string_view ending;  ///< of its name; empty: any
  std::string_view what;
  std::string_view python;  ///< IN and OUT stand for the names of the files
};

constexpr std::string_view kBag =
    "with the packages rosbags and rosbags-dataframe: df = get_dataframe(reader, "
    "\"/joint_states\", [\"position[0]\"]) inside AnyReader; df.insert(0, \"time\", "
    "(df.index - df.index[0]).total_seconds()); df.to_csv(OUT, index=False)";
constexpr std::string_view kPickle =
    "pandas.DataFrame(pandas.read_pickle(IN)).to_csv(OUT, index=False)";

constexpr std::array<ForeignFormat, 13> kForeign{{
    {"PAR1", "", "a Parquet file", "pandas.read_parquet(IN).to_csv(OUT, index=False)"},
    {"ARROW1", "", "an Arrow file", "pandas.read_feather(IN).to_csv(OUT, index=False)"},
    {"FEA1", "", "a Feather file", "pandas.read_feather(IN).to_csv(OUT, index=False)"},
    {"PK\x03\x04"sv, ".npz", "an archive of NumPy",
     "scipy.io.savemat(MAT, dict(numpy.load(IN)))"},
    {"PK\x03\x04"sv, ".xlsx", "a spreadsheet",
     "pandas.read_excel(IN).to_csv(OUT, index=False)"},
    {"\x93NUMPY"sv, "", "an array of NumPy",
     "numpy.savetxt(OUT, numpy.load(IN), delimiter=\",\", header=\"time,NAMES\", "
     "comments=\"\")"},
    {"#ROSBAG", "", "a bag of ROS", kBag},
    {"\x89MCAP0\r\n"sv, "", "a bag of ROS 2", kBag},
    {"SQLite format 3", "", "a database (a bag of ROS 2?)", kBag},
    {"\x80", ".pkl", "a pickle of Python", kPickle},
    {"\x80", ".pickle", "a pickle of Python", kPickle},
    {"MDF     ", "", "a measurement in MDF",
     "asammdf.MDF(IN).to_dataframe().to_csv(OUT, index_label=\"time\")"},
    {"TDSm", "", "a measurement in TDMS",
     "nptdms.TdmsFile(IN).as_dataframe().to_csv(OUT, index=False)"},
}};

std::string LowerCase(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return text;
}

std::string InQuotes(const std::filesystem::path& file) {
  return "\"" + file.filename().string() + "\"";
}

/// The line with the names of the files.
std::string Filled(std::string line, const std::filesystem::path& file) {
  std::filesystem::path out = file;
  const std::array<std::pair<std::string_view, std::string>, 3> names{{
      {"(IN)", "(" + InQuotes(file) + ")"},
      {"(OUT", "(" + InQuotes(out.replace_extension(".csv"))},
      {"(MAT", "(" + InQuotes(out.replace_extension(".mat"))},
  }};
  for (const auto& [place, name] : names) {
    const std::size_t at = line.find(place);
    if (at != std::string::npos) line.replace(at, place.size(), name);
  }
  return line;
}

}  // namespace

void RefuseForeignFormat(const std::filesystem::path& file, std::string_view head) {
  const std::string ending = LowerCase(file.extension().string());
  for (const ForeignFormat& format : kForeign) {
    if (!head.starts_with(format.begins)) continue;
    if (!format.ending.empty() && ending != format.ending) continue;
    throw InputError(file.string(), std::string(format.what),
                     "CSV, JSON, HDF5 or MAT; in Python: " +
                         Filled(std::string(format.python), file));
  }
}

}  // namespace mjdiag
