// SPDX-License-Identifier: MIT
#include "spume/io/series.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "spume/core/error.hpp"
#include "support/temporary_folder.hpp"

namespace spume {
namespace {

using test::contents;
using test::TemporaryFolder;
using testing::HasSubstr;

const std::vector<SeriesColumn> columns = {{"step", "1"}, {"energy", "J"}};

void write_rows(SeriesFile& file, int first, int last) {
  for (int i = first; i < last; ++i) {
    const double row[] = {static_cast<double>(i), std::exp(0.1 * i)};
    file.row(row);
  }
}

TEST(Series, HeadingNamesUnitsAndColumns) {
  const TemporaryFolder folder;
  { auto file = SeriesFile::create(folder / "series.csv", "A case", columns); }
  EXPECT_EQ(contents(folder / "series.csv"), "# A case\n# step: 1\n# energy: J\nstep,energy\n");
}

TEST(Series, NumbersReadBackToTheSameBits) {
  const TemporaryFolder folder;
  const double values[] = {0.1 + 0.2, std::numeric_limits<double>::denorm_min()};
  {
    auto file = SeriesFile::create(folder / "series.csv", "A case", columns);
    file.row(values);
  }
  const std::string text = contents(folder / "series.csv");
  const auto last = text.rfind('\n', text.size() - 2) + 1;
  char* end = nullptr;
  EXPECT_EQ(std::strtod(text.c_str() + last, &end), values[0]);
  EXPECT_EQ(std::strtod(end + 1, nullptr), values[1]);
}

TEST(Series, ANumberThatIsNoneHasNoSign) {
  const TemporaryFolder folder;
  const double none = std::numeric_limits<double>::quiet_NaN(), values[] = {none, -none};
  {
    auto file = SeriesFile::create(folder / "series.csv", "A case", columns);
    file.row(values);
  }
  EXPECT_TRUE(contents(folder / "series.csv").ends_with("\nnan,nan\n"));
}

TEST(Series, AnExistingFileIsNotOverwritten) {
  const TemporaryFolder folder;
  { auto file = SeriesFile::create(folder / "series.csv", "A case", columns); }
  EXPECT_THROW(SeriesFile::create(folder / "series.csv", "A case", columns), FileError);
}

TEST(Series, ResumedFileEqualsOneWrittenInOneGo) {
  const TemporaryFolder folder;
  {
    auto whole = SeriesFile::create(folder / "whole.csv", "A case", columns);
    write_rows(whole, 0, 20);
    auto first = SeriesFile::create(folder / "parts.csv", "A case", columns);
    write_rows(first, 0, 13);
  }
  {
    // The program was killed while it wrote its last row.
    std::ofstream(folder / "parts.csv", std::ios::app) << "13,3.66";
    auto second = SeriesFile::resume(folder / "parts.csv", columns, 9);
    EXPECT_EQ(second.rows(), 9);
    write_rows(second, 9, 20);
  }
  EXPECT_EQ(contents(folder / "parts.csv"), contents(folder / "whole.csv"));
}

TEST(Series, ResumeRefusesForeignColumnsAndMissingRows) {
  const TemporaryFolder folder;
  {
    auto file = SeriesFile::create(folder / "series.csv", "A case", columns);
    write_rows(file, 0, 3);
  }
  const auto refusal = [&](const std::vector<SeriesColumn>& wanted, std::int64_t rows) -> std::string {
    try {
      SeriesFile::resume(folder / "series.csv", wanted, rows);
    } catch (const FileError& error) {
      return error.what();
    }
    return "";
  };
  auto more = columns, fewer = columns, turned = columns;
  more.push_back({"speed", "m/s"});
  fewer.pop_back();
  std::swap(turned[0], turned[1]);
  EXPECT_THAT(refusal(more, 3),
              HasSubstr("it has no column 'speed'; resume with the program version named in log.txt"));
  EXPECT_THAT(refusal(fewer, 3), HasSubstr("does not write its column '" + columns.back().name + "'"));
  EXPECT_THAT(refusal(turned, 3), HasSubstr("in another order"));
  EXPECT_THAT(refusal(columns, 4), HasSubstr("holds 3 rows, the checkpoint was made after 4"));
  std::filesystem::resize_file(folder / "series.csv", contents(folder / "series.csv").find("energy\n0") + 6);
  EXPECT_THAT(refusal(columns, 3), HasSubstr("its line of column names is incomplete"));
}

TEST(Series, WordsStandBetweenNumbers) {
  const TemporaryFolder folder;
  {
    auto file = SeriesFile::create(folder / "lines.csv", "Lines", {{"t", "s"}, {"name", ""}, {"s", "m"}});
    const double t = 0.5, s = 2;
    file.row(std::span(&t, 1), "centre", std::span(&s, 1));
  }
  EXPECT_THAT(contents(folder / "lines.csv"), HasSubstr("\n0.5,centre,2\n"));
}

TEST(Series, AnUnwritableFolderIsNamedWithTheReason) {
  try {
    SeriesFile::create("/proc/no/series.csv", "A case", columns);
    FAIL() << "no error";
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("/proc/no/series.csv"));
    EXPECT_THAT(error.what(), HasSubstr("No such file or directory"));
  }
}

}  // namespace
}  // namespace spume
