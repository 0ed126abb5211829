// SPDX-License-Identifier: MIT
// Defaults, origins, and that a resolved case reads back to the same case.
#include <gmock/gmock.h>

#include <cstring>

#include "helpers.hpp"
#include "spume/methods/les_sph/options.hpp"
#include "spume/physics/turbulence/options.hpp"
#include "spume/scene/resolved_case.hpp"

namespace spume {
namespace {

using test::load_text;
using test::plunging_breaker;
using test::small_case;
using testing::HasSubstr;

TEST(ResolvedCase, VerifyIsKeptUnreadWithAllThatItHolds) {
  const std::string verify =
      "[verify]\nreference = \"reference/a.csv\"\n[[verify.bound]]\nname = \"phase\"\nlimit = 0.01\n"
      "[verify.run.\"two words\"]\nresolutions = [50, 100]\nwhen = 2026-01-02\n";
  const LoadedCase loaded = load_text(small_case(verify));
  EXPECT_THAT(loaded.options.resolved, HasSubstr("bound = [{ name = \"phase\", limit = 0.01 }]"));
  EXPECT_THAT(loaded.options.resolved, HasSubstr("[verify.run.\"two words\"]\n"));
}

// A resolved case without its comments.
std::string without_comments(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string line = text.substr(at, end - at);
    line.erase(std::min(line.rfind("  # "), line.size()));
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
    at = end + 1;
  }
  return out;
}

void expect_same(const LoadedCase& a, const LoadedCase& b) {
  EXPECT_EQ(without_comments(a.options.resolved), without_comments(b.options.resolved));
  EXPECT_EQ(a.options.title, b.options.title);
  EXPECT_EQ(a.options.groups, b.options.groups);
  EXPECT_EQ(a.scene.free_surface, b.scene.free_surface);
  EXPECT_EQ(a.scene.fluid.kinematic_viscosity, b.scene.fluid.kinematic_viscosity);
  EXPECT_EQ(a.options.time.courant, b.options.time.courant);
  EXPECT_EQ(a.options.probes.size(), b.options.probes.size());
  ASSERT_EQ(a.scene.particles.size(), b.scene.particles.size());
  for (int axis = 0; axis < a.scene.domain.dimensions; ++axis) {
    const std::size_t bytes = a.scene.particles.size() * sizeof(double);
    EXPECT_EQ(std::memcmp(a.scene.particles.position[axis].data(), b.scene.particles.position[axis].data(), bytes), 0);
    EXPECT_EQ(std::memcmp(a.scene.particles.velocity[axis].data(), b.scene.particles.velocity[axis].data(), bytes), 0);
  }
}

TEST(ResolvedCase, ReadsBackToTheSameCase) {
  const LoadedCase breaker =
      load_text(plunging_breaker, {"resolution.spacing=0.03", "initial.jitter=0.1", "seed=12", "title=say \"hi\" # 3\\",
                                   "fluid.reynolds=12345.678901234567"});
  expect_same(breaker, load_text(breaker.options.resolved));

  const LoadedCase tank = load_text(
      "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [2, 1]\nleft = \"no-slip\"\nbottom = \"no-slip\"\n"
      "[domain.wall_velocity]\nleft = [\"0.1*sin(t)\", 0]\n[resolution]\nspacing = 0.05\n[time]\nend = 1\n"
      "[fluid]\ndensity = 1e3\nviscosity = 1e-3\ngravity = 9.81\n[constants]\nh = 0.3\n"
      "[[solid]]\nlower = [1.2, 0]\nupper = [1.6, 0.3]\n[[liquid]]\nupper = [0.5, 0.5]\nlower = [0, 0]\n"
      "[[liquid]]\nlower = [0.5, 0]\nupper = [1, 0.9]\nwhere = \"h - y\"\n[forces]\nbody = [\"x\", 0]\n"
      "[[probe]]\nname = \"p\"\nposition = [1, 0.1]\n[[probe]]\nname = \"f\"\nkind = \"front\"\nheight = 0.1\n"
      "[output]\nfields = [\"pressure\"]\n[verify]\nlimit = 0.05\n[verify.\"a b\"]\nd = [1, 2.5, \"x\"]\n");
  expect_same(tank, load_text(tank.options.resolved));
  EXPECT_THAT(tank.options.resolved, HasSubstr("spacing = 0.05                            # case, m\n"));
  EXPECT_THAT(tank.options.groups.at("Reynolds"), HasSubstr("e+06"));
}

TEST(ResolvedCase, ThatIsReadAgainDiffersInNoValueAndKeepsItsOrigins) {
  const std::string first = load_text(plunging_breaker, {"time.courant=1e-1", "--until time.end=20"}).options.resolved;
  EXPECT_THAT(first, HasSubstr("end = 20                                  # --until, time"));
  EXPECT_THAT(first, HasSubstr("# --set"));
  EXPECT_THAT(first, HasSubstr("# default"));
  const std::string second = load_text(first).options.resolved;
  EXPECT_NE(second, first);
  EXPECT_TRUE(changed_values(first, second).empty());
  EXPECT_EQ(with_origins_of(first, second), first);
  const std::string edited = load_text(first, {"time.courant=0.3"}).options.resolved;
  const auto changes = changed_values(first, edited);
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0].name + ": " + changes[0].before + " to " + changes[0].now, "time.courant: 0.1 to 0.3");
  EXPECT_THAT(with_origins_of(first, load_text(edited).options.resolved), HasSubstr("# --until"));
}

