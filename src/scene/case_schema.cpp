// SPDX-License-Identifier: MIT
#include "spume/scene/case_schema.hpp"

#include <algorithm>
#include <stdexcept>

#include "scene_sections.hpp"

namespace spume {
namespace {

std::string article_free(std::string type) {
  for (const std::string article : {"an ", "a "})
    if (type.starts_with(article)) type.erase(0, article.size());
  if (const std::size_t bracket = type.find(" ("); bracket != std::string::npos) type.erase(bracket);
  return type;
}

OptionInfo info_of(const Section& section, const Option& option) {
  const Owners& owners = option.owners.all ? section.owners : option.owners;
  std::string names;
  for (const std::string& method : owners.names) names += (names.empty() ? "" : ", ") + method;
  std::string standard = option.default_text;
  if (option.required)
    standard = "(required)";
  else if (standard.empty())
    standard = "(" + option.absent + ")";
  return {option.section,
          option.key,
          article_free(type_in_words(option.type)),
          option.unit,
          standard,
          option.words.empty() ? option.range.in_words() : "one of " + words_in_words(option.words),
          option.description + (names.empty() ? "" : " [" + names + "]"),
          option.steerable};
}

bool declared_alike(const Option& a, const Option& b) {
  return a.type == b.type && a.unit == b.unit && a.default_text == b.default_text && a.absent == b.absent &&
         a.required == b.required && a.range.in_words() == b.range.in_words() && a.words == b.words &&
         a.description == b.description && a.needs.key == b.needs.key && a.steerable == b.steerable &&
         a.needs.words == b.needs.words;
}

}  // namespace

CaseSchema::CaseSchema(std::vector<MethodDeclaration> methods) : methods_(std::move(methods)) {
  sections_ = scene_sections();
  Option& choice = *std::find_if(sections_[0].options.begin(), sections_[0].options.end(),
                                 [](const Option& option) { return option.key == "method"; });
  std::string courant;
  for (const MethodDeclaration& method : methods_) {
    if (find(method.name) != &method) throw std::logic_error("two methods have the name '" + method.name + "'");
    choice.words.push_back(method.name);
    courant += (courant.empty() ? "" : "; ") + method.default_courant_in_words;
  }
  const std::vector<Section> run = run_sections(courant);
  const auto owners_of = [&](MethodProperty property) {
    Owners owners{false, {}};
    for (const MethodDeclaration& method : methods_)
      if (property == nullptr || property(method)) owners.names.push_back(method.name);
    return owners.names.size() == methods_.size() ? Owners{} : owners;
  };
  sections_.insert(sections_.end(), run.begin(), run.end());
  for (Section& section : sections_) {
    section.owners = owners_of(section.property);
    for (Option& option : section.options) option.owners = owners_of(option.property);
  }
  for (const MethodDeclaration& method : methods_)
    for (const Section& own : method.sections) add(own, method.name);
  for (Section& section : sections_)
    for (Option& option : section.options) {
      option.section = section.name;
      if (option.owners == section.owners) option.owners = {};
      // What no method takes is no option of this program; a case that gives it is told so.
      const Owners& owners = option.owners.all ? section.owners : option.owners;
      if (owners.all || !owners.names.empty()) table_.push_back(info_of(section, option));
    }
}

// A section of that name may be there already: the scene's own, or that of another method which names the same
// declaration.
void CaseSchema::add(const Section& own, const std::string& method) {
  auto present =
      std::find_if(sections_.begin(), sections_.end(), [&](const Section& one) { return one.name == own.name; });
  if (present == sections_.end()) {
    const auto at = own.after_output ? sections_.end()
                                     : std::find_if(sections_.begin(), sections_.end(),
                                                    [](const Section& one) { return one.name == "time"; });
    present = sections_.insert(at, own);
    present->owners = {false, {}};
    present->options.clear();
  }
  auto& names = present->owners.names;
  if (!present->owners.all && std::find(names.begin(), names.end(), method) == names.end()) names.push_back(method);
  if (own.compile) present->compile = own.compile;
  auto& options = present->options;
  auto at = std::find_if(options.begin(), options.end(), [&](const Option& option) { return option.key == own.after; });
  if (at != options.end()) ++at;
  for (const Option& option : own.options) {
    const auto same =
        std::find_if(options.begin(), options.end(), [&](const Option& one) { return one.key == option.key; });
    if (same == options.end()) {
      at = options.insert(at, option);
      at->owners = {false, {method}};
      ++at;
    } else if (declared_alike(*same, option) && !same->owners.all) {
      same->owners.names.push_back(method);
    } else {
      throw std::logic_error("'" + own.name + "." + option.key + "' is declared in two ways");
    }
  }
}

const MethodDeclaration* CaseSchema::find(const std::string& method) const {
  const auto found =
      std::find_if(methods_.begin(), methods_.end(), [&](const MethodDeclaration& one) { return one.name == method; });
  return found == methods_.end() ? nullptr : &*found;
}

std::string CaseSchema::method_of(const Node& document) const {
  const Node* node = document.find("method");
  return node && node->kind == Node::Kind::string && find(node->text) ? node->text : std::string{};
}

void CaseSchema::declare_groups(Case& options, const std::string& method) const {
  for (const MethodDeclaration& one : methods_)
    for (const Section& section : one.sections)
      if (section.declare && (method.empty() || one.name == method)) section.declare(options);
}

}  // namespace spume
