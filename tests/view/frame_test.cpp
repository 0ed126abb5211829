// SPDX-License-Identifier: MIT
// Frames: what a viewer gets of a state, to how many digits, and how much of it.
#include "spume/view/frame.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

namespace spume {
namespace {

using testing::ElementsAre;
using testing::Le;

struct Decoded {
  nlohmann::json header;
  std::string payload;
  template <class Code>
  std::vector<Code> codes(const nlohmann::json& at, std::size_t count) const {
    std::vector<Code> read(count);
    const auto start = at.get<std::size_t>();
    EXPECT_EQ(start % 4, 0U);
    EXPECT_LE(start + count * sizeof(Code), payload.size());
    if (count > 0) std::memcpy(read.data(), payload.data() + start, count * sizeof(Code));
    return read;
  }
  // The values of a block as the page reads them.
  std::vector<double> values(std::size_t block, std::size_t count) const {
    const nlohmann::json& v = header["blocks"][block]["values"];
    const double low = v["low"], high = v["high"];
    std::vector<double> list;
    const auto read = [&](double code, double top) {
      list.push_back(code > top ? std::nan("") : low + code / top * (high - low));
    };
    if (v["bits"] == 8)
      for (const std::uint8_t code : codes<std::uint8_t>(v["at"], count)) read(code, 254);
    else
      for (const std::uint16_t code : codes<std::uint16_t>(v["at"], count)) read(code, 65534);
    return list;
  }
};

Decoded decoded(const std::string& frame) {
  std::uint32_t length = 0;
  std::memcpy(&length, frame.data(), sizeof length);
  return {nlohmann::json::parse(frame.substr(4 + length)), frame.substr(4, length)};
}

std::string make_frame(std::int64_t step, double time, const std::vector<ParticleSnapshot>& families,
                       const std::vector<GridSnapshot>& grids, const FrameWish& wish) {
  return *FrameMaker().make(step, time, families, grids, wish);
}

// Particles at random places, with a scalar, a vector, identifiers and sizes.
struct Cloud {
  explicit Cloud(std::size_t size, std::size_t dimensions = 3) : size_(size), dimensions_(dimensions) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      position[axis].resize(size);
      velocity[axis].resize(size);
    }
    pressure.resize(size), radius.resize(size), id.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        position[axis][i] = 1e4 + std::sin(1.7 * static_cast<double>(i * 3 + axis));
        velocity[axis][i] = std::cos(0.3 * static_cast<double>(i + axis));
      }
      pressure[i] = -5 + 0.01 * static_cast<double>(i);
      radius[i] = 1e-3 * (1 + static_cast<double>(i % 7));
      id[i] = static_cast<std::int64_t>(size - i);
    }
  }
  ParticleSnapshot snapshot(const std::string& name = "fluid") const {
    ParticleSnapshot family{name, size_, {}, {}};
    for (std::size_t axis = 0; axis < dimensions_; ++axis) family.position.push_back(position[axis].data());
    family.fields = {{"pressure", {pressure.data()}, {}},
                     {"velocity", {velocity[0].data(), velocity[1].data(), velocity[2].data()}, {}},
                     {"id", {}, {id.data()}},
                     {"radius", {radius.data()}, {}}};
    return family;
  }
  std::size_t size_, dimensions_;
  std::vector<double> position[3], velocity[3], pressure, radius;
  std::vector<std::int64_t> id;
};

// Half a step of the codes, and the rounding of a number of the size of the coordinates.
double step_of(double low, double high, double top) {
  return 0.5001 * (high - low) / top +
         4 * std::numeric_limits<double>::epsilon() * std::max(std::abs(low), std::abs(high));
}

TEST(Frame, PositionsAreRightToHalfACode) {
  for (const std::size_t dimensions : {2U, 3U}) {
    const Cloud cloud(1000, dimensions);
    const Decoded frame = decoded(make_frame(12, 0.5, {cloud.snapshot()}, {}, {}));
    const nlohmann::json& block = frame.header["blocks"][0];
    EXPECT_EQ(frame.header["step"], 12);
    EXPECT_EQ(frame.header["time"], 0.5);
    EXPECT_EQ(block["dimensions"], dimensions);
    EXPECT_EQ(block["count"], 1000);
    const auto codes = frame.codes<std::uint16_t>(block["positions"]["at"], 1000 * dimensions);
    for (std::size_t axis = 0; axis < dimensions; ++axis) {
      const double low = block["lower"][axis], high = block["upper"][axis];
      for (std::size_t i = 0; i < 1000; ++i)
        ASSERT_NEAR(low + codes[i * dimensions + axis] / 65535.0 * (high - low), cloud.position[axis][i],
                    step_of(low, high, 65535));
    }
  }
}

