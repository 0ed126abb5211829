// SPDX-License-Identifier: MIT
#include "spume/physics/scalars/options.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>

#include "spume/scene/document.hpp"
#include "spume/scene/expression.hpp"
#include "spume/scene/option.hpp"

namespace spume {
namespace {

struct ScalarDraft {
  ScalarOption scalar;
  std::optional<ExpressionText> initial, inflow, source;
};
struct ScalarDrafts {
  std::vector<ScalarDraft> scalars;
};

std::string place_of(std::size_t k) {
  return "scalar." + std::to_string(k);
}

void compile_scalars(Draft& draft, const CompileExpression& compile) {
  const std::vector<ScalarDraft>& given = draft.options.get<ScalarDrafts>().scalars;
  std::vector<ScalarOption>& made = draft.options.get<ScalarOptions>().scalars;
  for (std::size_t k = 0; k < std::min(given.size(), made.size()); ++k) {
    if (given[k].initial) made[k].initial = compile(*given[k].initial, place_of(k) + ".initial", Arguments::place);
    if (given[k].source) made[k].source = compile(*given[k].source, place_of(k) + ".source", Arguments::place_and_time);
    if (given[k].inflow) made[k].inflow = compile(*given[k].inflow, place_of(k) + ".inflow", Arguments::place_and_time);
  }
}

// A name becomes a column of series.csv and a field of VTK files.
bool is_plain(const std::string& name) {
  const auto plain = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
  return !name.empty() && std::isalpha(static_cast<unsigned char>(name[0])) != 0 &&
         std::all_of(name.begin(), name.end(), plain);
}

void refuse_value(const Draft& draft, std::size_t k, const Vec3& r, double value, Problems& problems) {
  const Node* node = draft.node(place_of(k) + ".initial");
  problems.add(*node, place_of(k) + ".initial is " + brief(value) + " at (" + brief(r[0]) + ", " + brief(r[1]) + ", " +
                          brief(r[2]) + "); it must be a finite number" + (value < 0 ? " >= 0" : "") +
                          " where there is liquid; change the expression");
}

// What inflows bring, at their middles and 100 times of the run: a finite number, of a substance not below zero.
void check_inflows(const Draft& draft, const Scene& scene, Problems& problems) {
  const std::vector<ScalarOption>& scalars = draft.options.get<ScalarOptions>().scalars;
  std::string nearest;
  const Opening* entrance = nullptr;
  for (const Opening& opening : scene.openings)
    if (opening.inflow) entrance = &opening;
  if (entrance == nullptr) return;
  for (std::size_t k = 0; k < scalars.size(); ++k) {
    if (scalars[k].inflow == nullptr) nearest += (nearest.empty() ? "'" : ", '") + scalars[k].name + "'";
    const auto wrong_at = [&](const Opening& opening, double t) {
      Vec3 r{};
      for (std::size_t a = 0; a < 3; ++a) r[a] = (opening.lower[a] + opening.upper[a]) / 2;
      const double value = (*scalars[k].inflow)(r[0], r[1], r[2], t);
      if (std::isfinite(value) && !(scalars[k].not_negative && value < 0)) return false;
      problems.add(*draft.node(place_of(k) + ".inflow"), place_of(k) + ".inflow is " + brief(value) +
                                                             " in the middle of " + opening.name +
                                                             " at t = " + brief(t) + "; it must be a finite number" +
                                                             (value < 0 ? " >= 0" : "") + "; change the expression");
      return true;
    };
    bool wrong = scalars[k].inflow == nullptr;
    for (const Opening& opening : scene.openings)
      for (int n = 0; n <= 100 && opening.inflow && !wrong; ++n)
        wrong = wrong_at(opening, draft.options.time.end * n / 100);
  }
  if (!nearest.empty())
    problems.warn(*draft.node(entrance->name), "what enters has the concentration of the nearest liquid of " + nearest +
                                                   ", which have no key inflow: none is brought or washed out there; "
                                                   "give  [[scalar]] inflow = \"<expression>\", \"0\" for none");
}

}  // namespace

Section scalar_section() {
  using S = ScalarDraft;
  auto section =
      repeated_section<S>("scalar", [](Draft& d) -> std::vector<S>& { return d.options.get<ScalarDrafts>().scalars; });
  section.declare = [](Case& options) {
    options.declare<ScalarDrafts>();
    options.declare<ScalarOptions>();
  };
  section
      .option(
          "name", [](S& s) -> std::string& { return s.scalar.name; }, "name of its output field and its column")
      .required()
      .option(
          "unit", [](S& s) -> std::string& { return s.scalar.unit; }, "unit of the concentration, in words")
      .absent("none")
      .option("initial", &S::initial, "concentration", "concentration at the start: an expression of x, y, z")
      .absent("0")
      .option(
          "diffusivity", [](S& s) -> double& { return s.scalar.diffusivity; }, "length2/time", not_negative(),
          "molecular diffusivity")
      .option(
          "turbulent_schmidt", [](S& s) -> double& { return s.scalar.turbulent_schmidt; }, "1", positive(),
          "eddy viscosity over the diffusivity that it adds")
      .option("source", &S::source, "concentration/time",
              "what is added per volume of liquid: an expression of x, y, z, t")
      .absent("none")
      .option("inflow", &S::inflow, "concentration", "concentration of what enters: an expression of x, y, z, t")
      .absent("that of the nearest liquid");
  section.compile = compile_scalars;
  return section;
}

void check_scalars(Draft& draft, const std::vector<std::string>& taken, Problems& problems) {
  std::vector<ScalarOption>& made = draft.options.get<ScalarOptions>().scalars;
  made.clear();
  const std::vector<ScalarDraft>& given = draft.options.get<ScalarDrafts>().scalars;
  for (std::size_t k = 0; k < given.size(); ++k) {
    const std::string& name = given[k].scalar.name;
    const std::string place = place_of(k) + ".name";
    const auto same = [&](const ScalarOption& other) { return other.name == name; };
    if (draft.usable(place) && draft.node(place) != nullptr) {
      const Node& node = *draft.node(place);
      if (!is_plain(name))
        problems.add(node, place + " is " + to_toml_string(name) +
                               "; a name begins with a letter and holds letters, digits and _; rename it");
      else if (std::find(taken.begin(), taken.end(), name) != taken.end())
        problems.add(node, "the name '" + name + "' is that of another output field; rename the scalar");
      else if (std::any_of(made.begin(), made.end(), same))
        problems.add(node, "another scalar has the name '" + name + "' already; rename one of them");
    }
    if (const Node* inflow = draft.node(place_of(k) + ".inflow"); inflow != nullptr && draft.inflows.empty())
      problems.add(*inflow, place_of(k) +
                                ".inflow needs an opening where liquid enters, found none; add an  "
                                "[[inflow]], or remove it");
    made.push_back(given[k].scalar);
  }
}

std::size_t require_scalar(Draft& draft, const ScalarOption& scalar) {
  std::vector<ScalarOption>& made = draft.options.get<ScalarOptions>().scalars;
  const auto same = [&](const ScalarOption& other) { return other.name == scalar.name; };
  const auto found = std::find_if(made.begin(), made.end(), same);
  const auto index = static_cast<std::size_t>(found - made.begin());
  if (found == made.end()) made.push_back(scalar);
  made[index].not_negative = true;
  return index;
}

void check_initial_scalars(const Draft& draft, const Scene& scene, Problems& problems) {
  const std::vector<ScalarOption>& scalars = draft.options.get<ScalarOptions>().scalars;
  for (std::size_t k = 0; k < scalars.size(); ++k) {
    if (scalars[k].initial == nullptr) continue;
    for (std::size_t i = 0; i < scene.particles.size(); ++i) {
      Vec3 r{};
      for (int axis = 0; axis < scene.domain.dimensions; ++axis) r[axis] = scene.particles.position[axis][i];
      const double value = (*scalars[k].initial)(r[0], r[1], r[2], 0);
      if (std::isfinite(value) && !(scalars[k].not_negative && value < 0)) continue;
      refuse_value(draft, k, r, value, problems);
      break;
    }
  }
  check_inflows(draft, scene, problems);
}

}  // namespace spume
