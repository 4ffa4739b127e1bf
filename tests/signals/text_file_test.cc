#include "mjdiag/signals/text_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

#include "mjdiag/signals/error.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(TextFile, ComesBackAsItWasWritten) {
  const test::TemporaryFolder folder;
  const std::string text("a\r\nb\0c\n", 7);
  WriteTextFile(folder / "x.txt", "old");
  WriteTextFile(folder / "x.txt", text);
  EXPECT_EQ(ReadTextFile(folder / "x.txt"), text);
  EXPECT_EQ(folder.size(), 1) << "a temporary file was left behind";
}

TEST(TextFile, NamesTheFileThatCannotBeRead) {
  const test::TemporaryFolder folder;
  EXPECT_THAT([&] { ReadTextFile(folder / "none"); },
              ThrowsMessage<InputError>(HasSubstr("none: cannot be opened")));
  EXPECT_THAT([&] { ReadTextFile(folder.path()); },
              ThrowsMessage<InputError>(HasSubstr("is a folder; expected a file")));
}

TEST(TextFile, NamesTheFolderThatIsMissing) {
  const test::TemporaryFolder folder;
  EXPECT_THAT([&] { WriteTextFile(folder / "none/x.txt", ""); },
              ThrowsMessage<InputError>(HasSubstr("no folder")));
}

TEST(TextFile, DoesNotReplaceFoldersAndDevices) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(WriteTextFile(folder.path(), "text"), InputError);
  EXPECT_THROW(WriteTextFile("/dev/null", "text"), InputError);
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(TextFile, KeepsTheOldFileWhenTheDiskIsFull) {
  const test::TemporaryFolder folder;
  WriteTextFile(folder / "x.txt", "old");
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THROW(WriteTextFile(folder / "x.txt", std::string(100000, 'x')), InputError);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(ReadTextFile(folder / "x.txt"), "old");
  EXPECT_EQ(folder.size(), 1);
}

TEST(MakeOutputFolder, MakesParentsAndLeavesThemEmpty) {
  const test::TemporaryFolder folder;
  MakeOutputFolder(folder / "a/b");
  MakeOutputFolder(folder / "a/b");
  EXPECT_TRUE(std::filesystem::is_empty(folder / "a/b"));
}

TEST(MakeOutputFolder, RefusesAPathThroughAFile) {
  const test::TemporaryFolder folder;
  WriteTextFile(folder / "file", "");
  EXPECT_THROW(MakeOutputFolder(folder / "file"), InputError);
  EXPECT_THROW(MakeOutputFolder(folder / "file/a"), InputError);
}

}  // namespace
}  // namespace mjdiag