TEST(Frame, ValuesAreRightToHalfACodeInEightAndSixteenBits) {
  const Cloud cloud(500);
  for (const int bits : {8, 16}) {
    const Decoded frame = decoded(make_frame(0, 0, {cloud.snapshot()}, {}, {.bits = bits}));
    const std::vector<double> values = frame.values(0, 500);
    for (std::size_t i = 0; i < 500; ++i)
      ASSERT_NEAR(values[i], cloud.pressure[i], step_of(-5, 0, bits == 8 ? 254 : 65534));
  }
}

TEST(Frame, AFamilyIsColouredByAnyFieldItsSizeOrAComponent) {
  const Cloud cloud(100);
  EXPECT_THAT(colourings(cloud.snapshot()),
              ElementsAre("pressure", "velocity", "velocity_x", "velocity_y", "velocity_z", "id", "radius"));
  const auto value = [&](const std::string& field, std::size_t i) {
    const Decoded frame = decoded(make_frame(0, 0, {cloud.snapshot()}, {}, {.fields = {{"fluid", field}}}));
    EXPECT_EQ(frame.header["blocks"][0]["field"], field);
    return frame.values(0, 100)[i];
  };
  EXPECT_NEAR(value("velocity_y", 3), cloud.velocity[1][3], 1e-4);
  EXPECT_NEAR(value("velocity", 3), std::hypot(cloud.velocity[0][3], cloud.velocity[1][3], cloud.velocity[2][3]), 1e-4);
  EXPECT_NEAR(value("id", 3), 97, 1e-2);
  // What there is not: the first field.
  const Decoded frame = decoded(make_frame(0, 0, {cloud.snapshot()}, {}, {.fields = {{"fluid", "no such field"}}}));
  EXPECT_EQ(frame.header["blocks"][0]["field"], "pressure");
}

TEST(Frame, WhatIsNoNumberHasACodeOfItsOwn) {
  Cloud cloud(10);
  cloud.pressure[3] = std::nan("");
  cloud.pressure[4] = std::numeric_limits<double>::infinity();
  for (const int bits : {8, 16}) {
    const Decoded frame = decoded(make_frame(0, 0, {cloud.snapshot()}, {}, {.bits = bits}));
    const std::vector<double> values = frame.values(0, 10);
    EXPECT_TRUE(std::isnan(values[3]) && std::isnan(values[4]));
    EXPECT_NEAR(values[9], cloud.pressure[9], 1e-3);
  }
}

TEST(Frame, EqualValuesNoParticlesAndNoFieldsAreFrames) {
  Cloud cloud(10);
  std::fill(cloud.pressure.begin(), cloud.pressure.end(), 7.0);
  const Decoded equal = decoded(make_frame(0, 0, {cloud.snapshot()}, {}, {}));
  EXPECT_EQ(equal.values(0, 10)[5], 7);
  const Decoded none = decoded(make_frame(0, 0, {Cloud(0).snapshot()}, {}, {}));
  EXPECT_EQ(none.header["blocks"][0]["count"], 0);
  ParticleSnapshot bare = cloud.snapshot();
  bare.fields.clear();
  EXPECT_FALSE(decoded(make_frame(0, 0, {bare}, {}, {})).header["blocks"][0].contains("values"));
  EXPECT_TRUE(decoded(make_frame(0, 0, {}, {}, {})).header["blocks"].empty());
}

TEST(Frame, SizesAreDiameters) {
  const Cloud cloud(20);
  const Decoded frame = decoded(make_frame(0, 0, {cloud.snapshot("bubbles")}, {}, {}));
  const nlohmann::json& sizes = frame.header["blocks"][0]["sizes"];
  const auto codes = frame.codes<std::uint16_t>(sizes["at"], 20);
  const double largest = sizes["largest"];
  for (std::size_t i = 0; i < 20; ++i)
    EXPECT_NEAR(codes[i] / 65534.0 * largest, 2 * cloud.radius[i], step_of(0, largest, 65534));
}

