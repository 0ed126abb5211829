// SPDX-License-Identifier: MIT
// What the reader says about bad cases: keys, types, words, expressions, units, overrides, damaged texts.
#include <gmock/gmock.h>

#include <random>

#include "helpers.hpp"
#include "spume/physics/turbulence/options.hpp"

namespace spume {
namespace {

using test::CaseFile;
using test::load_text;
using test::plunging_breaker;
using test::problems_of;
using test::replaced;
using test::small_case;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

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

// Boxes and balls of liquid, of solids and of bodies are written differently.
TEST(Load, KeysOfOtherShapesGetTheirNameHere) {
  const std::string ball = "[[body]]\nshape = \"ball\"\nradius = 0.1\n", box = "[[body]]\nshape = \"box\"\n";
  EXPECT_THAT(problems_of(small_case(ball + "centre = [0.5, 0.5]\n")),
              ElementsAre("17:1 unknown key 'centre' in [[body]]; here it is 'position'"));
  EXPECT_THAT(problems_of(small_case(box + "size = [0.1, 0.1]\nlower = [0.5, 0.5]\n")),
              ElementsAre("17:1 unknown key 'lower' in [[body]]; here it is 'size', 'position'"));
  EXPECT_THAT(problems_of(small_case("position = [0.5, 0.5]\nradius = 0.3\n")),
              Contains("14:1 unknown key 'position' in [[liquid]]; here it is 'lower', 'upper', 'centre'"));
}

TEST(Load, AValueStandsForAListOfOneWhereThatIsPossible) {
  const std::string box = "[[body]]\nshape = \"box\"\nsize = [0.1, 0.1]\nposition = [0.5, 0.5]\n";
  EXPECT_THAT(problems_of(small_case(box + "rotation = 20\n[output]\nfields = \"velocity\"\n")), IsEmpty());
  EXPECT_EQ(load_text(small_case(box + "rotation = 20\n")).scene.bodies[0].shape->distance({0.6, 0.52, 0}),
            load_text(small_case(box + "rotation = [20]\n")).scene.bodies[0].shape->distance({0.6, 0.52, 0}));
  EXPECT_THAT(problems_of(small_case(box + "rotation = \"20\"\n")),
              ElementsAre(HasSubstr("body.0.rotation must be a number, found a string")));
  EXPECT_THAT(problems_of(small_case("[[body]]\nshape = \"box\"\nsize = 0.1\n")),
              ElementsAre(HasSubstr("body.0.size must be a list of numbers (length), found a number")));
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

TEST(Load, WordsAreOffered) {
  EXPECT_THAT(
      problems_of(small_case("[turbulence]\nmodel = \"smagorinski\"\n")),
      ElementsAre("15:9 turbulence.model must be \"none\", \"mixed-scale\", \"smagorinsky\", \"dynamic-shepard\" "
                  "or \"dynamic-lagrangian\", found \"smagorinski\"; did you mean \"smagorinsky\"?"));
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

// A liquid whose dynamic viscosity is its kinematic one has a thousandth of it.
TEST(Load, ViscositiesThatNoLiquidHasAreWarnedOf) {
  const auto warned = [](const std::string& fluid) {
    std::string texts;
    for (const Problem& one : load_text(small_case("", fluid)).options.warnings) texts += one.text + '\n';
    return texts;
  };
  const std::string oil = warned("density = 990\nviscosity = 4.5e-5\ngravity = 9.81\n");
  EXPECT_NE(oil.find("fluid.viscosity = 4.5e-05 Pa s is 4.54545e-08 m2/s at 990 kg/m3"), std::string::npos) << oil;
  EXPECT_EQ(warned("density = 990\nviscosity = 0.045\ngravity = 9.81\n"), "");
  EXPECT_EQ(warned("density = 13546\nviscosity = 1.53e-3\ngravity = 9.81\n"), "");  // mercury
  EXPECT_EQ(warned("density = 773\nviscosity = 6.6e-5\ngravity = 9.81\n"), "");     // carbon dioxide
  EXPECT_EQ(warned("density = 1000\nviscosity = 0\ngravity = 9.81\n"), "");
  EXPECT_EQ(warned("density = 1000\nviscosity = 1e-6\ngravity = 1\n"), "");  // in other units
}

TEST(Load, KeysOfTooManyPartsAreRefusedBeforeTheyExhaustTheStack) {
  std::string key = "a";
  for (int i = 1; i < 20'000; ++i) key += ".a";
  const std::string finding = "a key has more than 16 parts joined by dots; expected section.key, as in fluid.reynolds";
  for (const std::string& text : {key + " = 1\n", "[" + key + "]\n", "x = { " + key + " = 1 }\n", "[[" + key + "]]\n"})
    EXPECT_THAT(problems_of("# 1.2.3.4.5.6.7.8.9.10.11.12.13.14.15.16.17.18\n" + text),
                ElementsAre(testing::AllOf(testing::StartsWith("2:"), HasSubstr(finding))));
  EXPECT_THAT(problems_of(small_case(), {key + "=1"}), ElementsAre(HasSubstr(finding)));
  // Dots within strings and between values are none of a key's.
  EXPECT_EQ(load_text("title = \"" + key + "\"\n" + small_case()).options.title, key);
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
  EXPECT_EQ(loaded.options.get<TurbulenceOptions>().model, TurbulenceModel::smagorinsky);
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
  EXPECT_THAT(
      problems_of(small_case(), {"seed=18446744073709551616"}),
      ElementsAre("--set seed=18446744073709551616 seed must be an integer, found 18446744073709551616, beyond the "
                  "integers from -2^63 to 2^63 - 1"));
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