TEST(ResolvedCase, DefaultsOfTheTableAreTheDefaultsOfTheCase) {
  const Case loaded = load_text(small_case()).options;
  const Case standard;
  EXPECT_EQ(loaded.seed, standard.seed);
  EXPECT_EQ(loaded.resolution.smoothing_ratio, standard.resolution.smoothing_ratio);
  EXPECT_EQ(loaded.resolution.kernel, standard.resolution.kernel);
  EXPECT_EQ(loaded.get<TurbulenceOptions>().model, TurbulenceOptions{}.model);
  EXPECT_EQ(loaded.get<TurbulenceOptions>().mixed_scale_constant, TurbulenceOptions{}.mixed_scale_constant);
  EXPECT_EQ(loaded.get<TurbulenceOptions>().smagorinsky_constant, TurbulenceOptions{}.smagorinsky_constant);
  EXPECT_EQ(loaded.get<PressureOptions>().solver, PressureOptions{}.solver);
  EXPECT_EQ(loaded.get<PressureOptions>().preconditioner, PressureOptions{}.preconditioner);
  EXPECT_EQ(loaded.get<PressureOptions>().precision, PressureOptions{}.precision);
  EXPECT_EQ(loaded.get<PressureOptions>().tolerance, PressureOptions{}.tolerance);
  EXPECT_EQ(loaded.get<PressureOptions>().max_iterations, PressureOptions{}.max_iterations);
  EXPECT_EQ(loaded.get<PressureOptions>().cell_ratio, PressureOptions{}.cell_ratio);
  EXPECT_EQ(loaded.get<PressureOptions>().warm_start, PressureOptions{}.warm_start);
  EXPECT_EQ(loaded.get<PressureOptions>().density_relaxation, PressureOptions{}.density_relaxation);
  EXPECT_EQ(loaded.get<ShiftingOptions>().on, ShiftingOptions{}.on);
  EXPECT_EQ(loaded.get<ShiftingOptions>().coefficient, ShiftingOptions{}.coefficient);
  EXPECT_EQ(loaded.get<ShiftingOptions>().limit, ShiftingOptions{}.limit);
  EXPECT_EQ(loaded.get<ShiftingOptions>().velocity_correction, ShiftingOptions{}.velocity_correction);
  EXPECT_EQ(loaded.get<SurfaceOptions>().threshold, SurfaceOptions{}.threshold);
  EXPECT_EQ(loaded.get<SurfaceOptions>().blend_width, SurfaceOptions{}.blend_width);
  EXPECT_EQ(loaded.get<SchemeOptions>().viscous, SchemeOptions{}.viscous);
  EXPECT_EQ(loaded.get<SchemeOptions>().centred, SchemeOptions{}.centred);
  EXPECT_EQ(loaded.time.max_step, standard.time.max_step);
  EXPECT_EQ(loaded.time.max_retries, standard.time.max_retries);
  EXPECT_EQ(loaded.output.every, standard.output.every);
  EXPECT_EQ(loaded.output.series_every, standard.output.series_every);
  EXPECT_EQ(loaded.output.checkpoint_every, standard.output.checkpoint_every);
  EXPECT_EQ(loaded.output.spectrum_every, standard.output.spectrum_every);
  EXPECT_EQ(loaded.output.fields, standard.output.fields);
  EXPECT_EQ(loaded.output.h5part_view, standard.output.h5part_view);
}

TEST(ResolvedCase, UnitsAreThoseThatGravityShowsOrThatTheCaseNames) {
  const std::string tank =
      "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [1, 1]\nleft = \"free-slip\"\nright = \"free-slip\"\n"
      "bottom = \"free-slip\"\n[resolution]\nspacing = 0.1\n[time]\nend = 1\n[[liquid]]\nupper = [1, 0.5]\n[fluid]\n"
      "density = 1000\nviscosity = 1e-3\n";
  const auto units = [&](const std::vector<std::string>& set) {
    const std::string text = load_text(tank, set).options.resolved;
    const std::size_t at = text.find("units = \"") + 9;
    return text.substr(at, text.find('"', at) - at);
  };
  EXPECT_EQ(units({"fluid.gravity=9.81"}), "SI");
  EXPECT_EQ(units({"fluid.gravity=981"}), "none");  // cm, g, s
  EXPECT_EQ(units({}), "none");
  EXPECT_EQ(units({"units=SI"}), "SI");
  EXPECT_EQ(units({"fluid.gravity=9.81", "units=none"}), "none");
  EXPECT_THAT(load_text(small_case()).options.resolved, HasSubstr("units = \"none\""));
}

TEST(ResolvedCase, TheCourantNumberOfACaseThatGivesNoneFollowsTheSurface) {
  const LoadedCase open = load_text(plunging_breaker);
  ASSERT_TRUE(open.scene.free_surface);
  EXPECT_EQ(open.options.time.courant, 0.3);
  EXPECT_THAT(open.options.resolved, HasSubstr("\ncourant = 0.3 "));
  const LoadedCase full = load_text(small_case());
  ASSERT_FALSE(full.scene.free_surface);
  EXPECT_EQ(full.options.time.courant, 0.2);
  EXPECT_EQ(load_text(plunging_breaker, {"time.courant=0.2"}).options.time.courant, 0.2);
}

}  // namespace
}  // namespace spume