TEST(Frame, IsThinnedToTheViewersBound) {
  const Cloud liquid(20000), few(50);
  for (const std::size_t bound : {0U, 1U, 100U, 5000U, 25000U}) {
    const Decoded frame =
        decoded(make_frame(0, 0, {liquid.snapshot(), few.snapshot("bubbles")}, {}, {.points = bound}));
    const std::size_t first = frame.header["blocks"][0]["count"], second = frame.header["blocks"][1]["count"];
    EXPECT_LE(first + second, bound);
    EXPECT_EQ(frame.header["blocks"][0]["total"], 20000);
    if (bound < 1000) continue;
    EXPECT_EQ(second, 50U);  // the small family leaves its share to the large one
    EXPECT_GT(static_cast<double>(first), 0.9 * static_cast<double>(std::min<std::size_t>(bound - 50, 20000)));
  }
  ParticleSnapshot nameless = liquid.snapshot();
  nameless.fields.erase(nameless.fields.begin() + 2);  // without identifiers
  EXPECT_EQ(decoded(make_frame(0, 0, {nameless}, {}, {.points = 300})).header["blocks"][0]["count"], 300);
}

// Otherwise the picture would flicker.
TEST(Frame, ThinnedFramesShowTheSameParticlesWhateverTheirOrder) {
  const auto shown = [](const Cloud& cloud) {
    const Decoded frame =
        decoded(make_frame(0, 0, {cloud.snapshot()}, {}, {.points = 500, .fields = {{"fluid", "id"}}}));
    std::set<long> ids;
    for (const double id : frame.values(0, frame.header["blocks"][0]["count"])) ids.insert(std::lround(id));
    return ids;
  };
  Cloud cloud(5000);
  const std::set<long> before = shown(cloud);
  std::reverse(cloud.id.begin(), cloud.id.end());
  EXPECT_EQ(shown(cloud), before);
  EXPECT_GT(before.size(), 400U);
}

TEST(Frame, APlaneCutsAGridWhereTheViewerWants) {
  const std::array<std::size_t, 3> points{4, 6, 8};
  std::vector<float> field(4 * 6 * 8);
  const auto value = [](std::size_t x, std::size_t y, std::size_t z) {
    return static_cast<float>(100 * x + 10 * y + z);
  };
  for (std::size_t x = 0; x < 4; ++x)
    for (std::size_t y = 0; y < 6; ++y)
      for (std::size_t z = 0; z < 8; ++z) field[(x * 6 + y) * 8 + z] = value(x, y, z);
  const GridSnapshot grid{"fluid", points, {0, 0, 0}, {0.25, 0.5, 1}, {{"pressure", {field.data()}}}};
  for (int axis = 0; axis < 3; ++axis) {
    const Decoded frame = decoded(make_frame(0, 0, {}, {grid}, {.plane_axis = axis, .plane_at = 1}));
    const nlohmann::json& block = frame.header["blocks"][0];
    EXPECT_EQ(block["kind"], "plane");
    const std::size_t across = block["axes"][0], along = block["axes"][1], normal = block["axes"][2];
    EXPECT_EQ(normal, static_cast<std::size_t>(axis));
    EXPECT_EQ(block["columns"], points[across]);
    EXPECT_EQ(block["rows"], points[along]);
    EXPECT_EQ(block["upper"][1], static_cast<double>(points[along]) * grid.spacing[along]);
    const std::vector<double> values = frame.values(0, points[across] * points[along]);
    std::array<std::size_t, 3> at{};
    at[normal] = points[normal] - 1;
    at[across] = 2;
    at[along] = 3;
    EXPECT_NEAR(values[3 * points[across] + 2], value(at[0], at[1], at[2]), 0.01);
  }
}

TEST(Frame, MemoryIsUsedAgainOnceAFrameIsSent) {
  const Cloud small(100), large(1000);
  FrameMaker frames;
  std::shared_ptr<const std::string> first = frames.make(1, 0, {large.snapshot()}, {}, {});
  const std::string kept = *first;
  const auto second = frames.make(2, 0, {small.snapshot()}, {}, {});
  EXPECT_NE(second, first);
  EXPECT_EQ(*first, kept);
  const std::string* const place = first.get();
  first.reset();
  const auto third = frames.make(3, 0, {small.snapshot()}, {}, {});
  EXPECT_EQ(third.get(), place);
  EXPECT_EQ(decoded(*third).header["step"], 3);
  EXPECT_EQ(third->size(), second->size());
}

