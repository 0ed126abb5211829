// SPDX-License-Identifier: MIT
// What the reader says about bad cases, and that good ones survive a round trip.
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <random>

#include "helpers.hpp"
#include "spume/scene/load.hpp"
#include "spume/scene/options.hpp"
#include "spume/scene/resolved_case.hpp"

namespace spume {
namespace {

using test::CaseFile;
using test::load_text;
using test::plunging_breaker;
using test::problems_of;
using test::small_case;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(Load, MissingMisspeltAndMistypedKeysAreReportedTogetherInFileOrder) {
  const std::string text =
      "method = \"les-sph\"\n"
      "[domain]\n"
      "lower = [0, 0]\n"
      "upper = [1, \"one\"]\n"
      "[resolution]\n"
      "spcaing = 0.1\n"
      "[time]\n"
      "end = 1\n"
      "courant = \"fast\"\n"
      "[fluid]\n"
      "reynolds = -3\n"
      "[[liquid]]\n";
  EXPECT_THAT(
      problems_of(text),
      ElementsAre("4:13 domain.upper[1] must be a number, found a string",
                  "5:1 missing key 'spacing' in [resolution]; add  spacing = <number>  # length, > 0",
                  "6:1 unknown key 'spcaing' in [resolution]; did you mean 'spacing'?",
                  "9:11 time.courant must be a number, found a string", "11:12 fluid.reynolds must be > 0, found -3"));
}

TEST(Load, ProblemsPrintAsClickablePlaces) {
  const CaseFile file("method = \"les-sph\"\nfluid = 3\n");
  try {
    load_case(file.path());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr(file.path() + ":2:1: error: 'fluid' must be a section [fluid], found an integer"));
    EXPECT_THAT(error.what(),
                HasSubstr(file.path() + ":1:1: error: missing key 'end' in [time]; add  end = <number>  # time, > 0"));
  }
}

TEST(Load, UnknownSectionsAndMisplacedKeysGetASuggestion) {
  EXPECT_THAT(problems_of(small_case("[turbulance]\nmodel = \"none\"\n")),
              ElementsAre("14:2 unknown section [turbulance]; did you mean 'turbulence'?"));
  EXPECT_THAT(problems_of(small_case("[pressure]\nspacing = 3\n")),
              ElementsAre("15:1 unknown key 'spacing' in [pressure]; 'spacing' belongs into [resolution]"));
  EXPECT_THAT(problems_of(small_case("[surface]\nqqqq = 3\n")),
              ElementsAre("15:1 unknown key 'qqqq' in [surface]; known keys: threshold, blend_width"));
  EXPECT_THAT(problems_of(small_case("where = 1\nwhre = 2\n")),
              ElementsAre("15:1 unknown key 'whre' in [[liquid]]; did you mean 'where'?"));
  EXPECT_THAT(problems_of("titel = \"a\"\n" + small_case()),
              ElementsAre("1:1 unknown key 'titel'; did you mean 'title'?"));
  EXPECT_THAT(problems_of(replaced(small_case(), "[[liquid]]", "[liquid]")),
              ElementsAre(HasSubstr("13:2 [liquid] must be written [[liquid]]")));
}

TEST(Load, WordsAreOfferedAndOtherMethodsRefusedInWords) {
  EXPECT_THAT(
      problems_of(small_case("[turbulence]\nmodel = \"smagorinski\"\n")),
      ElementsAre("15:9 turbulence.model must be \"none\", \"mixed-scale\", \"smagorinsky\", \"dynamic-shepard\" "
                  "or \"dynamic-lagrangian\", found \"smagorinski\"; did you mean \"smagorinsky\"?"));
  EXPECT_THAT(problems_of(replaced(small_case(), "les-sph", "gfd")),
              ElementsAre("1:10 method \"gfd\" is not available in this version; use \"les-sph\" or \"spectral\""));
}

TEST(Load, SyntaxErrorsHaveTheirPlace) {
  EXPECT_THAT(problems_of("method = \"les-sph\"\n[domain\n"), ElementsAre(HasSubstr("2:8 not valid TOML: ")));
  EXPECT_THAT(problems_of("a = 1\na = 2\n"), ElementsAre(HasSubstr("2:5 not valid TOML: ")));
}

TEST(Load, ExpressionFaultsPointIntoTheString) {
  EXPECT_THAT(problems_of(small_case("where = \"1 - etta\"\n[constants]\neta = 0.5\n")),
              ElementsAre("14:14 liquid.0.where: unknown name 'etta'; did you mean 'eta'?"));
  // An escape counts as written, and the second list entry has its own place.
  EXPECT_THAT(problems_of(small_case("velocity = [\"0\", \"1\\t+ (x\"]\n")),
              ElementsAre("14:24 liquid.0.velocity[1]: this '(' is never closed"));
  EXPECT_THAT(problems_of(small_case("where = '''\n1 -\n  q'''\n")),
              ElementsAre("16:3 liquid.0.where: unknown name 'q'; define it in [constants]"));
  EXPECT_THAT(problems_of(small_case("where = \"1 - z\"\n")),
              ElementsAre("14:14 liquid.0.where: z in a two-dimensional case; up is y"));
  EXPECT_THAT(problems_of(small_case("[constants]\na = \"b\"\nb = \"2*a\"\nc = true\n")),
              ElementsAre("15:6 constants.a: the constants a -> b -> a depend on each other",
                          "17:5 constants.c must be a number or an expression, found a boolean"));
  EXPECT_THAT(problems_of(small_case("[forces]\nbody = [\"sin(t)\", \"cos(\"]\n")),
              ElementsAre("15:23 forces.body[1]: this '(' is never closed"));
}

TEST(Load, GeometryThatCannotWorkIsRefusedWithTheFix) {
  EXPECT_THAT(problems_of(replaced(small_case(), "upper = [1, 1]", "upper = [1, -1]")),
              ElementsAre("4:9 domain.upper must lie above domain.lower: y runs from 0 to -1"));
  EXPECT_THAT(problems_of(replaced(small_case(), "upper = [1, 1]", "upper = [1, 1, 1]")),
              ElementsAre("4:9 domain.upper must have 2 entries in a 2-D domain, found 3"));
  EXPECT_THAT(problems_of(replaced(small_case(), "lower = [0, 0]", "lower = [0]")),
              ElementsAre("3:9 domain.lower must have 2 entries (2-D) or 3 (3-D), found 1"));
  EXPECT_THAT(problems_of(replaced(small_case(), "0.1", "1.5")),
              ElementsAre("8:11 resolution.spacing = 1.5 is larger than the domain, which is 1 long in x; set spacing "
                          "<= 0.1"));
  // 2 * 2.6 + 1 = 6.2 spacings.
  EXPECT_THAT(
      problems_of(replaced(small_case(), "upper = [1, 1]", "upper = [1, 0.6]")),
      ElementsAre("8:11 the periodic length in y, 0.6, is shorter than two kernel supports and a spacing, 0.62; "
                  "set spacing <= 0.0967 or lengthen the domain to 0.62"));
  EXPECT_THAT(
      problems_of(small_case(), {"resolution.kernel = quintic-spline", "resolution.smoothing_ratio=1.6"}),
      ElementsAre(HasSubstr("8:11 the periodic length in x, 1, is shorter than two kernel supports and a spacing, "
                            "1.06; set"),
                  HasSubstr("8:11 the periodic length in y")));
  const std::string walls = replaced(
      replaced(small_case(), "y = \"periodic\"", "bottom = \"no-slip\"\ntop = \"no-slip\""), "[1, 1]", "[1, 0.6]");
  EXPECT_THAT(problems_of(walls),
              ElementsAre(HasSubstr("the distance between the walls bottom and top, 0.6, is shorter")));
}

TEST(Load, SidesMustExistAndNotContradictEachOther) {
  EXPECT_THAT(
      problems_of(replaced(small_case(), "y = \"periodic\"", "y = \"periodic\"\ntop = \"no-slip\"\nback = \"open\"")),
      ElementsAre("7:1 domain.top is a side of the periodic direction y; remove one of the two",
                  "8:1 domain.back is a side of a 3-D domain; a 2-D one has left, right, bottom, top"));
  EXPECT_THAT(problems_of(replaced(small_case(), "y = \"periodic\"", "y = \"periodic\"\nz = \"periodic\"")),
              ElementsAre(HasSubstr("7:1 domain.z names a direction that a 2-D domain does not have")));
  EXPECT_THAT(problems_of(replaced(small_case(), "y = \"periodic\"", "top = \"periodic\"")),
              ElementsAre(HasSubstr("6:7 domain.top is one side; a periodic direction is written by its axis")));
}

TEST(Load, WallVelocityNeedsAWallAndOneExpressionPerDirection) {
  const std::string lid = replaced(small_case(), "y = \"periodic\"", "bottom = \"no-slip\"\ntop = \"no-slip\"") +
                          "[domain.wall_velocity]\n";
  EXPECT_THAT(problems_of(lid + "top = [\"1\"]\n"),
              ElementsAre("16:7 domain.wall_velocity.top must have 2 entries in a 2-D domain, found 1"));
  EXPECT_THAT(problems_of(lid + "left = [1, 0]\nfront = [1, 0]\n"),
              ElementsAre("16:1 domain.wall_velocity.left moves a side that is not a wall; add  left = \"no-slip\"  to "
                          "[domain]",
                          "17:1 domain.wall_velocity.front: a 2-D domain has left, right, bottom, top"));
  const LoadedCase loaded = load_text(lid + "top = [\"sin(t)\", 0]\nbottom = [0, 0]\n");
  const Side& top = loaded.scene.domain.sides[1][1];
  ASSERT_TRUE(top.velocity.has_value());
  EXPECT_DOUBLE_EQ((*top.velocity)({0, 0, 0}, 0.5)[0], std::sin(0.5));
  EXPECT_EQ(top.velocity->component[1], nullptr);
  EXPECT_FALSE(loaded.scene.domain.sides[1][0].velocity.has_value());
}

TEST(Load, SolidsRegionsAndProbesMustLieInTheDomain) {
  EXPECT_THAT(problems_of(small_case("lower = [0, 0]\nupper = [1, 1.2]\n")),
              ElementsAre("13:1 liquid.0 reaches outside the domain: y from 0 to 1.2, the domain's y from 0 to 1"));
  EXPECT_THAT(problems_of(small_case("centre = [0.5, 0.5]\n[[liquid]]\nradius = 0.1\n")),
              ElementsAre(HasSubstr("13:1 missing key 'radius'"), HasSubstr("15:1 missing key 'centre'")));
  EXPECT_THAT(problems_of(small_case("conform = true\n")),
              ElementsAre(HasSubstr("14:11 liquid.0.conform needs the surface")));
  EXPECT_THAT(problems_of(small_case("[[solid]]\nlower = [2, 0]\nupper = [3, 1]\n")),
              ElementsAre("14:1 solid.0 lies outside the domain: x from 2 to 3, the domain's x from 0 to 1"));
  EXPECT_THAT(
      problems_of(small_case("[[solid]]\nlower = [0.1, 0]\nupper = [0.7, 1]\n")),
      ElementsAre("14:1 solid.0 is 0.1 away from a periodic side in x, within the kernel support 0.26, and its mirror "
                  "images would end there; move the sides of the domain, or let the box span it"));
  EXPECT_THAT(
      problems_of(small_case("[[solid]]\nlower = [0.3, 0]\nupper = [0.7, 1]\n")),
      ElementsAre("14:1 solid.0 is 0.4 thick in x; the mirror images of its two faces would meet below two kernel "
                  "supports, 0.52: set spacing <= 0.0769 or thicken the box"));
  EXPECT_THAT(problems_of(small_case("[[probe]]\nname = \"a\"\nposition = [0.5, 3]\n"
                                     "[[probe]]\nname = \"a\"\nkind = \"front\"\naxis = \"y\"\n"
                                     "[[probe]]\nname = \"c\"\nkind = \"line\"\nposition = [0, 0]\n")),
              ElementsAre("16:12 probe.0.position lies outside the domain: y = 3, the domain's y from 0 to 1",
                          "18:8 another probe has the name 'a' already", "20:8 probe.1.axis must be horizontal: x",
                          "21:1 missing key 'end' in [[probe]]; add  end = [<x>, <y>]  # length"));
}

TEST(Load, EveryProbeHasItsOwnColumns) {
  const std::string at = "position = [0.5, 0.5]\n";
  EXPECT_THAT(problems_of(small_case("[[probe]]\nname = \"t\"\nkind = \"elevation\"\n" + at)),
              ElementsAre("15:8 its column 't' of probes.csv is that of the time already; choose another name"));
  const std::string point = "[[probe]]\nname = \"pt\"\n" + at;
  for (const std::string name : {"pt_pressure", "pt_velocity_x", "pt_velocity_y"}) {
    const std::string other = "[[probe]]\nname = \"" + name + "\"\nkind = \"front\"\n";
    EXPECT_THAT(
        problems_of(small_case(point + other)),
        ElementsAre("18:8 its column '" + name + "' of probes.csv is that of probe 'pt' already; choose another name"));
    EXPECT_THAT(problems_of(small_case(other + point)), testing::SizeIs(1));
  }
  // A point called t has no column t, and no z in two dimensions.
  EXPECT_THAT(problems_of(small_case("[[probe]]\nname = \"t\"\n" + at +
                                     "[[probe]]\nname = \"t_velocity_z\"\nkind = \"front\"\n")),
              IsEmpty());
}

TEST(Load, ATitleIsOneLine) {
  for (const std::string title : {"two\\nlines", "a\\u0007bell", "a\\u007f"})
    EXPECT_THAT(problems_of("title = \"" + title + "\"\n" + small_case()),
                ElementsAre("1:9 title has a line break or another control character; a title is one line of text"));
  EXPECT_THAT(problems_of("title = \"h\u00f6her\"\n" + small_case()), IsEmpty());
  const CaseFile file(small_case(), "two\nlines.toml");
  try {
    load_case(file.path());
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("the name of the case has a line break"));
  }
}

