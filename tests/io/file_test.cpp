// SPDX-License-Identifier: MIT
#include "spume/io/file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "spume/core/error.hpp"
#include "support/temporary_folder.hpp"

namespace spume {
namespace {

using testing::HasSubstr;

// The user's limit on the size of a file stands for a full disk.
TEST(File, SpaceThatIsNotThereIsRefusedBeforeTheFileIsTouched) {
  const test::TemporaryFolder folder;
  const auto path = folder / "file";
  test::write_contents(path, "contents");
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 1'000'000;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  std::string reason;
  try {
    const ReservedSpace space(path, 1'000'000);
  } catch (const FileError& error) {
    reason = error.what();
  }
  EXPECT_NO_THROW(ReservedSpace(path, 900'000));
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_THAT(reason, HasSubstr("file': File too large"));
  EXPECT_EQ(test::contents(path), "contents");
}

TEST(File, ATextThatCannotBeRenamedLeavesNothingBehind) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "text" / "inside");
  EXPECT_THROW(write_text_atomically(folder / "text", "new"), FileError);
  EXPECT_FALSE(std::filesystem::exists(folder / "text.part"));
  write_text_atomically(folder / "other", "old");
  write_text_atomically(folder / "other", "new");
  EXPECT_EQ(read_text(folder / "other"), "new");
  EXPECT_FALSE(std::filesystem::exists(folder / "other.part"));
}

}  // namespace
}  // namespace spume
