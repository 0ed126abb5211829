// SPDX-License-Identifier: MIT
#include "bodies.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "box_bodies.hpp"
#include "checks.hpp"
#include "expression_bodies.hpp"
#include "spume/core/error.hpp"
#include "spume/geometry/mesh.hpp"
#include "spume/scene/expression.hpp"

namespace spume {
namespace {

namespace fs = std::filesystem;

std::string kind_of(const BodyDraft& body) {
  static constexpr const char* names[] = {"",          "box",        "ball",    "cylinder",   "cone", "capsule",
                                          "ellipsoid", "half-space", "outline", "expression", "mesh"};
  return names[static_cast<std::size_t>(body.kind)];
}

// The keys that tell the size of a shape: those it needs, and those it may have.
struct ShapeKeys {
  std::vector<std::string> needed, possible;
};
ShapeKeys keys_of(BodyKind kind, int dimensions) {
  switch (kind) {
    case BodyKind::box:
      return {{"size"}, {}};
    case BodyKind::ball:
      return {{"radius"}, {}};
    case BodyKind::cylinder:
      return dimensions == 2 ? ShapeKeys{{"radius"}, {}} : ShapeKeys{{"radius"}, {"length"}};
    case BodyKind::cone:
      return {{"radius", "length"}, {"top_radius"}};
    case BodyKind::capsule:
      return {{"radius", "length"}, {}};
    case BodyKind::ellipsoid:
      return {{"semi_axes"}, {}};
    case BodyKind::half_space:
      return {{}, {"normal"}};
    case BodyKind::outline:
      return dimensions == 2 ? ShapeKeys{{"points"}, {}} : ShapeKeys{{"points"}, {"length"}};
    default:
      return {};
  }
}

std::string example_of(const std::string& key, int dimensions) {
  const std::string numbers = dimensions == 2 ? "[<number>, <number>]" : "[<number>, <number>, <number>]";
  if (key == "size" || key == "semi_axes") return numbers + "  # length, > 0";
  if (key == "points") return "[[<number>, <number>], ...]  # length, at least 3";
  return "<number>  # length, > 0";
}

class BodyCheck {
 public:
  BodyCheck(Draft& draft, std::size_t k, Problems& problems)
      : draft_(draft),
        body_(draft.bodies[k]),
        name_("body." + std::to_string(k)),
        node_(*draft.node(name_)),
        problems_(problems) {}

  void check() {
    if (!find_kind()) return;
    const int dimensions = draft_.dimensions;
    if (dimensions == 0) return;
    const ShapeKeys keys = keys_of(body_.kind, dimensions);
    for (const std::string& key : keys.needed)
      if (!draft_.node(name_ + "." + key))
        problems_.add(node_, "missing key '" + key + "' in [[body]], a " + kind_of(body_) + "; add  " + key + " = " +
                                 example_of(key, dimensions));
    for (const char* key : {"size", "radius", "top_radius", "length", "semi_axes", "normal", "points"}) {
      const Node* given = draft_.node(name_ + "." + key);
      const auto has = [&](const std::vector<std::string>& list) {
        return std::find(list.begin(), list.end(), key) != list.end();
      };
      if (!given || has(keys.needed) || has(keys.possible)) continue;
      problems_.add_key(*given, name_ + "." + key + " is no key of " + article() + kind_of(body_) + " in " +
                                    std::to_string(dimensions) + "-D; remove it");
    }
    const auto n = static_cast<std::size_t>(dimensions);
    check_list("size", body_.size, n, true);
    check_list("semi_axes", body_.semi_axes, n, true);
    check_list("normal", body_.normal, n, false);
    check_list("position", body_.position, n, false);
    check_list("rotation", body_.rotation, n == 2 ? 1 : 3, false);
    if (!body_.normal.empty() && std::all_of(body_.normal.begin(), body_.normal.end(), [](double x) { return x == 0; }))
      problems_.add(*draft_.node(name_ + ".normal"), name_ + ".normal must not be zero");
    if (body_.kind == BodyKind::mesh && dimensions == 2)
      problems_.add(*draft_.node(name_ + ".mesh"),
                    name_ + ".mesh needs a 3-D domain; in 2-D give its section as  shape = \"outline\"  with points");
  }

 private:
  std::string article() const {
    return body_.kind == BodyKind::ellipsoid || body_.kind == BodyKind::outline || body_.kind == BodyKind::expression
               ? "an "
               : "a ";
  }

  bool find_kind() {
    const Node* shape = draft_.node(name_ + ".shape");
    const Node* where = draft_.node(name_ + ".where");
    const Node* mesh = draft_.node(name_ + ".mesh");
    const int given = (shape != nullptr) + (where != nullptr) + (mesh != nullptr);
    if (given == 0)
      problems_.add(node_,
                    "missing shape in [[body]]; add  shape = \"box\"  (or another word), where = "
                    "\"<expression>\"  or  mesh = \"<file>\"");
    if (given > 1)
      problems_.add(node_, name_ +
                               " has more than one shape; keep one of shape, where and mesh, and write a [[body]] "
                               "for each other");
    if (where) body_.kind = BodyKind::expression;
    if (mesh) body_.kind = BodyKind::mesh;
    return given == 1 && draft_.usable(name_ + ".shape");
  }