TEST(Load, TheStartDoesNotDependOnTime) {
  const std::string only = "; this describes the start and is a function of x and y only";
  EXPECT_THAT(problems_of(small_case("where = \"1 + t\"\n")),
              ElementsAre("14:14 liquid.0.where: unknown name 't'" + only));
  EXPECT_THAT(problems_of(small_case("velocity = [\"0\", \"x*t\"]\n")),
              ElementsAre("14:21 liquid.0.velocity[1]: unknown name 't'" + only));
  EXPECT_THAT(problems_of(small_case("where = \"1 + b\"\n[constants]\na = \"2*t\"\nb = \"1 + a\"\n")),
              ElementsAre("14:14 liquid.0.where: the constant 'b' depends on t" + only));
  EXPECT_THAT(problems_of(small_case("[forces]\nbody = [\"t\", \"sin(t)\"]\n")), IsEmpty());
}

TEST(Load, FluidTakesGroupsOrSiValuesButNotBoth) {
  EXPECT_THAT(
      problems_of(small_case("", "reynolds = 3\nviscosity = 1e-3\n")),
      ElementsAre("13:1 fluid.viscosity is an SI value and fluid.reynolds a group; give either reynolds, froude, "
                  "mach or density, viscosity, gravity, sound_speed"));
  EXPECT_THAT(problems_of(small_case("", "viscosity = 1e-3\n")),
              ElementsAre("11:1 missing key 'density' in [fluid]; add  density = <number>  # kg/m3, > 0"));
  const Fluid water =
      load_text(small_case("", "density = 1000\nviscosity = 1e-3\ngravity = 9.81\nsound_speed = 30\n")).scene.fluid;
  EXPECT_DOUBLE_EQ(water.density, 1000);
  EXPECT_DOUBLE_EQ(water.kinematic_viscosity, 1e-6);
  EXPECT_DOUBLE_EQ(water.gravity[1], -9.81);
  EXPECT_DOUBLE_EQ(water.sound_speed, 30);
  const Fluid groups = load_text(small_case("", "froude = 0.5\nmach = 0\n")).scene.fluid;
  EXPECT_DOUBLE_EQ(groups.density, 1);
  EXPECT_DOUBLE_EQ(groups.kinematic_viscosity, 0);
  EXPECT_DOUBLE_EQ(groups.gravity[1], -4);
  EXPECT_DOUBLE_EQ(groups.sound_speed, 0);
}