TEST(Frame, AFieldIsComputedOnlyForWhoLooksAtIt) {
  const Cloud cloud(10);
  std::vector<double> late(10, 0.0);
  int computed = 0;
  ParticleSnapshot family = cloud.snapshot();
  family.fields.push_back({"dissipation", {late.data()}, {}, [&] {
                             ++computed;
                             std::fill(late.begin(), late.end(), 7.0);
                           }});
  make_frame(0, 0, {family}, {}, {});
  EXPECT_EQ(computed, 0);
  const Decoded frame = decoded(make_frame(0, 0, {family}, {}, {.fields = {{"fluid", "dissipation"}}}));
  EXPECT_EQ(computed, 1);
  EXPECT_EQ(frame.values(0, 10)[3], 7.0);
}

TEST(Frame, PhasesComeWhereTheyAreAskedFor) {
  const Cloud cloud(300);
  std::vector<std::int64_t> phase(300);
  for (std::size_t i = 0; i < 300; ++i) phase[i] = static_cast<std::int64_t>(i % 3);
  ParticleSnapshot family = cloud.snapshot();
  family.fields.push_back({"phase", {}, {phase.data()}});
  EXPECT_FALSE(decoded(make_frame(0, 0, {family}, {}, {})).header["blocks"][0].contains("phases"));
  const Decoded frame = decoded(make_frame(0, 0, {family}, {}, {.phases = true}));
  const std::vector<std::uint8_t> codes = frame.codes<std::uint8_t>(frame.header["blocks"][0]["phases"]["at"], 300);
  for (std::size_t i = 0; i < 300; ++i) EXPECT_EQ(codes[i], phase[i]);
}

TEST(Frame, AGridIsSentAsAWholeWhereItIsAskedFor) {
  std::vector<float> field(8 * 5 * 4);
  for (std::size_t k = 0; k < field.size(); ++k) field[k] = static_cast<float>(k);
  const GridSnapshot grid{"fluid", {8, 5, 4}, {1, 0, 0}, {0.25, 0.5, 1}, {{"pressure", {field.data()}}}};
  EXPECT_EQ(decoded(make_frame(0, 0, {}, {grid}, {})).header["blocks"].size(), 1U);
  const Decoded frame = decoded(make_frame(0, 0, {}, {grid}, {.volume = 4}));  // every second point of the longest side
  const nlohmann::json& block = frame.header["blocks"][1];
  EXPECT_EQ(block["kind"], "volume");
  EXPECT_THAT(block["points"], ElementsAre(4, 3, 2));
  EXPECT_THAT(block["spacing"], ElementsAre(0.5, 1.0, 2.0));
  EXPECT_THAT(block["wraps"], ElementsAre(true, false, true));  // of five points every second is no period
  const std::vector<double> values = frame.values(1, 24);
  for (std::size_t x = 0; x < 4; ++x)
    for (std::size_t y = 0; y < 3; ++y)
      for (std::size_t z = 0; z < 2; ++z)
        EXPECT_NEAR(values[(x * 3 + y) * 2 + z], field[(2 * x * 5 + 2 * y) * 4 + 2 * z], 0.01);
}

TEST(Frame, APickedParticleIsTheNearestAndThenFollowed) {
  Cloud cloud(500);
  FrameWish wish;
  wish.picked = PickWish{"fluid", {cloud.position[0][77] + 1e-9, cloud.position[1][77], cloud.position[2][77]}, {}};
  const nlohmann::json first = decoded(make_frame(0, 0, {cloud.snapshot()}, {}, wish)).header["picked"];
  EXPECT_EQ(first["index"], 77);
  EXPECT_EQ(first["id"], 500 - 77);
  EXPECT_EQ(first["values"][0]["name"], "pressure");
  EXPECT_EQ(first["values"][0]["values"][0], cloud.pressure[77]);
  EXPECT_EQ(first["values"][1]["values"][2], cloud.velocity[2][77]);
  wish.picked->id = 500 - 77;
  std::swap(cloud.id[77], cloud.id[3]);  // sorted elsewhere
  EXPECT_EQ(decoded(make_frame(0, 0, {cloud.snapshot()}, {}, wish)).header["picked"]["index"], 3);
  wish.picked->id = 1234;
  EXPECT_TRUE(decoded(make_frame(0, 0, {cloud.snapshot()}, {}, wish)).header["picked"].is_null());
  wish.picked->family = "none";
  EXPECT_TRUE(decoded(make_frame(0, 0, {cloud.snapshot()}, {}, wish)).header["picked"].is_null());
}

