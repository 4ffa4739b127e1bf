// Files that appear together or not at all, and what killed writers leave behind.

#include "mjdiag/signals/folder_update.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string>

#include "mjdiag/signals/text_file.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

TEST(FolderUpdate, ShowsItsFilesWhenItIsCommitted) {
  const TemporaryFolder folder;
  const std::string a = folder.Write("a", "old");
  FolderUpdate update;
  WriteTextFile(a, "new");
  WriteTextFile(folder / "b", "new");
  EXPECT_EQ(ReadTextFile(a), "old");
  EXPECT_FALSE(fs::exists(folder / "b"));
  update.Commit();
  EXPECT_EQ(ReadTextFile(a), "new");
  EXPECT_EQ(ReadTextFile(folder / "b"), "new");
  EXPECT_EQ(folder.size(), 2);
}

TEST(FolderUpdate, LeavesNothingIfItIsNot) {
  const TemporaryFolder folder;
  const std::string a = folder.Write("a", "old");
  {
    const FolderUpdate update;
    WriteTextFile(a, "new");
    WriteTextFile(folder / "b", "new");
  }
  EXPECT_EQ(ReadTextFile(a), "old");
  EXPECT_EQ(folder.size(), 1);
  WriteTextFile(a, "at once");
  EXPECT_EQ(ReadTextFile(a), "at once");
}

TEST(FolderUpdate, IsAPartOfTheOneAround) {
  const TemporaryFolder folder;
  FolderUpdate outer;
  {
    FolderUpdate inner;
    WriteTextFile(folder / "a", "whole");
    inner.Commit();
  }
  {
    const FolderUpdate failed;
    WriteTextFile(folder / "b", "half of a setup");
  }
  EXPECT_FALSE(fs::exists(folder / "a"));
  outer.Commit();
  EXPECT_EQ(ReadTextFile(folder / "a"), "whole");
  EXPECT_EQ(folder.size(), 1);
}

TEST(MakeOutputFolder, ClearsWhatKilledWritersLeft) {
  const TemporaryFolder folder;
  const pid_t gone = fork();
  if (gone == 0) _exit(0);
  waitpid(gone, nullptr, 0);
  const auto part = [&folder](pid_t writer, const std::string& name) {
    return folder.Write("." + name + "." + std::to_string(writer) + "-0.part.csv", "1");
  };
  const std::string old = part(gone, "old");
  const std::string fresh = part(gone, "fresh");
  const std::string alive = part(getpid(), "alive");
  const std::string other = folder.Write(".mine.csv", "1");
  for (const std::string& file : {old, alive, other}) {
    fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(1));
  }
  MakeOutputFolder(folder.path());
  EXPECT_FALSE(fs::exists(old));
  for (const std::string& file : {fresh, alive, other}) EXPECT_TRUE(fs::exists(file));
}

}  // namespace
}  // namespace mjdiag
