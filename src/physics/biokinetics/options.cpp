// SPDX-License-Identifier: MIT
#include "spume/physics/biokinetics/options.hpp"

#include <algorithm>
#include <utility>

#include "spume/physics/oxygen/options.hpp"
#include "spume/physics/scalars/options.hpp"
#include "spume/scene/document.hpp"
#include "spume/scene/option.hpp"

namespace spume {
namespace {

using P = biokinetics::Asm1Parameters;

bool looks_like_component(const std::string& name) {
  return name.size() > 2 && (name[0] == 'S' || name[0] == 'X') && name[1] == '_';
}

void refuse_unknown_components(const Draft& draft, const std::vector<std::string>& components, Problems& problems) {
  const std::vector<ScalarOption>& scalars = draft.options.get<ScalarOptions>().scalars;
  for (std::size_t k = 0; k < scalars.size(); ++k) {
    const Node* node = draft.node("scalar." + std::to_string(k) + ".name");
    if (node == nullptr || !looks_like_component(scalars[k].name) ||
        std::find(components.begin(), components.end(), scalars[k].name) != components.end())
      continue;
    std::string list;
    for (const std::string& name : components) list += (list.empty() ? "" : ", ") + name;
    problems.add(*node, "'" + scalars[k].name + "' is no component of biokinetics.model = \"asm1\", which has " + list +
                            "; rename it, a tracer begins with other letters");
  }
}

// Both have half-saturations here: left out, sludge would rest without a word.
void refuse_missing_nutrients(const Draft& draft, const Node& section, Problems& problems) {
  const std::vector<ScalarOption>& scalars = draft.options.get<ScalarOptions>().scalars;
  for (const auto& [name, usual] : {std::pair{"S_NH", "2 to 30 g/m3"}, {"S_ALK", "4 to 7 mol/m3"}})
    if (std::none_of(scalars.begin(), scalars.end(),
                     [&, name = name](const ScalarOption& one) { return one.name == name; }))
      problems.add(section, std::string("without ") + name + " nothing grows; add  [[scalar]]  with  name = \"" + name +
                                "\"  and its value at the start, " + usual);
}

void complete_parameters(const Draft& draft, BiokineticsOptions& options, Problems& problems) {
  options.parameters = P::at(options.temperature.value_or(draft.options.get<OxygenOptions>().temperature));
  options.parameters.k_nutrient = options.nutrient_half_saturation;
  options.parameters.k_alkalinity = options.alkalinity_half_saturation;
  for (std::size_t k = 0; k < options.given.size(); ++k)
    if (options.given[k]) options.parameters.*asm1_parameter_list()[k].value = *options.given[k];
  for (const char* key : {"y_a", "y_h"}) {
    const double value = key[2] == 'a' ? options.parameters.y_a : options.parameters.y_h;
    const std::string place = std::string("biokinetics.") + key;
    if (draft.node(place) != nullptr && !(value > 0 && value < 1))
      problems.add(*draft.node(place), place + " is " + brief(value) + "; a yield lies between 0 and 1; correct it");
  }
}

}  // namespace

const std::vector<Asm1ParameterInfo>& asm1_parameter_list() {
  static const std::vector<Asm1ParameterInfo> list{
      {"y_a", &P::y_a, "g COD/g N", "yield of autotrophs"},
      {"y_h", &P::y_h, "1", "yield of heterotrophs"},
      {"f_p", &P::f_p, "1", "share of decayed biomass that becomes inert products"},
      {"i_xb", &P::i_xb, "g N/g COD", "nitrogen of biomass"},
      {"i_xp", &P::i_xp, "g N/g COD", "nitrogen of inert products"},
      {"mu_h", &P::mu_h, "1/d", "growth of heterotrophs"},
      {"k_s", &P::k_s, "g COD/m3", "half-saturation of substrate"},
      {"k_oh", &P::k_oh, "g O2/m3", "half-saturation of oxygen, heterotrophs"},
      {"k_no", &P::k_no, "g N/m3", "half-saturation of nitrate"},
      {"b_h", &P::b_h, "1/d", "decay of heterotrophs"},
      {"eta_g", &P::eta_g, "1", "anoxic over aerobic growth"},
      {"eta_h", &P::eta_h, "1", "anoxic over aerobic hydrolysis"},
      {"k_h", &P::k_h, "1/d", "hydrolysis"},
      {"k_x", &P::k_x, "1", "half-saturation of hydrolysis"},
      {"mu_a", &P::mu_a, "1/d", "growth of autotrophs"},
      {"k_nh", &P::k_nh, "g N/m3", "half-saturation of ammonia, autotrophs"},
      {"k_oa", &P::k_oa, "g O2/m3", "half-saturation of oxygen, autotrophs"},
      {"b_a", &P::b_a, "1/d", "decay of autotrophs"},
      {"k_a", &P::k_a, "m3/(g COD d)", "ammonification"}};
  return list;
}

Section biokinetics_section() {
  using B = BiokineticsOptions;
  auto section = spume::section<B>("biokinetics");
  section
      .word(
          "model", &B::model, {{"asm1", BiokineticModel::asm1}},
          "reactions of the scalars; asm1: Activated Sludge Model No. 1, its 13 components are scalars, those that no "
          "[[scalar]] gives start at 0")
      .option("temperature", &B::temperature, "degrees C", between(0, 40), "temperature of the rates")
      .absent("oxygen.temperature")
      .option("nutrient_half_saturation", &B::nutrient_half_saturation, "g N/m3", above_up_to(0, 1),
              "ammonia at which growth of heterotrophs is halved for want of it; not in ASM1")
      .option("alkalinity_half_saturation", &B::alkalinity_half_saturation, "mol/m3", above_up_to(0, 1),
              "alkalinity at which growth is halved for want of it; not in ASM1")
      .option("tolerance", &B::tolerance, "1", between(1e-12, 1e-2), "error of a step of the reactions, relative")
      .option("interval", &B::interval, "time", not_negative(), "time between reactions; 0: they follow every step");
  const std::size_t count = asm1_parameter_list().size();
  for (std::size_t k = 0; k < count; ++k) {
    const Asm1ParameterInfo& info = asm1_parameter_list()[k];
    const auto place = [k, count](B& options) -> std::optional<double>& {
      options.given.resize(count);
      return options.given[k];
    };
    section.option(info.key, place, info.unit, not_negative(), info.description)
        .absent("benchmark plant, at the temperature");
  }
  section.whole_optional();
  return section;
}

void check_biokinetics(Draft& draft, Problems& problems) {
  BiokineticsOptions& options = draft.options.get<BiokineticsOptions>();
  const Node* section = draft.node("biokinetics");
  options.on = section != nullptr;
  if (!options.on) return;
  if (draft.node("oxygen") == nullptr)
    problems.add(*section,
                 "[biokinetics] takes up oxygen, and the case has no [oxygen]; add  [oxygen]  with what supplies it");
  complete_parameters(draft, options, problems);
  const std::vector<std::string> components = biokinetics::asm1_model({}).components;
  refuse_unknown_components(draft, components, problems);
  refuse_missing_nutrients(draft, *section, problems);
  options.scalars.clear();
  for (const std::string& name : components) {
    ScalarOption component;
    component.name = name;
    component.unit = name == "S_ALK" ? "mol/m3" : "g/m3";
    options.scalars.push_back(require_scalar(draft, component));
  }
  const OxygenOptions& oxygen = draft.options.get<OxygenOptions>();
  const Node* other = draft.node("oxygen.scalar");
  if (oxygen.on && other != nullptr && oxygen.scalar != components[biokinetics::asm1::s_o])
    problems.add(*other, "oxygen.scalar is " + to_toml_string(oxygen.scalar) +
                             ", and the oxygen of biokinetics.model = \"asm1\" is \"S_O\"; remove the key");
}

}  // namespace spume