double value_of(const nlohmann::json& point, const std::string& name) {
  for (const nlohmann::json& one : point["values"])
    if (one["name"] == name) return one["value"].is_null() ? std::nan("") : one["value"].get<double>();
  ADD_FAILURE() << name;
  return 0;
}

// A mean with symmetric weights gives a linear field exactly where the particles lie symmetrically about the place.
TEST(Frame, ThePointOfALatticeHasTheValueOfALinearField) {
  std::vector<double> x, y, pressure;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) {
      x.push_back(0.1 * i), y.push_back(0.1 * j);
      pressure.push_back(3 * x.back() - 2 * y.back());
    }
  const ParticleSnapshot family{"fluid", x.size(), {x.data(), y.data()}, {{"pressure", {pressure.data()}, {}}}};
  FrameWish wish;
  wish.point = {0.75, 0.5, 0};
  const auto point = [&](double spacing) {
    return decoded(*FrameMaker().make(0, 0, {family}, {}, wish, spacing)).header["point"];
  };
  EXPECT_NEAR(value_of(point(0.1), "pressure"), 3 * 0.75 - 2 * 0.5, 1e-12);
  wish.point = {5, 5, 0};
  EXPECT_TRUE(std::isnan(value_of(point(0.1), "pressure")));
  wish.point = {0.31, 0.69, 0};
  EXPECT_NEAR(value_of(point(0), "pressure"), 3 * 0.3 - 2 * 0.7, 1e-12);  // the nearest
}

TEST(Frame, ThePointOfAGridIsInterpolatedAcrossItsPeriod) {
  std::vector<float> field(4 * 4 * 4);
  for (std::size_t x = 0; x < 4; ++x)
    for (std::size_t k = 0; k < 16; ++k) field[x * 16 + k] = static_cast<float>(x);
  GridSnapshot grid{"fluid", {4, 4, 4}, {0, 0, 0}, {1, 1, 1}, {{"pressure", {field.data()}}}};
  FrameWish wish;
  const auto at = [&](double x) {
    wish.point = {x, 0.5, 2.25};
    return value_of(decoded(make_frame(0, 0, {}, {grid}, wish)).header["point"], "pressure");
  };
  EXPECT_NEAR(at(1.25), 1.25, 1e-12);
  EXPECT_NEAR(at(3.5), 1.5, 1e-12);  // between the last, 3, and the first, 0
  EXPECT_NEAR(at(-0.5), 1.5, 1e-12);
  grid.periodic = false;
  EXPECT_NEAR(at(2.5), 2.5, 1e-12);
  EXPECT_TRUE(std::isnan(at(3.5)));
}

TEST(Frame, TwoRunsShareTheBoundOfTheViewer) {
  const Cloud one(3000), other(3000);
  const std::vector<ParticleSnapshot> left{one.snapshot()}, right{other.snapshot()};
  const std::vector<GridSnapshot> none;
  const Decoded frame = decoded(*FrameMaker().make(4, {{0.5, left, none, 0}, {0.6, right, none, 0}}, {.points = 2000}));
  ASSERT_EQ(frame.header["blocks"].size(), 2U);
  for (std::size_t side = 0; side < 2; ++side) {
    EXPECT_EQ(frame.header["blocks"][side]["side"], side);
    EXPECT_THAT(frame.header["blocks"][side]["count"].get<int>(), Le(1000));
  }
  EXPECT_EQ(frame.header["time"], 0.5);
  EXPECT_EQ(frame.header["beside"]["time"], 0.6);
}

TEST(Frame, AnyTextIsAFrame) {
  Cloud cloud(3);
  ParticleSnapshot family = cloud.snapshot("liquid \xff\"\\");
  EXPECT_NO_THROW(decoded(make_frame(0, 0, {family}, {}, {})));
}

}  // namespace
}  // namespace spume
