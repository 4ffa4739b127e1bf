#pragma once
// What an MJCF has that the MuJoCo at hand does not know. Its parser names one attribute or
// element at a time; here are all, with the first MuJoCo that knows them and what says the
// same in this one. What is known is asked of MuJoCo itself (mj_printSchema).

#include <filesystem>
#include <string>
#include <vector>

namespace mjdiag {

struct NewerItem {
  std::string words;    ///< "joint actuatorfrcrange"
  std::string file;     ///< of its first place
  int line = 0;         ///< the same
  std::string version;  ///< first that has it, "3.0.0"; empty: not known here
  std::string instead;  ///< empty: not known here
};

/// All unknown attributes, elements and keywords of an MJCF and its includes, each once, in
/// the order of the file. Empty of a file that cannot be read, or is no MJCF.
std::vector<NewerItem> NewerThanThisMujoco(const std::filesystem::path& mjcf);

/// "is written for MuJoCo 3.1.3 or newer; this one, 2.2.2, does not know: joint ..." in one
/// line; empty if nothing of them is known to be of a newer one.
std::string DescribeNewer(const std::vector<NewerItem>& items);

}  // namespace mjdiag
