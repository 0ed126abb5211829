// SPDX-License-Identifier: MIT
#include "body_motion.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <optional>

#include "checks.hpp"
#include "releases.hpp"
#include "solid_moments.hpp"
#include "spume/core/golden_ratio.hpp"
#include "spume/scene/expression.hpp"
#include "spume/scene/option.hpp"
#include "time_table.hpp"

namespace spume {
namespace {

namespace fs = std::filesystem;

// Spacings: expressions are looked at as far as four beyond the domain. What reaches farther than this goes on.
constexpr double ends_of_expressions = 3;

bool goes_on_beyond(const Draft& draft, const Body& body, std::size_t axis, int side) {
  if (body.kind != "expression" || body.subtract) return false;
  const double reach = ends_of_expressions * draft.options.spacing;
  const Bounds own = body.alone->bounds();
  return side == 0 ? own.lower[axis] < draft.lower[axis] - reach : own.upper[axis] > draft.upper[axis] + reach;
}

std::string expected_end(const Draft& draft) {
  return "expected a body that ends within " + brief(ends_of_expressions * draft.options.spacing) +
         " of the domain: let it end there, or write it as a shape";
}

std::string place_of(std::size_t k) {
  return "body." + std::to_string(k);
}

bool is_given(const BodyDraft& body) {
  return !body.displacement.empty() || body.angle || !body.motion.empty();
}
bool floats(const BodyDraft& body) {
  return body.mass || body.density;
}
bool moves_itself(const BodyDraft& body) {
  return is_given(body) || floats(body);
}

std::vector<std::string> motions_free_in(int dimensions) {
  if (dimensions == 2) return {"x", "y", "turn"};
  return {"x", "y", "z", "turn_x", "turn_y", "turn_z"};
}

class CheckMotion {
 public:
  CheckMotion(const Draft& draft, std::size_t k, const MethodDeclaration* method, Problems& problems)
      : draft_(draft), body_(draft.bodies[k]), name_(place_of(k)), k_(k), method_(method), problems_(problems) {}

  void check() {
    if (!moves_itself(body_) && body_.moves_with.empty()) {
      for (const char* key : {"axis", "pivot", "inertia", "free", "release_interval", "release_duration",
                              "release_delay", "release_growth", "release_shrinkage"})
        if (const Node* node = given(key))
          problems_.add_key(*node, name_ + "." + key +
                                       " is for bodies that move, and this one does not; add displacement, angle, "
                                       "motion or mass, or remove it");
      return;
    }
    const Node& node = *draft_.node(name_);
    if (body_.wall == BoundaryKind::open)
      problems_.add(node, name_ +
                              " moves and is no wall; remove what moves it, or set wall to \"free-slip\" or "
                              "\"no-slip\"");
    if (const Node* velocity = given("velocity"))
      problems_.add_key(*velocity, name_ +
                                       ".velocity slides the surface of a body that stands still; remove it, or "
                                       "what moves the body");
    if (!body_.moves_with.empty()) {
      with_another();
      return;
    }
    if (is_given(body_) && floats(body_))
      problems_.add(*given(body_.mass ? "mass" : "density"),
                    name_ + " has a given motion and floats; keep displacement, angle or motion, or mass or density");
    else if (floats(body_))
      floating();
    else
      moved();
    if (body_.subtract)
      problems_.add(*given("subtract"), name_ +
                                            ".subtract takes away from the bodies that move as one with it: give "
                                            "the one that it cuts in moves_with");
    list("pivot", body_.pivot, dimensions());
    check_release(draft_, k_, floats(body_), problems_);
  }

 private:
  const Node* given(const char* key) const { return draft_.node(name_ + "." + key); }
  std::size_t dimensions() const { return static_cast<std::size_t>(draft_.dimensions); }

  void list(const char* key, const std::vector<double>& values, std::size_t wanted) {
    const Node* node = given(key);
    if (node == nullptr || draft_.dimensions == 0 || !draft_.usable(name_ + "." + key) || values.size() == wanted)
      return;
    problems_.add(*node, name_ + "." + key + " must have " + std::to_string(wanted) +
                             (wanted == 1 ? " entry in a " : " entries in a ") + std::to_string(draft_.dimensions) +
                             "-D domain, found " + std::to_string(values.size()));
  }