TEST(Load, OverridesReachEveryKeyAndReportThemselves) {
  const LoadedCase loaded = load_text(
      small_case("lower = [0, 0]\nupper = [1, 1]\n"),
      {"title=2024 run", "liquid.0.upper=[1, 0.5]", "liquid.1.where = y - 0.5", "liquid.0.velocity=[\"1\", \"y\"]",
       "domain.upper.1=1.0", "probe.0.name=gauge", "probe.0.kind=elevation", "probe.0.position=[0.5]", "constants.q=2",
       "turbulence.model=smagorinsky", "fluid.mach=0.1"});
  EXPECT_EQ(loaded.options.title, "2024 run");
  EXPECT_EQ(loaded.scene.particles.size(), 100u);
  EXPECT_EQ(loaded.scene.particles.velocity[0][0], 1.0);
  EXPECT_EQ(loaded.options.probes.at(0).kind, ProbeKind::elevation);
  EXPECT_EQ(loaded.options.turbulence.model, TurbulenceModel::smagorinsky);
  EXPECT_DOUBLE_EQ(loaded.scene.fluid.sound_speed, 10);
  EXPECT_THAT(loaded.options.resolved, HasSubstr("mach = 0.1                                # --set"));

  EXPECT_THAT(problems_of(small_case(),
                          {"fluid.mach=fast", "fluid.mahc=0.1", "nonsense", "liquid.3.where=1", "liquid.0.where=2*(x"}),
              testing::UnorderedElementsAre(
                  "--set fluid.mach=fast fluid.mach must be a number, found a string",
                  "--set fluid.mahc=0.1 unknown key 'mahc' in [fluid]; did you mean 'mach'?",
                  "--set nonsense expected section.key=value, for example --set fluid.mach=0.1",
                  "--set liquid.3.where=1 '3' is not an entry of 'liquid', which has 1 (the first is 0)",
                  "--set liquid.0.where=2*(x liquid.0.where: this '(' is never closed (character 3)"));
  EXPECT_THAT(problems_of(small_case(), {"title.x=1", "method.y=2"}), testing::SizeIs(1));
  EXPECT_THAT(problems_of(small_case(), {"time.end=0"}),
              ElementsAre("--set time.end=0 time.end must be > 0 (time), found 0"));
}

