// SPDX-License-Identifier: MIT
// A program that is killed while it writes a snapshot loses nothing of the snapshots before.
#include "spume/io/journal.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <random>

#include "spume/core/error.hpp"
#include "spume/io/hdf5.hpp"
#include "spume/io/vtkhdf.hpp"
#include "support/stored_values.hpp"
#include "support/temporary_folder.hpp"

namespace spume {
namespace {

using hdf5::File;

constexpr std::size_t particles = 3000;

// Noise, so that compressed chunks differ in size and move about the file.
std::vector<double> values_of(std::int64_t step) {
  std::mt19937_64 random(static_cast<std::uint64_t>(step));
  std::vector<double> values(particles);
  for (double& value : values) value = static_cast<float>(static_cast<double>(random() >> 40) * 1e-3);
  return values;
}

void append(VtkhdfFile& file) {
  const auto values = values_of(file.steps());
  file.append(static_cast<double>(file.steps()),
              {"fluid", particles, {values.data(), values.data()}, {{"pressure", {values.data()}, {}}}});
}

std::vector<double> pressures(const std::filesystem::path& path) {
  return test::stored_values<double>(path, "/VTKHDF/PointData/pressure");
}

TEST(Journal, SnapshotsSurviveAKillAtAnyMoment) {
  const test::TemporaryFolder folder;
  const auto path = folder / "fluid.vtkhdf";
  {
    VtkhdfFile file(path, {});
    append(file);
  }
  std::mt19937 random(7);
  std::int64_t before = 1;
  for (int kill_number = 0; kill_number < 25; ++kill_number) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      VtkhdfFile file(path, {});
      for (;;) append(file);
    }
    ::usleep(2000 + random() % 30000);
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);

    VtkhdfFile file(path, {});
    ASSERT_GE(file.steps(), before);
    before = file.steps();
    const auto found = pressures(path);
    ASSERT_GE(found.size(), static_cast<std::size_t>(before) * particles);
    for (std::int64_t step = 0; step < before; ++step) {
      const auto expected = values_of(step);
      ASSERT_TRUE(std::equal(expected.begin(), expected.end(), found.begin() + step * std::ptrdiff_t{particles}))
          << "snapshot " << step << " after kill " << kill_number;
    }
    if (before > 60) {
      file.keep_steps(2);
      before = 2;
    }
  }
}

// A folder in the place of the journal: it can neither be written nor renamed to.
TEST(Journal, AChangeThatCannotBeSettledNamesTheReasonAndLeavesTheFile) {
  const test::TemporaryFolder folder;
  const auto path = folder / "fluid.vtkhdf";
  VtkhdfFile file(path, {});
  append(file);
  const std::string before = test::contents(path);
  for (const char* ending : {".journal.part", ".journal"}) {
    std::filesystem::create_directory(path.string() + ending);
    try {
      append(file);
      ADD_FAILURE() << ending;
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find("fluid.vtkhdf': Is a directory"), std::string::npos) << error.what();
    }
    EXPECT_EQ(test::contents(path), before);
    std::filesystem::remove(path.string() + ending);
  }
  append(file);
  EXPECT_EQ(pressures(path).size(), 2 * particles);
}

// What lies in memory until the file is closed is what HDF5 reads meanwhile; the file itself does not change.
TEST(Journal, ReadsBackWhatIsNotYetInTheFile) {
  const test::TemporaryFolder folder;
  const auto path = folder / "numbers.h5";
  const std::string earlier(10'000, 'a');
  {
    File file = File::create(path, File::Format::compatible);
    hdf5::write_text(file, "/text", earlier);
    file.close();
  }
  const std::string before = test::contents(path);
  std::string expected = earlier;
  File file = File::open(path, true);
  {
    const auto data = file.dataset("/text");
    const hsize_t first = 3000, count = 5000;  // across pages that begin and end outside
    expected.replace(first, count, std::string(count, 'b'));
    const auto space = file.take(H5Dget_space(data), H5Sclose, "write");
    H5Sselect_hyperslab(space, H5S_SELECT_SET, &first, nullptr, &count, nullptr);
    const auto memory = file.take(H5Screate_simple(1, &count, nullptr), H5Sclose, "write");
    const std::string change(count, 'b');
    file.check(H5Dwrite(data, H5T_NATIVE_UINT8, memory, space, H5P_DEFAULT, change.data()), "write");
  }
  file.flush();
  EXPECT_EQ(hdf5::read_text(file, "/text"), expected);
  EXPECT_EQ(test::contents(path), before);
  file.close();
  EXPECT_NE(test::contents(path), before);
  EXPECT_EQ(hdf5::read_text(File::open(path, false), "/text"), expected);
}

// Written over the first bytes: mark, crc32 and size of what follows, size of the file, address, size and bytes.
std::string journal_of(const std::string& file) {
  std::string body, text("SPUME JOURNAL 1", 16);
  const auto put = [](std::string& to, auto number) {
    to.append(reinterpret_cast<const char*>(&number), sizeof number);
  };
  for (const std::uint64_t number : {file.size(), std::size_t{0}, file.size()}) put(body, number);
  body += file;
  put(text, static_cast<std::uint32_t>(::crc32(0, reinterpret_cast<const Bytef*>(body.data()), body.size())));
  put(text, std::uint64_t{body.size()});
  return text + body;
}

// What a program leaves that is killed between the rename of its journal and the end of the copying.
TEST(Journal, AChangeThatWasBrokenOffIsCompletedWhenTheFileIsOpened) {
  const test::TemporaryFolder folder;
  const auto path = folder / "fluid.vtkhdf";
  {
    VtkhdfFile file(path, {});
    append(file);
  }
  const std::string before = test::contents(path);
  {
    VtkhdfFile file(path, {});
    append(file);
  }
  const std::string after = test::contents(path);
  const std::string torn = after.substr(0, 1000) + before.substr(1000);
  test::write_contents(path, torn);
  test::write_contents(path.string() + ".journal", journal_of(after));
  EXPECT_EQ(VtkhdfFile(path, {}).steps(), 2);
  EXPECT_EQ(test::contents(path), after);
  EXPECT_FALSE(std::filesystem::exists(path.string() + ".journal"));
  // A file that became shorter is cut.
  test::write_contents(path, after);
  test::write_contents(path.string() + ".journal", journal_of(before));
  EXPECT_EQ(VtkhdfFile(path, {}).steps(), 1);
  EXPECT_EQ(test::contents(path), before);
}

TEST(Journal, AJournalThatIsNotWholeIsDropped) {
  const test::TemporaryFolder folder;
  const auto path = folder / "fluid.vtkhdf";
  VtkhdfFile file(path, {});
  append(file);
  const std::string before = test::contents(path);
  const std::string whole = journal_of(std::string(before.size(), 'x'));
  std::string changed = whole;
  changed.back() = 'y';
  for (const std::string& text : {std::string("SPUME JOURNAL 1 and then nothing that would make sense"), std::string(),
                                  whole.substr(0, whole.size() - 1), changed, 'x' + whole.substr(1)}) {
    test::write_contents(path.string() + ".journal", text);
    EXPECT_EQ(VtkhdfFile(path, {}).steps(), 1);
    EXPECT_FALSE(std::filesystem::exists(path.string() + ".journal"));
    EXPECT_EQ(test::contents(path), before);
  }
  append(file);
  EXPECT_EQ(pressures(path).size(), 2 * particles);
}

}  // namespace
}  // namespace spume