  void with_another() {
    const Node& node = *given("moves_with");
    std::vector<std::string> known;
    for (std::size_t j = 0; j < k_; ++j)
      if (moves_itself(draft_.bodies[j])) known.push_back(draft_.bodies[j].name);
    if (std::find(known.begin(), known.end(), body_.moves_with) == known.end()) {
      const std::string best = nearest(body_.moves_with, known);
      problems_.add(node, name_ + ".moves_with must be the name of a moving [[body]] before it" +
                              (known.empty() ? ", and there is none" : ", " + words_in_words(known)) + ", found " +
                              to_toml_string(body_.moves_with) +
                              (best.empty() ? "" : "; did you mean \"" + best + "\"?"));
    }
    for (const char* key :
         {"displacement", "angle", "motion", "axis", "pivot", "mass", "density", "inertia", "free", "restitution",
          "release_interval", "release_duration", "release_delay", "release_growth", "release_shrinkage"})
      if (const Node* own = given(key))
        problems_.add_key(*own, name_ + "." + key + " is that of the body it moves with; remove it here");
  }

  void moved() {
    if (!body_.motion.empty() && (!body_.displacement.empty() || body_.angle))
      problems_.add(*given("motion"), name_ + ".motion and " +
                                          (body_.angle ? std::string("angle") : std::string("displacement")) +
                                          " both say how it moves; keep one of them");
    if (!body_.displacement.empty() && draft_.dimensions > 0 && body_.displacement.size() != dimensions())
      problems_.add(*given("displacement"), name_ + ".displacement must have " + std::to_string(draft_.dimensions) +
                                                " entries in a " + std::to_string(draft_.dimensions) +
                                                "-D domain, found " + std::to_string(body_.displacement.size()));
    if (draft_.dimensions == 3 && body_.angle && given("axis") == nullptr)
      problems_.add(*given("angle"),
                    "missing key 'axis' in [[body]], which turns; add  axis = [<number>, <number>, <number>]");
    if (const Node* axis = given("axis")) {
      if (draft_.dimensions == 2)
        problems_.add_key(*axis, name_ + ".axis: in 2-D bodies turn about the direction out of the plane; remove it");
      else if (draft_.dimensions == 3)
        list("axis", body_.axis, 3);
      if (body_.axis.size() == 3 && std::all_of(body_.axis.begin(), body_.axis.end(), [](double x) { return x == 0; }))
        problems_.add(*axis, name_ + ".axis must not be zero");
    }
    for (const char* key : {"inertia", "free", "restitution"})
      if (const Node* node = given(key))
        problems_.add_key(*node, name_ + "." + key + " is for bodies that float; remove it, or give mass or density");
  }

  void floating() {
    const Node& node = *given(body_.mass ? "mass" : "density");
    if (body_.mass && body_.density)
      problems_.add(node, name_ + " has a mass and a density, which follow from each other; remove one of them");
    if (method_ != nullptr && !method_->honours_floating_bodies)
      problems_.add(node, name_ + " floats, and method \"" + method_->name +
                              "\" has no floating bodies; give its way by displacement, angle or motion");
    if (!body_.inside)
      problems_.add(node, name_ + " floats and is all that lies outside its shape; remove inside = false");
    list("inertia", body_.inertia, draft_.dimensions == 2 ? 1 : 3);
    for (std::size_t a = 0; a < body_.inertia.size(); ++a)
      if (!(body_.inertia[a] > 0))
        problems_.add(*given("inertia"),
                      name_ + ".inertia[" + std::to_string(a) + "] must be > 0, found " + brief(body_.inertia[a]));
    if (draft_.dimensions == 0) return;
    const std::vector<std::string> known = motions_free_in(draft_.dimensions);
    for (const std::string& word : body_.free)
      if (std::find(known.begin(), known.end(), word) == known.end())
        problems_.add(*given("free"),
                      name_ + ".free must hold of " + words_in_words(known) + ", found " + to_toml_string(word));
    for (const char* key : {"axis"})
      if (const Node* own = given(key)) problems_.add_key(*own, name_ + "." + key + " is for a given angle; remove it");
  }