TEST(Load, CasesAreFoundByFileFolderAndName) {
  const CaseFile file(small_case(), "case.toml");
  EXPECT_EQ(load_case(file.folder()).options.path, file.path());
  EXPECT_EQ(load_case(file.path()).options.title, std::filesystem::path(file.folder()).filename().string());
  EXPECT_THROW(load_case("no_such_case"), InputError);
  EXPECT_THROW(load_case(std::filesystem::temp_directory_path().string()), InputError);
  EXPECT_THROW(load_case("/dev/null"), InputError);
  // A case that is there and cannot be reached, whoever asks: the name is a link to itself.
  const CaseFile looped(small_case());
  std::filesystem::create_symlink("case.toml", std::filesystem::path(looped.folder()) / "case.toml");
  try {
    load_case(looped.folder());
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("case.toml': Too many levels of symbolic links"));
  }

  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(file.folder());
  std::filesystem::create_directories("cases/breaking_wave");
  std::ofstream("cases/breaking_wave/case.toml") << small_case();
  EXPECT_EQ(load_case("breaking_wave").options.title, "breaking_wave");
  try {
    load_case("braking_wave");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("did you mean 'breaking_wave'?"));
  }
  std::filesystem::current_path(before);
}

TEST(Load, VerifyIsKeptUnreadWithAllThatItHolds) {
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

TEST(Load, ResolvedCaseReadsBackToTheSameCase) {
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

TEST(Load, AResolvedCaseThatIsReadAgainDiffersInNoValueAndKeepsItsOrigins) {
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

TEST(Load, DefaultsOfTheTableAreTheDefaultsOfTheCase) {
  const Case loaded = load_text(small_case()).options;
  const Case standard;
  EXPECT_EQ(loaded.seed, standard.seed);
  EXPECT_EQ(loaded.resolution.smoothing_ratio, standard.resolution.smoothing_ratio);
  EXPECT_EQ(loaded.resolution.kernel, standard.resolution.kernel);
  EXPECT_EQ(loaded.turbulence.model, standard.turbulence.model);
  EXPECT_EQ(loaded.turbulence.mixed_scale_constant, standard.turbulence.mixed_scale_constant);
  EXPECT_EQ(loaded.turbulence.smagorinsky_constant, standard.turbulence.smagorinsky_constant);
  EXPECT_EQ(loaded.pressure.solver, standard.pressure.solver);
  EXPECT_EQ(loaded.pressure.preconditioner, standard.pressure.preconditioner);
  EXPECT_EQ(loaded.pressure.precision, standard.pressure.precision);
  EXPECT_EQ(loaded.pressure.tolerance, standard.pressure.tolerance);
  EXPECT_EQ(loaded.pressure.max_iterations, standard.pressure.max_iterations);
  EXPECT_EQ(loaded.pressure.cell_ratio, standard.pressure.cell_ratio);
  EXPECT_EQ(loaded.pressure.warm_start, standard.pressure.warm_start);
  EXPECT_EQ(loaded.pressure.density_relaxation, standard.pressure.density_relaxation);
  EXPECT_EQ(loaded.shifting.on, standard.shifting.on);
  EXPECT_EQ(loaded.shifting.coefficient, standard.shifting.coefficient);
  EXPECT_EQ(loaded.shifting.limit, standard.shifting.limit);
  EXPECT_EQ(loaded.shifting.velocity_correction, standard.shifting.velocity_correction);
  EXPECT_EQ(loaded.surface.threshold, standard.surface.threshold);
  EXPECT_EQ(loaded.surface.blend_width, standard.surface.blend_width);
  EXPECT_EQ(loaded.time.viscous, standard.time.viscous);
  EXPECT_EQ(loaded.time.max_step, standard.time.max_step);
  EXPECT_EQ(loaded.time.max_retries, standard.time.max_retries);
  EXPECT_EQ(loaded.output.every, standard.output.every);
  EXPECT_EQ(loaded.output.series_every, standard.output.series_every);
  EXPECT_EQ(loaded.output.checkpoint_every, standard.output.checkpoint_every);
  EXPECT_EQ(loaded.output.spectrum_every, standard.output.spectrum_every);
  EXPECT_EQ(loaded.output.fields, standard.output.fields);
  EXPECT_EQ(loaded.output.h5part_view, standard.output.h5part_view);
}

TEST(Load, TheCourantNumberOfACaseThatGivesNoneFollowsTheSurface) {
  const LoadedCase open = load_text(plunging_breaker);
  ASSERT_TRUE(open.scene.free_surface);
  EXPECT_EQ(open.options.time.courant, 0.3);
  EXPECT_THAT(open.options.resolved, HasSubstr("\ncourant = 0.3 "));
  const LoadedCase full = load_text(small_case());
  ASSERT_FALSE(full.scene.free_surface);
  EXPECT_EQ(full.options.time.courant, 0.2);
  EXPECT_EQ(load_text(plunging_breaker, {"time.courant=0.2"}).options.time.courant, 0.2);
}

TEST(Load, SidesOfAThreeDimensionalDomainAreNamedAfterTheirAxis) {
  const LoadedCase loaded = load_text(
      "method = \"les-sph\"\n[domain]\nlower = [0, 0, 0]\nupper = [1, 1, 1]\nleft = \"free-slip\"\n"
      "back = \"no-slip\"\ntop = \"no-slip\"\n[domain.wall_velocity]\nback = [\"z\", 0, 0]\n"
      "[resolution]\nspacing = 0.1\n[time]\nend = 1\n[fluid]\nfroude = 2\n[[liquid]]\n");
  const auto& sides = loaded.scene.domain.sides;
  EXPECT_EQ(sides[0][0].kind, BoundaryKind::free_slip);
  EXPECT_EQ(sides[0][1].kind, BoundaryKind::open);
  EXPECT_EQ(sides[1][0].kind, BoundaryKind::open);
  EXPECT_EQ(sides[1][1].kind, BoundaryKind::no_slip);
  EXPECT_EQ(sides[2][0].kind, BoundaryKind::open);
  EXPECT_EQ(sides[2][1].kind, BoundaryKind::no_slip);
  EXPECT_EQ((*sides[1][1].velocity)({0, 0, 0.5}, 0), (Vec3{0.5, 0, 0}));
  EXPECT_EQ(loaded.scene.fluid.gravity, (Vec3{0, 0, -0.25}));
}

TEST(Load, DamagedOverridesNeverCrash) {
  std::mt19937 random(3);
  const std::string letters = "fluidmach.0123=[]{}\"' \n#,-domainsolidprobeliquidupper";
  for (int i = 0; i < 2000; ++i) {
    std::string assignment =
        i % 2 ? "" : std::vector<std::string>{"liquid.", "domain.", "probe.", "time"}[random() % 4];
    for (unsigned n = random() % 16; n > 0; --n) assignment += letters[random() % letters.size()];
    try {
      load_text(small_case(), {assignment});
    } catch (const InputError& error) {
      for (const Problem& problem : error.problems()) ASSERT_NE(problem.text, "") << assignment;
    }
  }
}

TEST(Load, EveryOptionIsDescribed) {
  ASSERT_GT(option_table().size(), 60u);
  for (const OptionInfo& option : option_table()) {
    EXPECT_NE(option.description, "") << option.section << '.' << option.key;
    EXPECT_NE(option.default_text, "()") << option.section << '.' << option.key;
    EXPECT_NE(option.type, "") << option.section << '.' << option.key;
  }
}

TEST(Load, DamagedFilesGiveProblemsAndNeverCrash) {
  std::mt19937 random(2);
  const std::string source = plunging_breaker;
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    std::string text = source;
    for (unsigned n = 1 + random() % 4; n > 0; --n) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text[at] = static_cast<char>(random() % 256);
          break;
        case 1:
          text.erase(at, random() % 20);
          break;
        case 2:
          text.insert(at, text.substr(random() % text.size(), random() % 30));
          break;
        default:
          text.resize(at + 1);
      }
    }
    // Only the reader is under test: a spacing that the damage made tiny would fill for minutes.
    try {
      load_text(text, {"resolution.spacing=0.04"});
    } catch (const InputError& error) {
      ++refused;
      ASSERT_FALSE(error.problems().empty());
      for (const Problem& problem : error.problems()) ASSERT_NE(problem.text, "");
    }
  }
  EXPECT_GT(refused, 200);
  for (const std::string text :
       {"", "\n\n", "\xEF\xBB\xBF", "[[liquid]]\n[[liquid]]\n", "liquid = [1, 2]\nprobe = [[]]\n",
        "domain = []\nfluid = \"x\"\nsolid = {}\n", "[verify]\n[constants]\n"}) {
    EXPECT_THAT(problems_of(text), testing::Not(IsEmpty())) << text;
  }
}

}  // namespace
}  // namespace spume
