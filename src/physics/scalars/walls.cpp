// SPDX-License-Identifier: MIT
#include "spume/physics/scalars/walls.hpp"

#include <algorithm>
#include <cmath>

#include "spume/operators/pair_sweep.hpp"
#include "spume/physics/scalars/options.hpp"
#include "spume/scene/document.hpp"
#include "spume/scene/expression.hpp"
#include "spume/scene/option.hpp"

namespace spume {
namespace {

struct ScalarWallDraft {
  std::string scalar, side;
  std::optional<ExpressionText> flux, value;
};
struct ScalarWallDrafts {
  std::vector<ScalarWallDraft> walls;
};

std::string place_of(std::size_t k) {
  return "scalar_wall." + std::to_string(k);
}

// Up is the last axis; a domain with two has neither front nor back.
int axis_of(const std::string& side, int dimensions) {
  if (side == "left" || side == "right") return 0;
  if (side == "bottom" || side == "top") return dimensions - 1;
  return dimensions == 3 ? 1 : dimensions;
}

void compile_walls(Draft& draft, const CompileExpression& compile) {
  const std::vector<ScalarWallDraft>& given = draft.options.get<ScalarWallDrafts>().walls;
  std::vector<ScalarWall>& made = draft.options.get<ScalarWalls>().walls;
  for (std::size_t k = 0; k < std::min(given.size(), made.size()); ++k) {
    if (given[k].flux) made[k].flux = compile(*given[k].flux, place_of(k) + ".flux", Arguments::place_and_time);
    if (given[k].value) made[k].value = compile(*given[k].value, place_of(k) + ".value", Arguments::place_and_time);
  }
}

}  // namespace

Section scalar_wall_section() {
  using W = ScalarWallDraft;
  auto section = repeated_section<W>(
      "scalar_wall", [](Draft& d) -> std::vector<W>& { return d.options.get<ScalarWallDrafts>().walls; });
  section.declare = [](Case& options) {
    options.declare<ScalarWallDrafts>();
    options.declare<ScalarWalls>();
  };
  section.option("scalar", &W::scalar, "name of the scalar").required();
  section
      .word("side", &W::side,
            {{"left", "left"},
             {"right", "right"},
             {"front", "front"},
             {"back", "back"},
             {"bottom", "bottom"},
             {"top", "top"}},
            "side of the domain, a wall")
      .required();
  section
      .option("flux", &W::flux, "concentration times length/time",
              "what enters per area of the wall: an expression of x, y, z, t")
      .absent("a value")
      .option("value", &W::value, "concentration", "concentration at the wall: an expression of x, y, z, t")
      .absent("a flux");
  section.compile = compile_walls;
  return section;
}

void check_scalar_walls(Draft& draft, Problems& problems) {
  std::vector<ScalarWall>& made = draft.options.get<ScalarWalls>().walls;
  const std::vector<ScalarWallDraft>& given = draft.options.get<ScalarWallDrafts>().walls;
  const std::vector<ScalarOption>& scalars = draft.options.get<ScalarOptions>().scalars;
  made.clear();
  for (std::size_t k = 0; k < given.size(); ++k) {
    ScalarWall wall;
    const Node* section = draft.node(place_of(k));
    if (const Node* node = draft.node(place_of(k) + ".scalar"); node != nullptr) {
      const auto found = std::find_if(scalars.begin(), scalars.end(),
                                      [&](const ScalarOption& one) { return one.name == given[k].scalar; });
      wall.scalar = found == scalars.end() ? 0 : static_cast<std::size_t>(found - scalars.begin());
      if (found == scalars.end())
        problems.add(*node,
                     "there is no scalar '" + given[k].scalar + "'; add a [[scalar]] of that name, or correct it");
    }
    if (const Node* node = draft.node(place_of(k) + ".side");
        node != nullptr && draft.dimensions > 0 && draft.usable(place_of(k) + ".side")) {
      const auto side = draft.sides.find(given[k].side);
      wall.axis = axis_of(given[k].side, draft.dimensions);
      wall.end = given[k].side == "right" || given[k].side == "back" || given[k].side == "top" ? 1 : 0;
      if (side == draft.sides.end() || side->second == BoundaryKind::open || wall.axis >= draft.dimensions)
        problems.add(*node, "the side '" + given[k].side + "' is no wall; set  domain." + given[k].side +
                                " = \"no-slip\"  or name another side");
    }
    if (section != nullptr && given[k].flux.has_value() == given[k].value.has_value())
      problems.add(*section, std::string("[[scalar_wall]] has ") + (given[k].flux ? "both" : "neither") +
                                 " of flux and value; give one of them");
    made.push_back(wall);
  }
}

WallProfile::WallProfile(const Resolution& resolution) : spacing_(resolution.spacing) {
  const double h = resolution.smoothing_length;
  with_plain_kernel(resolution.dimensions, resolution.kernel, [&]<int dimensions, class Kernel>() {
    const int reach = static_cast<int>(Kernel::support * h / spacing_);
    planes_.assign(static_cast<std::size_t>(reach), 0.0);
    double moment = 0;
    for (int k = 1; k <= reach; ++k) {
      double& plane = planes_[static_cast<std::size_t>(k - 1)];
      for (int i = -reach; i <= reach; ++i)
        for (int j = dimensions == 3 ? -reach : 0; j <= (dimensions == 3 ? reach : 0); ++j) {
          const double q = std::sqrt(k * k + i * i + j * j) * spacing_ / h;
          if (q < Kernel::support) plane -= Kernel::f(q);
        }
      moment += plane * k * k * spacing_ * spacing_;
    }
    for (double& plane : planes_) plane /= moment;
  });
}

double WallProfile::operator()(double distance) const {
  double sum = 0;
  for (std::size_t k = planes_.size(); k-- > 0;) {
    const double behind = static_cast<double>(k + 1) * spacing_ - distance;
    if (!(behind > 0)) break;
    sum += planes_[k] * 2 * behind;
  }
  return sum;
}

}  // namespace spume