  const Draft& draft_;
  const BodyDraft& body_;
  std::string name_;
  std::size_t k_;
  const MethodDeclaration* method_;
  Problems& problems_;
};

class MakeMotion {
 public:
  MakeMotion(const Draft& draft, std::size_t k, const CompileExpression& compile, std::vector<Body>& bodies,
             Problems& problems)
      : draft_(draft),
        given_(draft.bodies[k]),
        name_(place_of(k)),
        compile_(compile),
        bodies_(bodies),
        problems_(problems) {
    motion_.bodies = {k};
    for (std::size_t j = k + 1; j < draft.bodies.size(); ++j)
      if (!given_.name.empty() && draft.bodies[j].moves_with == given_.name) motion_.bodies.push_back(j);
  }

  BodyMotion make(double duration) {
    motion_.pivot = to_vec3(given_.pivot.empty() ? given_.position : given_.pivot);
    motion_.time_scale = duration;
    if (floats(given_))
      float_it();
    else
      move_it();
    return std::move(motion_);
  }

 private:
  std::shared_ptr<const Expression> of_time(const ExpressionText& text, const std::string& key) {
    auto compiled = compile_(text, name_ + key, Arguments::place_and_time);
    if (compiled && (*compiled)(0.3, 0.7, 0.9, 0.4) != (*compiled)(-1.1, 1.3, -0.6, 0.4))
      problems_.add(*text.node, name_ + key + " moves all of a rigid body and depends on its place; use t alone");
    return compiled;
  }

  void move_it() {
    if (draft_.dimensions == 3 && given_.axis.size() == 3) motion_.axis = unit(to_vec3(given_.axis));
    for (std::size_t a = 0; a < given_.displacement.size() && a < 3; ++a)
      motion_.displacement.component[a] = of_time(given_.displacement[a], ".displacement[" + std::to_string(a) + "]");
    if (given_.angle) motion_.angle = of_time(*given_.angle, ".angle");
    if (!given_.motion.empty()) read_motion();
    for (const auto& part : motion_.displacement.component)
      if (part) finite(*part);
    if (motion_.angle) finite(*motion_.angle);
  }

  void finite(const Expression& part) {
    if (std::isfinite(part(0, 0, 0, 0))) return;
    problems_.add(*draft_.node(name_), name_ + " stands nowhere at t = 0: its displacement or angle is not a number");
  }

  void read_motion() {
    const Node& node = *draft_.node(name_ + ".motion");
    const fs::path given(given_.motion);
    const fs::path file = given.is_absolute() ? given : fs::path(draft_.options.path).parent_path() / given;
    const TimeTable table = read_time_table(file.string(), TableValues::smooth);
    if (!table.fault.empty()) {
      problems_.add(node, name_ + ".motion: " + table.fault);
      return;
    }
    const std::string axes = "xyz";
    for (const auto& [column, values] : table.columns) {
      const std::size_t axis = column.size() == 1 ? axes.find(column[0]) : std::string::npos;
      if (axis < static_cast<std::size_t>(draft_.dimensions))
        motion_.displacement.component[axis] = values;
      else if (column == "angle")
        motion_.angle = values;
      else
        problems_.add(node, name_ + ".motion has a column '" + column + "'; those of a motion are t, " +
                                (draft_.dimensions == 3 ? "x, y, z" : "x, y") + " and angle");
    }
    if (motion_.angle && draft_.dimensions == 3 && given_.axis.empty())
      problems_.add(node, "missing key 'axis' in [[body]], which turns; add  axis = [<number>, <number>, <number>]");
  }

