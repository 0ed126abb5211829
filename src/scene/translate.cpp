// SPDX-License-Identifier: MIT
#include "translate.hpp"

#include <algorithm>
#include <initializer_list>
#include <optional>

#include "reader.hpp"

namespace spume {
namespace {

const char* const phase_name = "liquid";

// An empty node where another stands, given by whom that was.
Node node_at(const Node& at, Node::Kind kind = Node::Kind::table) {
  Node node;
  node.kind = kind;
  node.place = at.place;
  node.key_place = at.key_place;
  node.override_text = at.override_text;
  return node;
}

Node text_node(const std::string& text, const Node& at) {
  Node node = node_at(at, Node::Kind::string);
  node.text = text;
  return node;
}

Node number_node(double number, const Node& at) {
  Node node = node_at(at, Node::Kind::number);
  node.number = number;
  return node;
}

void erase(Node& table, const std::string& key) {
  const auto found = std::find(table.keys.begin(), table.keys.end(), key);
  if (found == table.keys.end()) return;
  table.children.erase(table.children.begin() + (found - table.keys.begin()));
  table.keys.erase(found);
}

// A number above zero or, of a key that is absent, `absent`; nothing for anything else.
std::optional<double> positive_of(const Node& table, const char* key, double absent) {
  const Node* node = table.find(key);
  if (node == nullptr) return absent;
  return node->is_number() && node->number > 0 ? std::optional(node->number) : std::nullopt;
}

bool has_any(const Node& table, std::initializer_list<const char*> keys) {
  return std::any_of(keys.begin(), keys.end(), [&](const char* key) { return table.find(key) != nullptr; });
}

std::vector<double> numbers_of(const Node* list) {
  std::vector<double> numbers;
  if (list == nullptr || list->kind != Node::Kind::array) return numbers;
  for (const Node& entry : list->children)
    if (entry.is_number()) numbers.push_back(entry.number);
  return numbers;
}

bool holds_tables(const Node* list) {
  return list != nullptr && list->kind == Node::Kind::array && !list->children.empty() &&
         std::all_of(list->children.begin(), list->children.end(),
                     [](const Node& entry) { return entry.kind == Node::Kind::table; });
}

class Translator {
 public:
  Translator(Node& document, const CaseSchema& schema, const MethodDeclaration& method, const std::string& file)
      : document_(document), schema_(schema), method_(method), file_(file) {}

  Translation run() {
    const bool liquids = document_.find("liquid") != nullptr;
    const bool phases = document_.find("phase") != nullptr || document_.find("region") != nullptr;
    if (method_.fills_phases && liquids && !phases) fluid_to_phase();
    if (method_.fills_regions && phases && !liquids) phase_to_fluid();
    if (!method_.honours_solids) solids_to_bodies();
    leave_behind();
    return std::move(made_);
  }

 private:
  void warn(const Node& key, const std::string& text) {
    made_.warnings.push_back({file_, key.key_place.line > 0 ? key.key_place.line : key.place.line,
                              key.key_place.line > 0 ? key.key_place.column : key.place.column, text});
  }
  std::string without() const { return " is not used by method \"" + method_.name + "\""; }

  void drop(Node& table, const char* key, const std::string& name, const std::string& reason) {
    const Node* node = table.find(key);
    if (node == nullptr) return;
    warn(*node, name + "." + key + without() + reason);
    erase(table, key);
  }

