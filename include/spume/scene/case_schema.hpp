// SPDX-License-Identifier: MIT
// The schema of case files: the sections of the scene and of all methods that are handed in, in the order in which
// `spume options` and the resolved case list them.
#pragma once

#include <string>
#include <vector>

#include "spume/scene/method_declaration.hpp"
#include "spume/scene/options.hpp"

namespace spume {

class CaseSchema {
 public:
  // Throws std::logic_error for two methods of one name and for two different declarations of one option.
  explicit CaseSchema(std::vector<MethodDeclaration> methods);

  const std::vector<Section>& sections() const { return sections_; }
  const std::vector<MethodDeclaration>& methods() const { return methods_; }
  const std::vector<OptionInfo>& option_table() const { return table_; }

  // The method of that name, or null.
  const MethodDeclaration* find(const std::string& method) const;
  // The method that a document names; empty when it names none that exists.
  std::string method_of(const Node& document) const;
  // Makes the groups of options of the method; without a method those of all.
  void declare_groups(Case& options, const std::string& method) const;

 private:
  void add(const Section& own, const std::string& method);

  std::vector<MethodDeclaration> methods_;
  std::vector<Section> sections_;
  std::vector<OptionInfo> table_;
};

}  // namespace spume