  void float_it() {
    motion_.floats = true;
    for (std::size_t a = 0; a < static_cast<std::size_t>(draft_.dimensions); ++a) motion_.free_along[a] = 1;
    if (draft_.dimensions == 3) motion_.free_about = {1, 1, 1};
    if (draft_.dimensions == 2) motion_.free_about = {0, 0, 1};
    if (!given_.free.empty()) {
      const auto has = [&](const std::string& word) {
        return std::find(given_.free.begin(), given_.free.end(), word) != given_.free.end();
      };
      for (std::size_t a = 0; a < 3; ++a) {
        const std::string axis(1, "xyz"[a]);
        motion_.free_along[a] = has(axis) ? 1 : 0;
        motion_.free_about[a] = has("turn_" + axis) || (a == 2 && has("turn")) ? 1 : 0;
      }
    }
    std::vector<CombinedPart> parts;
    Bounds bounds{{infinite, infinite, infinite}, {-infinite, -infinite, -infinite}};
    for (const std::size_t b : motion_.bodies) {
      if (!bodies_[b].alone) return;  // known to be wrong
      parts.push_back({bodies_[b].alone, bodies_[b].subtract});
      if (goes_on(b)) return;
      const Bounds own = bodies_[b].alone->bounds();
      for (std::size_t a = 0; a < static_cast<std::size_t>(draft_.dimensions) && !bodies_[b].subtract; ++a) {
        bounds.lower[a] = std::min(bounds.lower[a], own.lower[a]);
        bounds.upper[a] = std::max(bounds.upper[a], own.upper[a]);
      }
    }
    for (std::size_t a = 0; a < 3; ++a) {
      if (a >= static_cast<std::size_t>(draft_.dimensions)) {
        bounds.lower[a] = bounds.upper[a] = 0;
      } else if (!std::isfinite(bounds.upper[a] - bounds.lower[a])) {
        problems_.add(*draft_.node(name_), name_ + " floats and has no end along " + std::string(1, "xyz"[a]) +
                                               "; give it a length, so that it has a mass");
        return;
      }
    }
    const bool single = motion_.bodies.size() == 1;
    SolidMoments solid = moments_of(Combination(std::move(parts)), bounds, draft_.dimensions);
    if (const double exact = bodies_[motion_.bodies[0]].alone->volume(); single && std::isfinite(exact) && exact > 0) {
      for (Vec3& row : solid.inertia) row = multiply(exact / solid.volume, row);
      solid.volume = exact;
    }
    if (given_.pivot.empty()) motion_.pivot = solid.centroid;
    motion_.restitution = given_.restitution.value_or(0);
    motion_.mass = given_.mass ? *given_.mass : *given_.density * solid.volume;
    if (given_.inertia.empty()) {
      const double density = motion_.mass / solid.volume;
      RotationMatrix central = solid.inertia;
      for (Vec3& row : central) row = multiply(density, row);
      motion_.inertia = inertia_about(central, motion_.mass, subtract(motion_.pivot, solid.centroid));
    } else if (draft_.dimensions == 2) {
      motion_.inertia = {{{1, 0, 0}, {0, 1, 0}, {0, 0, given_.inertia[0]}}};
    } else {
      for (std::size_t a = 0; a < 3; ++a) motion_.inertia[a][a] = given_.inertia[a];
    }
  }

  // What of it lies farther out has no mass that anybody knows.
  bool goes_on(std::size_t b) {
    for (std::size_t a = 0; a < static_cast<std::size_t>(draft_.dimensions); ++a) {
      if (!goes_on_beyond(draft_, bodies_[b], a, 0) && !goes_on_beyond(draft_, bodies_[b], a, 1)) continue;
      problems_.add(*draft_.node(place_of(b) + ".where"),
                    place_of(b) + ".where floats and goes on beyond the domain along " + std::string(1, "xyz"[a]) +
                        ", where nothing tells its mass; " + expected_end(draft_));
      return true;
    }
    return false;
  }

