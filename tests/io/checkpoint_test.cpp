// SPDX-License-Identifier: MIT
#include "spume/io/checkpoint.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

#include "spume/core/error.hpp"
#include "support/temporary_folder.hpp"

namespace spume {
namespace {

using test::contents;
using test::TemporaryFolder;
using test::write_contents;
using testing::HasSubstr;

const CheckpointOrigin origin = {"1.2.3", "abc", "title = \"x\"\n"};

std::vector<double> some_values() {
  std::vector<double> values;
  for (int i = 0; i < 5000; ++i) values.push_back(std::sin(i));
  values.push_back(std::numeric_limits<double>::quiet_NaN());
  return values;
}

void write_checkpoint(const std::filesystem::path& path) {
  CheckpointWriter writer(path, origin);
  const std::int64_t ids[] = {std::int64_t{1} << 62, -5};
  writer.f64("method/position", some_values());
  writer.i64("method/id", ids);
  writer.f64("method/empty", {});
  writer.commit();
}

std::string refusal(const std::filesystem::path& path) {
  try {
    const CheckpointReader reader(path);
  } catch (const FileError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Checkpoint, ArraysComeBackToTheBit) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "checkpoint.h5");
  const CheckpointReader reader(folder / "checkpoint.h5");
  Array<double> position, empty(3);
  Array<std::int64_t> ids;
  reader.f64("method/position", position);
  reader.f64("method/empty", empty);
  reader.i64("method/id", ids);
  const auto expected = some_values();
  ASSERT_EQ(position.size(), expected.size());
  EXPECT_EQ(std::memcmp(position.data(), expected.data(), expected.size() * sizeof(double)), 0);
  EXPECT_TRUE(empty.empty());
  ASSERT_EQ(ids.size(), 2u);
  EXPECT_EQ(ids[0], std::int64_t{1} << 62);
  EXPECT_EQ(ids[1], -5);
  EXPECT_EQ(reader.origin().case_text, origin.case_text);
  EXPECT_EQ(reader.origin().program_version, "1.2.3");
  EXPECT_EQ(reader.entries().size(), 3u);
}

TEST(Checkpoint, AbsentAndMistypedArraysAreRefusedByName) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "checkpoint.h5");
  const CheckpointReader reader(folder / "checkpoint.h5");
  Array<double> values;
  EXPECT_THROW(reader.f64("method/speed", values), FileError);
  EXPECT_THROW(reader.f64("nowhere/speed", values), FileError);
  EXPECT_THROW(reader.f64("method/id", values), FileError);
}

TEST(Checkpoint, EveryFlippedByteIsNoticed) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "checkpoint.h5");
  const std::string good = contents(folder / "checkpoint.h5");
  ASSERT_GT(good.size(), 40000u);
  for (std::size_t at = 512; at < good.size(); at += 997) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x10);
    write_contents(folder / "bad.h5", bad);
    EXPECT_THAT(refusal(folder / "bad.h5"), HasSubstr("damaged")) << "byte " << at;
  }
}

TEST(Checkpoint, EveryShortenedFileIsRefusedWithTheReason) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "checkpoint.h5");
  const std::string good = contents(folder / "checkpoint.h5");
  for (std::size_t size = 16; size < good.size(); size += 1511) {
    write_contents(folder / "bad.h5", good.substr(0, size));
    EXPECT_THAT(refusal(folder / "bad.h5"), HasSubstr("cut short")) << size << " bytes";
  }
  write_contents(folder / "bad.h5", "");
  EXPECT_THAT(refusal(folder / "bad.h5"), HasSubstr("empty"));
  write_contents(folder / "bad.h5", good + "x");
  EXPECT_THAT(refusal(folder / "bad.h5"), HasSubstr("damaged"));
}

TEST(Checkpoint, ForeignFilesAndOtherFormatsAreRefused) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "checkpoint.h5");
  std::string other = contents(folder / "checkpoint.h5");
  other.replace(other.find("format 2"), 8, "format 9");
  write_contents(folder / "other.h5", other);
  EXPECT_THAT(refusal(folder / "other.h5"), HasSubstr("format 9, this program reads format 2"));
  write_contents(folder / "foreign.h5", std::string(4000, 'x'));
  EXPECT_THAT(refusal(folder / "foreign.h5"), HasSubstr("not a Spume checkpoint"));
  EXPECT_THAT(refusal(folder.path()), HasSubstr("folder"));
  EXPECT_THAT(refusal(folder / "none.h5"), HasSubstr("No such file or directory"));
}

TEST(Checkpoint, WithoutCommitTheEarlierOneStays) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "checkpoint.h5");
  const std::string before = contents(folder / "checkpoint.h5");
  {
    CheckpointWriter writer(folder / "checkpoint.h5", origin);
    writer.f64("x", some_values());
  }
  EXPECT_EQ(contents(folder / "checkpoint.h5"), before);
  EXPECT_FALSE(std::filesystem::exists(folder / "checkpoint.h5.part"));
}

// Also in another second: HDF5 notes the time of each object unless it is told not to.
TEST(Checkpoint, SameStateGivesTheSameBytes) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "a.h5");
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  write_checkpoint(folder / "b.h5");
  EXPECT_EQ(contents(folder / "a.h5"), contents(folder / "b.h5"));
}

}  // namespace
}  // namespace spume