  void check_list(const char* key, const std::vector<double>& values, std::size_t wanted, bool above_zero) {
    const Node* given = draft_.node(name_ + "." + key);
    if (!given || !draft_.usable(name_ + "." + key)) return;
    if (values.size() != wanted) {
      problems_.add(*given, name_ + "." + key + " must have " + std::to_string(wanted) +
                                (wanted == 1 ? " entry in a " : " entries in a ") + std::to_string(draft_.dimensions) +
                                "-D domain, found " + std::to_string(values.size()));
      draft_.bad[name_ + "." + key] = true;
      return;
    }
    for (std::size_t i = 0; i < values.size() && above_zero; ++i)
      if (!(values[i] > 0))
        problems_.add(given->children[i],
                      name_ + "." + key + "[" + std::to_string(i) + "] must be > 0, found " + brief(values[i]));
  }

  Draft& draft_;
  BodyDraft& body_;
  std::string name_;
  const Node& node_;
  Problems& problems_;
};

void check_references(const Draft& draft, const std::set<std::string>& names, Problems& problems) {
  const std::vector<std::string> known(names.begin(), names.end());
  const auto check = [&](const std::string& place, const LiquidDraft& liquid) {
    const Node* given = draft.node(place + ".body");
    if (!given || !draft.usable(place + ".body")) return;
    if (!names.count(liquid.body)) {
      const std::string best = nearest(liquid.body, known);
      problems.add(*given, place + ".body must be the name of a [[body]]" +
                               (known.empty() ? ", and there is none" : ", " + words_in_words(known)) + ", found " +
                               to_toml_string(liquid.body) + (best.empty() ? "" : "; did you mean \"" + best + "\"?"));
    }
    if (liquid.conform)
      problems.add(*draft.node(place + ".conform"),
                   place + ".conform ends columns on the surface where = 0; remove body");
  };
  for (std::size_t k = 0; k < draft.liquids.size(); ++k) check("liquid." + std::to_string(k), draft.liquids[k]);
  for (std::size_t k = 0; k < draft.regions.size(); ++k) check("region." + std::to_string(k), draft.regions[k]);
}

Pose pose_of(const BodyDraft& body, int dimensions) {
  Pose pose;
  pose.position = to_vec3(body.position);
  pose.scale = body.scale;
  if (!body.rotation.empty())
    pose.rotation = rotation_by(dimensions == 2 ? Vec3{0, 0, body.rotation[0]} : to_vec3(body.rotation));
  return pose;
}

ShapePointer read_body_mesh(const Draft& draft, const std::string& name, const std::string& file, Problems& problems) {
  const fs::path path = fs::path(draft.options.path).parent_path() / file;
  TriangleSurface surface = read_mesh(path.string());
  const std::vector<std::string> faults = mesh_faults(surface);
  for (const std::string& fault : faults)
    problems.add(*draft.node(name + ".mesh"), name + ".mesh: '" + path.string() + "': " + fault);
  return faults.empty() ? make_mesh(std::move(surface)) : nullptr;
}

// In coordinates of its own.
ShapePointer make_shape(const Draft& draft, const BodyDraft& body, const std::string& name, Problems& problems) {
  const int dimensions = draft.dimensions;
  switch (body.kind) {
    case BodyKind::box:
      return make_box(to_vec3(body.size), dimensions);
    case BodyKind::ball:
      return make_ball(*body.radius, dimensions);
    case BodyKind::cylinder:
      return make_cylinder(*body.radius, body.length, dimensions);
    case BodyKind::cone:
      return make_cone(*body.radius, body.top_radius, *body.length, dimensions);
    case BodyKind::capsule:
      return make_capsule(*body.radius, *body.length, dimensions);
    case BodyKind::ellipsoid:
      return make_ellipsoid(to_vec3(body.semi_axes), dimensions);
    case BodyKind::half_space: {
      Vec3 up{};
      up[static_cast<std::size_t>(dimensions) - 1] = 1;
      return make_half_space(body.normal.empty() ? up : to_vec3(body.normal), dimensions);
    }
    case BodyKind::outline:
      return make_outline(body.points, body.length, dimensions);
    case BodyKind::mesh:
      return read_body_mesh(draft, name, body.mesh, problems);
    case BodyKind::expression:
    case BodyKind::none:
      break;
  }
  return nullptr;
}

// Where it stands at the start, without its copies.
ShapePointer make_placed(const Draft& draft, const BodyDraft& body, const std::string& name,
                         const CompileExpression& compile, Problems& problems) {
  const Pose pose = pose_of(body, draft.dimensions);
  if (body.kind == BodyKind::expression) {
    const auto where = compile(*body.where, name + ".where", Arguments::place);
    return where ? make_expression_body(draft, name, *where, pose, problems) : nullptr;
  }
  ShapePointer shape = make_shape(draft, body, name, problems);
  return shape ? place(std::move(shape), pose, true, draft.dimensions) : nullptr;
}

const char* key_of(BodyKind kind) {
  if (kind == BodyKind::outline) return ".points";
  return kind == BodyKind::mesh ? ".mesh" : kind == BodyKind::expression ? ".where" : "";
}

}  // namespace

void check_bodies(Draft& draft, const MethodDeclaration* method, Problems& problems) {
  if (!draft.usable("body")) return;
  std::set<std::string> names;
  bool walls = false;
  for (std::size_t k = 0; k < draft.bodies.size(); ++k) {
    BodyDraft& body = draft.bodies[k];
    const std::string place = "body." + std::to_string(k);
    const Node* name = draft.node(place + ".name");
    if (!name) body.name = place;
    const Node& at = name ? *name : *draft.node(place);
    if (body.name.empty())
      problems.add(at, place + ".name must not be empty");
    else if (!names.insert(body.name).second)
      problems.add(at, "another body has the name '" + body.name + "' already");
    BodyCheck(draft, k, problems).check();
    const bool wall = body.wall != BoundaryKind::open;
    if (wall && method != nullptr && !method->honours_bodies) {
      const Node* given = draft.node(place + ".wall");
      problems.add(given ? *given : *draft.node(place),
                   place + " is a wall, and method \"" + method->name +
                       "\" has no walls of bodies; write a box along the axes as [[solid]], or  wall = \"none\"  for a "
                       "shape that [[liquid]] fills");
    }
    const bool moves_along = !body.moves_with.empty();  // see check_body_motions()
    if (body.subtract && !moves_along && !(wall && walls))
      problems.add(
          *draft.node(place + ".subtract"),
          place + (wall ? ".subtract takes away from the walls of bodies before it, and there are none; put it "
                          "behind the body that it cuts"
                        : ".subtract needs a wall to take away; remove it, or set wall"));
    walls = walls || (wall && !moves_along);
  }
  check_references(draft, names, problems);
}

std::vector<Body> make_bodies(const Draft& draft, const CompileExpression& compile, Problems& problems) {
  std::vector<Body> bodies;
  const bool ready = draft.dimensions > 0 && draft.usable("resolution.spacing") && problems.empty();
  for (std::size_t k = 0; k < draft.bodies.size(); ++k) {
    const BodyDraft& given = draft.bodies[k];
    const std::string name = "body." + std::to_string(k);
    Body body{.name = given.name,
              .kind = kind_of(given),
              .shape = nullptr,
              .solid = nullptr,
              .inside = given.inside,
              .subtract = given.subtract,
              .wall = given.wall};
    if (ready) {
      try {
        if (const ShapePointer placed = make_placed(draft, given, name, compile, problems)) {
          Bounds window;
          Vec3 periods{};
          for (std::size_t a = 0; a < static_cast<std::size_t>(draft.dimensions); ++a) {
            window.lower[a] = draft.lower[a] - beyond_side * draft.options.spacing;
            window.upper[a] = draft.upper[a] + beyond_side * draft.options.spacing;
            if (draft.periodic[a]) periods[a] = draft.upper[a] - draft.lower[a];
          }
          body.shape = repeat(placed, window, periods);
          body.solid = given.inside ? body.shape : place(body.shape, Pose{}, false, draft.dimensions);
          body.alone = given.inside ? placed : place(placed, Pose{}, false, draft.dimensions);
        }
      } catch (const InputError& error) {
        const std::string key = key_of(given.kind);
        for (const Problem& problem : error.problems())
          problems.add(*draft.node(name + key), name + key + ": " + problem.text);
      }
    } else if (given.where) {
      compile(*given.where, name + ".where", Arguments::place);
    }
    if (!given.velocity.empty()) {
      VectorExpression velocity;
      for (std::size_t a = 0; a < given.velocity.size() && a < 3; ++a)
        velocity.component[a] = compile(given.velocity[a], name + ".velocity", Arguments::place_and_time);
      body.velocity = std::move(velocity);
    }
    bodies.push_back(std::move(body));
  }
  return bodies;
}

Combination make_walls(const std::vector<Body>& bodies, const std::vector<BodyMotion>& motions) {
  std::vector<CombinedPart> parts;
  for (const Body& body : bodies)
    if (body.wall != BoundaryKind::open && !(body.motion && motions[*body.motion].release))
      parts.push_back({body.solid, body.subtract});
  return Combination(std::move(parts));
}

}  // namespace spume