  const Draft& draft_;
  const BodyDraft& given_;
  std::string name_;
  const CompileExpression& compile_;
  std::vector<Body>& bodies_;
  Problems& problems_;
  BodyMotion motion_;
};

// What turns and shifts a shape that stands at the origin of its motion to where it is at t = 0.
Pose start_of(BodyMotion& motion) {
  Vec3 way{};
  for (std::size_t a = 0; a < 3; ++a)
    if (motion.displacement.component[a]) way[a] = (*motion.displacement.component[a])(0, 0, 0, 0);
  const double angle = motion.angle ? (*motion.angle)(0, 0, 0, 0) * std::numbers::pi / 180 : 0;
  Pose pose;
  pose.rotation = rotation_by_vector(multiply(angle, motion.axis));
  pose.position = subtract(add(motion.pivot, way), rotated(pose.rotation, motion.pivot));
  motion.pivot = add(motion.pivot, way);
  return pose;
}

// When a motion leads the end of a body into the domain that its expression has on what is looked at of it, if it does.
std::optional<double> end_enters(const Draft& draft, const BodyMotion& motion, const Body& body, std::size_t axis,
                                 int side, double duration) {
  // Equal times would meet a periodic motion in one phase.
  constexpr int times = 2000, places = 9;

  const auto d = static_cast<std::size_t>(draft.dimensions);
  Bounds own = body.alone->bounds();
  if (!std::isfinite(side == 0 ? own.lower[axis] : own.upper[axis])) return std::nullopt;
  for (std::size_t a = 0; a < d; ++a) {  // of beds that go on beyond periodic sides, what is in the domain
    if (!std::isfinite(own.lower[a])) own.lower[a] = draft.lower[a];
    if (!std::isfinite(own.upper[a])) own.upper[a] = draft.upper[a];
  }
  for (int n = 1; n <= times; ++n) {
    const double t = duration * golden_part(n);
    const RigidPlace place = given_place(motion, t);
    for (int k = 0; k < places * places; ++k) {
      const double share[] = {k % places / (places - 1.0), k / places / (places - 1.0)};
      Vec3 p{};
      for (std::size_t a = 0, other = 0; a < d; ++a) {
        const double part = a == axis ? side : share[other++];
        p[a] = own.lower[a] + part * (own.upper[a] - own.lower[a]);
      }
      p = place.now(p);
      bool within = place.scale > 0;
      for (std::size_t a = 0; a < d; ++a) within = within && p[a] > draft.lower[a] && p[a] < draft.upper[a];
      if (within) return t;
    }
  }
  return std::nullopt;
}

void check_ends(const Draft& draft, const BodyMotion& motion, const std::vector<Body>& bodies, double duration,
                Problems& problems) {
  for (const std::size_t b : motion.bodies)
    for (std::size_t a = 0; a < static_cast<std::size_t>(draft.dimensions) && bodies[b].alone; ++a)
      for (const int side : {0, 1}) {
        if (!goes_on_beyond(draft, bodies[b], a, side)) continue;
        if (const auto t = end_enters(draft, motion, bodies[b], a, side, duration))
          problems.add(*draft.node(place_of(b) + ".where"),
                       place_of(b) + ".where goes on beyond the domain along " + std::string(1, "xyz"[a]) +
                           ", and its motion leads into it, by t = " + brief(*t) + ", what is not looked at there; " +
                           expected_end(draft));
      }
}

}  // namespace

void check_body_motions(const Draft& draft, const MethodDeclaration* method, Problems& problems) {
  if (!draft.usable("body")) return;
  for (std::size_t k = 0; k < draft.bodies.size(); ++k) CheckMotion(draft, k, method, problems).check();
}

std::vector<BodyMotion> make_body_motions(const Draft& draft, const CompileExpression& compile, double duration,
                                          std::vector<Body>& bodies, Problems& problems) {
  std::vector<BodyMotion> motions;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const BodyDraft& given = draft.bodies[k];
    if (!moves_itself(given) || !given.moves_with.empty()) continue;
    MakeMotion maker(draft, k, compile, bodies, problems);
    motions.push_back(maker.make(duration));
    BodyMotion& motion = motions.back();
    const Pose start = start_of(motion);
    for (const std::size_t b : motion.bodies) {
      bodies[b].motion = motions.size() - 1;
      for (ShapePointer* shape : {&bodies[b].shape, &bodies[b].solid, &bodies[b].alone})
        if (*shape) *shape = place(*shape, start, true, draft.dimensions);
    }
    if (!motion.floats) check_ends(draft, motion, bodies, duration, problems);
  }
  return motions;
}

void carry_probes(const Draft& draft, const std::vector<Body>& bodies, std::vector<ProbeOptions>& probes,
                  Problems& problems) {
  std::vector<std::string> known;
  for (const Body& body : bodies)
    if (body.motion) known.push_back(body.name);
  for (std::size_t k = 0; k < probes.size(); ++k) {
    ProbeOptions& probe = probes[k];
    if (probe.moves_with.empty()) continue;
    const auto body = std::find_if(bodies.begin(), bodies.end(),
                                   [&](const Body& one) { return one.motion && one.name == probe.moves_with; });
    if (body != bodies.end()) {
      probe.motion = body->motion;
      continue;
    }
    const std::string name = "probe." + std::to_string(k) + ".moves_with", best = nearest(probe.moves_with, known);
    problems.add(*draft.node(name), name + " must be the name of a moving [[body]]" +
                                        (known.empty() ? ", and there is none" : ", " + words_in_words(known)) +
                                        ", found " + to_toml_string(probe.moves_with) +
                                        (best.empty() ? "" : "; did you mean \"" + best + "\"?"));
  }
}

}  // namespace spume