  void fluid_to_phase() {
    Node* liquids = document_.find("liquid");
    Node* fluid = document_.find("fluid");
    if (!holds_tables(liquids) || (fluid != nullptr && fluid->kind != Node::Kind::table)) return;
    const Node none;
    const Node& given = fluid != nullptr ? *fluid : none;
    // What [fluid] itself would be refused for is left for the reader: a mixture of values and groups, values without a
    // density, groups that are not above zero.
    const bool groups = has_any(given, {"reynolds", "froude", "mach"});
    const bool si = has_any(given, {"density", "viscosity", "gravity", "sound_speed"});
    const auto reynolds = positive_of(given, "reynolds", 0), froude = positive_of(given, "froude", 0);
    if ((groups && si) || (si && given.find("density") == nullptr) || !reynolds || !froude) return;
    Node phase = node_at(fluid != nullptr ? *fluid : liquids->children.front());
    phase.insert("name", text_node(phase_name, phase));
    const auto copied = [&](const char* key, double absent) {
      const Node* value = given.find(key);
      return value != nullptr ? *value : number_node(absent, phase);
    };
    phase.insert("density", copied("density", 1));
    phase.insert("viscosity", copied("viscosity", *reynolds > 0 ? 1 / *reynolds : 0));
    Node list = node_at(phase, Node::Kind::array);
    list.children.push_back(std::move(phase));
    if (fluid != nullptr) {
      for (const char* key : {"sound_speed", "mach"})
        drop(*fluid, key, "fluid", ", which has its own sound speed or none");
      for (const char* key : {"density", "viscosity", "reynolds"}) erase(*fluid, key);
    }
    made_.groups = !si;
    Node regions = *liquids;
    for (std::size_t k = 0; k < regions.children.size(); ++k) {
      Node& region = regions.children[k];
      drop(region, "conform", "liquid." + std::to_string(k), "; the surface has steps of a particle");
      region.insert("phase", text_node(phase_name, region));
    }
    erase(document_, "liquid");
    document_.insert("phase", std::move(list));
    document_.insert("region", std::move(regions));
  }

  // Several phases are left for the reader to refuse.
  void phase_to_fluid() {
    Node *phases = document_.find("phase"), *regions = document_.find("region");
    if (!holds_tables(phases) || !holds_tables(regions) || phases->children.size() != 1) return;
    Node phase = phases->children.front();
    for (const char* key : {"sound_speed", "exponent"}) drop(phase, key, "phase.0", "");
    Node* present = document_.find("fluid");
    if (present == nullptr) present = &document_.insert("fluid", node_at(phase));
    if (present->kind != Node::Kind::table) return;
    fluid_of(phase, *present);
    Node liquids = *document_.find("region");
    for (Node& liquid : liquids.children) erase(liquid, "phase");
    for (const char* key : {"phase", "region"}) erase(document_, key);
    document_.insert("liquid", std::move(liquids));
  }

  // A Froude number stays where the density is the unit of the groups, and becomes gravity elsewhere.
  static void fluid_of(const Node& phase, Node& fluid) {
    const auto froude = positive_of(fluid, "froude", 0), density = positive_of(phase, "density", 0);
    const bool in_groups = froude && *froude > 0 && fluid.find("gravity") == nullptr;
    const Node* viscosity = phase.find("viscosity");
    if (in_groups && density == 1 && viscosity != nullptr && viscosity->is_number() && viscosity->number >= 0) {
      if (viscosity->number > 0) fluid.insert("reynolds", number_node(1 / viscosity->number, *viscosity));
      return;
    }
    if (in_groups) {
      fluid.insert("gravity", number_node(1 / (*froude * *froude), *fluid.find("froude")));
      erase(fluid, "froude");
    }
    for (const char* key : {"density", "viscosity"})
      if (const Node* value = phase.find(key)) fluid.insert(key, *value);
  }

