// SPDX-License-Identifier: MIT
// The schema with methods that are registered here: options of their own, shared ones, checks, and properties.
#include <gmock/gmock.h>

#include "helpers.hpp"
#include "spume/scene/case_schema.hpp"
#include "spume/scene/load.hpp"

namespace spume {
namespace {

using test::CaseFile;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;

enum class Scheme { explicit_euler, implicit_euler };

struct HeatOptions {
  double conductivity = 0.25;
  int sweeps = 3;
  bool isolated = true;
  Scheme scheme = Scheme::implicit_euler;
};

struct StepOptions {
  double diffusive = 1;
};

struct ColdOptions {
  double sink = 0;
};

Section heat_section() {
  using H = HeatOptions;
  return section<H>("heat")
      .option("conductivity", &H::conductivity, "W/m/K", positive(), "of the material")
      .word("scheme", &H::scheme, {{"explicit", Scheme::explicit_euler}, {"implicit", Scheme::implicit_euler}},
            "in time")
      .option("sweeps", &H::sweeps, "", between(1, 9), "of the solver")
      .when("scheme", {"implicit"})
      .option("isolated", &H::isolated, "nothing passes the sides");
}

MethodDeclaration particles_method(const std::string& name) {
  MethodDeclaration method;
  method.name = name;
  method.fills_regions = true;
  method.sections = {heat_section()};
  method.bytes_per_particle = [](const Draft&) { return 100.0; };
  method.default_courant = [](const Case&, const Scene& scene) { return scene.free_surface ? 0.4 : 0.1; };
  method.default_courant_in_words = "0.1, " + name + " 0.4";
  method.output_fields = [](const Case&) { return std::vector<OutputFieldInfo>{{"temperature"}}; };
  method.probe_scalars = [](const Case&) { return std::vector<ProbeScalar>{{"temperature", "K"}}; };
  return method;
}

// "warm" and "cold" share [heat]; "cold" adds to [time] and has [sink]; "box" lives on a grid.
CaseSchema three_methods() {
  MethodDeclaration cold = particles_method("cold"), box = particles_method("box");
  cold.sections.push_back(
      section<StepOptions>("time").behind("end").option("diffusive", &StepOptions::diffusive, "1", "step limit"));
  cold.sections.push_back(section<ColdOptions>("sink").option("sink", &ColdOptions::sink, "W", "heat taken"));
  cold.check = [](Draft& draft, Problems& problems) {
    if (draft.options.get<ColdOptions>().sink < 0) problems.add(*draft.node("sink.sink"), "sink.sink gives heat");
  };
  cold.check_scene = [](const Draft& draft, const Scene& scene, Problems& problems) {
    if (scene.particles.size() > 200) problems.add(*draft.node("resolution.spacing"), "too many to cool");
  };
  box.fills_regions = false;
  box.uses_grid = true;
  box.sections.clear();
  return CaseSchema({particles_method("warm"), cold, box});
}

std::string small(const std::string& method, const std::string& rest) {
  return "method = \"" + method +
         "\"\n[domain]\nlower = [0, 0]\nupper = [1, 1]\nx = \"periodic\"\ny = \"periodic\"\n"
         "[resolution]\nspacing = 0.1\n[fluid]\nreynolds = 1\n[[liquid]]\n[time]\nend = 1\n" +
         rest;
}

LoadedCase load(const CaseSchema& schema, const std::string& text) {
  const CaseFile file(text);
  return load_case(file.path(), {}, schema);
}

std::vector<std::string> problems(const CaseSchema& schema, const std::string& text) {
  std::vector<std::string> found;
  try {
    load(schema, text);
  } catch (const InputError& error) {
    for (const Problem& problem : error.problems()) found.push_back(problem.text);
  }
  return found;
}

const OptionInfo& row(const CaseSchema& schema, const std::string& section, const std::string& key) {
  for (const OptionInfo& option : schema.option_table())
    if (option.section == section && option.key == key) return option;
  throw std::out_of_range(section + "." + key);
}

TEST(Schema, TypeAndDefaultOfAnOptionAreThoseOfItsMember) {
  const CaseSchema schema = three_methods();
  EXPECT_EQ(row(schema, "heat", "conductivity").default_text, "0.25");
  EXPECT_EQ(row(schema, "heat", "conductivity").type, "number");
  EXPECT_EQ(row(schema, "heat", "sweeps").default_text, "3");
  EXPECT_EQ(row(schema, "heat", "sweeps").type, "integer");
  EXPECT_EQ(row(schema, "heat", "isolated").default_text, "true");
  EXPECT_EQ(row(schema, "heat", "scheme").default_text, "\"implicit\"");
  EXPECT_EQ(row(schema, "heat", "scheme").range, "one of \"explicit\" or \"implicit\"");
  const HeatOptions standard = load(schema, small("warm", "")).options.get<HeatOptions>();
  EXPECT_EQ(standard.conductivity, HeatOptions{}.conductivity);
  EXPECT_EQ(standard.sweeps, HeatOptions{}.sweeps);
  EXPECT_EQ(standard.isolated, HeatOptions{}.isolated);
  EXPECT_EQ(standard.scheme, HeatOptions{}.scheme);
  const LoadedCase given =
      load(schema, small("cold", "[heat]\nconductivity = 2\nsweeps = 4\nisolated = false\nscheme = \"explicit\"\n"));
  EXPECT_EQ(given.options.get<HeatOptions>().conductivity, 2);
  EXPECT_EQ(given.options.get<HeatOptions>().sweeps, 4);
  EXPECT_FALSE(given.options.get<HeatOptions>().isolated);
  EXPECT_EQ(given.options.get<HeatOptions>().scheme, Scheme::explicit_euler);
  ASSERT_EQ(given.options.warnings.size(), 1u);
  EXPECT_THAT(given.options.warnings[0].text, HasSubstr("heat.sweeps is not used with heat.scheme"));
}

TEST(Schema, MethodsShareADeclarationAndAddToSectionsOfTheScene) {
  const CaseSchema schema = three_methods();
  EXPECT_THAT(row(schema, "heat", "sweeps").description, testing::EndsWith(" [warm, cold]"));
  EXPECT_THAT(row(schema, "time", "diffusive").description, testing::EndsWith(" [cold]"));
  EXPECT_THAT(row(schema, "resolution", "spacing").description, testing::EndsWith(" [warm, cold]"));
  EXPECT_THAT(row(schema, "resolution", "grid").description, testing::EndsWith(" [box]"));
  std::vector<std::string> keys, order;
  for (const OptionInfo& option : schema.option_table()) {
    if (option.section == "time") keys.push_back(option.key);
    if (order.empty() || order.back() != option.section) order.push_back(option.section);
  }
  EXPECT_THAT(keys, ElementsAre("end", "diffusive", "courant", "max_step", "max_retries"));
  EXPECT_THAT(std::vector(order.end() - 6, order.end()),
              ElementsAre("heat", "sink", "time", "output", "probe", "verify"));
  EXPECT_THAT(
      problems(schema, small("warm", "diffusive = 2\n[sink]\nsink = 1\n")),
      ElementsAre("time.diffusive belongs to method \"cold\", and this case is of method \"warm\"; remove it",
                  "[sink] belongs to method \"cold\", and this case is of method \"warm\"; remove the section"));
  EXPECT_EQ(load(schema, small("cold", "diffusive = 2\n")).options.get<StepOptions>().diffusive, 2);
}

TEST(Schema, GroupsThatTheMethodDoesNotDeclareAreAFaultOfTheProgram) {
  const Case options = load(three_methods(), small("warm", "")).options;
  EXPECT_NO_THROW(options.get<HeatOptions>());
  EXPECT_THROW(options.get<ColdOptions>(), std::logic_error);
}

TEST(Schema, TheMethodChecksItsCaseAndItsScene) {
  const CaseSchema schema = three_methods();
  EXPECT_THAT(problems(schema, small("cold", "[sink]\nsink = -1\n")), ElementsAre("sink.sink gives heat"));
  EXPECT_THAT(problems(schema, test::replaced(small("cold", ""), "0.1", "0.05")), ElementsAre("too many to cool"));
  EXPECT_THAT(problems(schema, small("warm", "[output]\nfields = [\"temperature\", \"heat\"]\n")),
              ElementsAre("output.fields names 'heat', which method \"warm\" does not have; it has temperature"));
  EXPECT_THAT(problems(schema, small("lukewarm", "")),
              ElementsAre("method must be \"warm\", \"cold\" or \"box\", found \"lukewarm\""));
}

TEST(Schema, TheMethodNamesTheScalarsOfProbes) {
  const CaseSchema schema = three_methods();
  const std::string point = "[[probe]]\nname = \"p\"\nposition = [0.5, 0.5]\n";
  const auto front = [](const std::string& name) { return "[[probe]]\nname = \"" + name + "\"\nkind = \"front\"\n"; };
  const LoadedCase loaded = load(schema, small("warm", point + front("p_pressure")));
  ASSERT_EQ(loaded.probe_scalars.size(), 1U);
  EXPECT_EQ(loaded.probe_scalars[0].name, "temperature");
  EXPECT_EQ(loaded.probe_scalars[0].unit, "K");
  EXPECT_THAT(
      problems(schema, small("warm", point + front("p_temperature"))),
      ElementsAre("its column 'p_temperature' of probes.csv is that of probe 'p' already; choose another name"));
}

TEST(Schema, TheMethodGivesCourantNumberAndMemory) {
  const CaseSchema schema = three_methods();
  EXPECT_EQ(row(schema, "time", "courant").default_text, "(0.1, warm 0.4; 0.1, cold 0.4; 0.1, box 0.4)");
  const LoadedCase full = load(schema, small("warm", ""));
  EXPECT_EQ(full.options.time.courant, 0.1);
  EXPECT_EQ(full.bytes_per_particle, 100);
  EXPECT_THAT(full.options.resolved, HasSubstr("\ncourant = 0.1 "));
  EXPECT_EQ(load(schema, test::replaced(small("warm", ""), "y = \"periodic\"\n", "")).options.time.courant, 0.4);
}

TEST(Schema, ContradictingRegistrationsAreRefused) {
  EXPECT_THROW(CaseSchema({particles_method("warm"), particles_method("warm")}), std::logic_error);
  MethodDeclaration other = particles_method("other");
  other.sections[0].options[0].description = "of something else";
  EXPECT_THROW(CaseSchema({particles_method("warm"), other}), std::logic_error);
}

// The names of the methods are data here: whoever needs one asks the registry, and a new method edits none of these.
TEST(Schema, NoFileBelowOrAboveTheMethodsNamesOne) {
  namespace fs = std::filesystem;
  std::size_t files = 0;
  for (const std::string folder :
       {"src/scene", "src/run", "src/cli", "include/spume/scene", "include/spume/run", "include/spume/cli"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(SPUME_SOURCE_DIR) / folder)) {
      if (!entry.is_regular_file()) continue;
      ++files;
      std::ifstream in(entry.path());
      const std::string text{std::istreambuf_iterator<char>(in), {}};
      for (const Registration& method : registered_methods()) {
        std::string word;
        for (const char c : method.name) word += c == '-' || c == '_' ? std::string("[-_]") : std::string(1, c);
        EXPECT_FALSE(testing::Matches(ContainsRegex("\\b" + word + "\\b"))(text)) << entry.path() << " names " << word;
      }
    }
  EXPECT_GT(files, 40u);
}

}  // namespace
}  // namespace spume