  void solids_to_bodies() {
    const Node* solids = document_.find("solid");
    const std::vector<double> lower = numbers_of(find_section(document_, "domain.lower")),
                              upper = numbers_of(find_section(document_, "domain.upper"));
    const std::optional<double> spacing = [&] {
      const Node* node = find_section(document_, "resolution.spacing");
      return node != nullptr && node->is_number() ? std::optional(node->number) : std::nullopt;
    }();
    if (!holds_tables(solids) || lower.size() != upper.size() || !spacing) return;
    std::vector<Node> made;
    for (std::size_t k = 0; k < solids->children.size(); ++k) {
      const Node& solid = solids->children[k];
      std::vector<double> low = numbers_of(solid.find("lower")), high = numbers_of(solid.find("upper"));
      if (low.size() != lower.size() || high.size() != lower.size()) return;
      made.push_back(body_of(solid, k));
      Node size = node_at(solid, Node::Kind::array), position = size;
      for (std::size_t a = 0; a < low.size(); ++a) {
        // Methods look for walls as far as the kernel support, three spacings at most.
        const double slack = 1e-9 * (upper[a] - lower[a]), behind = 4 * *spacing;
        const bool periodic = document_.find("domain")->find(std::string(1, "xyz"[a])) != nullptr;
        if (!periodic && low[a] <= lower[a] + slack) low[a] = lower[a] - behind;
        if (!periodic && high[a] >= upper[a] - slack) high[a] = upper[a] + behind;
        size.children.push_back(number_node(high[a] - low[a], solid));
        position.children.push_back(number_node((low[a] + high[a]) / 2, solid));
      }
      made.back().insert("size", size);
      made.back().insert("position", position);
    }
    Node* bodies = document_.find("body");
    if (bodies == nullptr) bodies = &document_.insert("body", node_at(*document_.find("solid"), Node::Kind::array));
    if (bodies->kind != Node::Kind::array) return;
    bodies->children.insert(bodies->children.end(), made.begin(), made.end());
    erase(document_, "solid");
  }

  static Node body_of(const Node& solid, std::size_t k) {
    Node body = node_at(solid);
    body.insert("name", text_node("solid." + std::to_string(k), solid));
    body.insert("shape", text_node("box", solid));
    if (const Node* wall = solid.find("wall")) body.insert("wall", *wall);
    return body;
  }

  void leave_behind() {
    for (const Section& section : schema_.sections()) {
      // The scene's own sections are physics that the method would have to know.
      if (section.name.empty() || section.property != nullptr) continue;
      const std::size_t dot = section.name.rfind('.');
      const std::string key = dot == std::string::npos ? section.name : section.name.substr(dot + 1);
      Node* parent = dot == std::string::npos ? &document_
                                              : const_cast<Node*>(find_section(document_, section.name.substr(0, dot)));
      Node* table = parent != nullptr ? parent->find(key) : nullptr;
      if (table == nullptr) continue;
      if (!section.owners.include(method_.name)) {
        if (!table->override_text.empty()) continue;
        warn(*table, "[" + section.name + "]" + without() + belongs(section.owners));
        erase(*parent, key);
      } else if (table->kind == Node::Kind::table) {
        leave_keys(section, section.name, *table);
      } else if (holds_tables(table)) {
        for (std::size_t k = 0; k < table->children.size(); ++k)
          leave_keys(section, section.name + "." + std::to_string(k), table->children[k]);
      }
    }
  }

  void leave_keys(const Section& section, const std::string& name, Node& table) {
    for (const Option& option : section.options) {
      const Node* given = table.find(option.key);
      if (given == nullptr || option.property != nullptr || option.owners.include(method_.name) ||
          !given->override_text.empty())
        continue;
      warn(*given, name + "." + option.key + without() + belongs(option.owners));
      erase(table, option.key);
    }
  }

  static std::string belongs(const Owners& owners) {
    std::string names;
    for (const std::string& name : owners.names) names += (names.empty() ? "" : ", ") + name;
    return names.empty() ? "" : "; it belongs to " + names;
  }

  Node& document_;
  const CaseSchema& schema_;
  const MethodDeclaration& method_;
  const std::string& file_;
  Translation made_;
};

}  // namespace

Translation translate(Node& document, const CaseSchema& schema, const std::string& file) {
  const Node* chosen = document.find("method");
  const MethodDeclaration* method = schema.find(schema.method_of(document));
  if (chosen == nullptr || chosen->override_text.empty() || method == nullptr) return {};
  return Translator(document, schema, *method, file).run();
}

}  // namespace spume
