// SPDX-License-Identifier: MIT
#include "openings.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "checks.hpp"
#include "spume/core/vectors.hpp"
#include "spume/scene/expression.hpp"
#include "spume/scene/option.hpp"
#include "time_table.hpp"

namespace spume {
namespace {

namespace fs = std::filesystem;

struct Named {
  const OpeningDraft& draft;
  std::string section, name;
  bool inflow() const { return section == "inflow"; }
};

std::vector<Named> all_of(const Draft& draft) {
  std::vector<Named> all;
  for (const char* section : {"inflow", "outflow"}) {
    const auto& list = section == std::string("inflow") ? draft.inflows : draft.outflows;
    for (std::size_t k = 0; k < list.size(); ++k)
      all.push_back({list[k], section, std::string(section) + "." + std::to_string(k)});
  }
  return all;
}

double plane_of(const Draft& draft, int axis, int end) {
  return (end == 0 ? draft.lower : draft.upper)[static_cast<std::size_t>(axis)];
}

// Lower and upper end of the box of an opening along an axis.
std::array<double, 2> extent(const Draft& draft, const OpeningDraft& one, std::size_t axis) {
  return {one.lower.size() > axis ? one.lower[axis] : draft.lower[axis],
          one.upper.size() > axis ? one.upper[axis] : draft.upper[axis]};
}

class CheckOpening {
 public:
  CheckOpening(const Draft& draft, const Named& named, Problems& problems)
      : draft_(draft), one_(named.draft), named_(named), node_(*draft.node(named.name)), problems_(problems) {}

  void check() {
    given();
    if (named_.inflow()) phase();
    if (!draft_.usable(named_.name + ".side") || draft_.dimensions == 0) return;
    const auto [axis, end] = side_place(one_.side, draft_.dimensions);
    const Node& side = *draft_.node(named_.name + ".side");
    if (axis < 0) {
      problems_.add(side, named_.name + ".side: a 2-D domain has left, right, bottom, top");
      return;
    }
    if (draft_.periodic[static_cast<std::size_t>(axis)]) {
      problems_.add(side, named_.name + ".side is a side of the periodic direction " + std::string(1, "xyz"[axis]) +
                              ", which has none; choose another side");
      return;
    }
    moving(side);
    box(axis, end);
  }

 private:
  void given() {
    const auto has = [&](const char* key) { return draft_.node(named_.name + "." + key) != nullptr; };
    if (has("table") || !named_.inflow()) return;
    if (!has("velocity") && !has("flow_rate"))
      problems_.add(node_,
                    "missing key 'velocity' in [[inflow]]; add  velocity = [<expression>, ...]  or  flow_rate = "
                    "<expression>");
    if (has("velocity") && has("flow_rate"))
      problems_.add(*draft_.node(named_.name + ".flow_rate"),
                    named_.name + " has a velocity and a flow rate, which follow from each other; remove one of them");
    const auto wanted = static_cast<std::size_t>(draft_.dimensions);
    if (has("velocity") && draft_.usable(named_.name + ".velocity") && wanted > 0 && one_.velocity.size() != wanted)
      problems_.add(*draft_.node(named_.name + ".velocity"),
                    named_.name + ".velocity must have " + std::to_string(wanted) + " entries in a " +
                        std::to_string(wanted) + "-D domain, found " + std::to_string(one_.velocity.size()));
  }

  void phase() {
    std::vector<std::string> names;
    for (const Phase& phase : draft_.phases) names.push_back(phase.name);
    const Node* given = draft_.node(named_.name + ".phase");
    if (names.empty() || (given != nullptr && !draft_.usable(named_.name + ".phase"))) return;
    if (given == nullptr && names.size() > 1)
      problems_.add(node_, "missing key 'phase' in [[inflow]]; say which phase enters, " + words_in_words(names));
    if (given == nullptr || std::find(names.begin(), names.end(), one_.phase) != names.end()) return;
    problems_.add(*given, named_.name + ".phase must be the name of a phase, " + words_in_words(names) + ", found " +
                              to_toml_string(one_.phase));
  }

  void moving(const Node& side) {
    if (draft_.wall_velocity.count(one_.side))
      problems_.add(
          side, named_.name + " opens a side that domain.wall_velocity." + one_.side + " moves; remove one of the two");
    for (const WavemakerDraft& maker : draft_.wavemakers)
      if (maker.side == one_.side)
        problems_.add(side, named_.name + " opens a side that a wavemaker moves; choose another side");
  }

  void box(int axis, int end) {
    for (const char* key : {"lower", "upper"}) {
      const auto& corner = key == std::string("lower") ? one_.lower : one_.upper;
      const Node* node = draft_.node(named_.name + "." + key);
      if (node == nullptr || corner.size() == static_cast<std::size_t>(draft_.dimensions)) continue;
      problems_.add(*node, named_.name + "." + key + " must have " + std::to_string(draft_.dimensions) +
                               " entries in a " + std::to_string(draft_.dimensions) + "-D domain, found " +
                               std::to_string(corner.size()));
      return;
    }
    for (std::size_t a = 0; a < static_cast<std::size_t>(draft_.dimensions); ++a) {
      const auto [low, high] = extent(draft_, one_, a);
      const Node* at = draft_.node(named_.name + ".upper");
      const Node& node = at != nullptr ? *at : node_;
      const std::string span = std::string(1, "xyz"[a]) + " from " + brief(low) + " to " + brief(high);
      if (static_cast<int>(a) == axis) {
        const double plane = plane_of(draft_, axis, end);
        if (low > plane || high < plane)
          problems_.add(node, named_.name + " lies off its side: " + span + ", the " + one_.side + " side is at " +
                                  brief(plane) + "; let the box reach it, or leave lower and upper out");
        continue;
      }
      if (!(low < high)) {
        problems_.add(node, named_.name + ".upper must lie above " + named_.name + ".lower: " + span);
      } else if (low < draft_.lower[a] - slack(a) || high > draft_.upper[a] + slack(a)) {
        problems_.add(node, named_.name + " reaches beyond its side: " + span + ", the domain's from " +
                                brief(draft_.lower[a]) + " to " + brief(draft_.upper[a]));
      } else if (draft_.usable("resolution.spacing") && high - low < draft_.options.spacing * (1 - 1e-9)) {
        problems_.add(node, named_.name + " is narrower than a spacing: " + span + ", the spacing is " +
                                brief(draft_.options.spacing) + "; make it wider, or the spacing smaller");
      }
    }
  }
  double slack(std::size_t a) const { return 1e-9 * (draft_.upper[a] - draft_.lower[a]); }

  const Draft& draft_;
  const OpeningDraft& one_;
  const Named& named_;
  const Node& node_;
  Problems& problems_;
};

bool share_a_place(const Draft& draft, const OpeningDraft& one, const OpeningDraft& other) {
  if (one.side != other.side || one.where || other.where) return false;
  const int along = side_place(one.side, draft.dimensions).first;
  for (std::size_t a = 0; a < static_cast<std::size_t>(draft.dimensions); ++a) {
    if (static_cast<int>(a) == along) continue;  // their boxes may be flat there
    const auto first = extent(draft, one, a), second = extent(draft, other, a);
    const double slack = 1e-9 * (draft.upper[a] - draft.lower[a]);
    if (first[1] <= second[0] + slack || second[1] <= first[0] + slack) return false;
  }
  return true;
}

// Of the area of its side.
double share_of_side(const Opening& opening, const Domain& domain) {
  if (opening.where) return 0;
  double share = 1;
  for (int axis = 0; axis < domain.dimensions; ++axis)
    if (axis != opening.axis)
      share *= (opening.upper[axis] - opening.lower[axis]) / (domain.upper[axis] - domain.lower[axis]);
  return share;
}

void read_table(const Draft& draft, const Named& named, Opening& opening, Problems& problems) {
  const Node& node = *draft.node(named.name + ".table");
  const fs::path given(named.draft.table);
  const fs::path file = given.is_absolute() ? given : fs::path(draft.options.path).parent_path() / given;
  const TimeTable table = read_time_table(file.string());
  if (!table.fault.empty()) {
    problems.add(node, named.name + ".table: " + table.fault);
    return;
  }
  const auto take = [&](const std::string& column) {
    const auto found = table.columns.find(column);
    return found == table.columns.end() ? nullptr : found->second;
  };
  std::vector<std::string> known{"level"};
  if (opening.inflow) {
    VectorExpression velocity;
    for (int axis = 0; axis < draft.dimensions; ++axis) {
      const std::string column = std::string("velocity_") + "xyz"[axis];
      known.push_back(column);
      velocity.component[static_cast<std::size_t>(axis)] = take(column);
    }
    known.push_back("flow_rate");
    if (velocity.component[0] || velocity.component[1] || velocity.component[2]) opening.velocity = velocity;
    if (take("flow_rate")) opening.flow_rate = take("flow_rate");
    if (!opening.velocity && !opening.flow_rate)
      problems.add(node, named.name +
                             ".table has neither velocities nor a flow rate; give a column  flow_rate,  or "
                             "velocity_x ...");
    else if (opening.velocity && opening.flow_rate)
      problems.add(node,
                   named.name + " has a velocity and a flow rate, which follow from each other; keep one of them");
  } else {
    known.emplace_back("pressure");
    if (take("pressure")) opening.pressure = take("pressure");
  }
  if (take("level")) opening.level = take("level");
  for (const auto& [column, values] : table.columns)
    if (std::find(known.begin(), known.end(), column) == known.end()) {
      std::string names = "t";
      for (const std::string& one : known) names += ", " + one;
      problems.add(node,
                   named.name + ".table has a column '" + column + "'; those of an " + named.section + " are " + names);
    }
}

constexpr int places = 17;  // of sample() along an axis

double sampled_places(const Domain& domain) {
  return domain.dimensions == 3 ? places * places : places;
}

// Calls look(place, t) on a lattice over an opening, at the start and over the run, at 33 times.
template <class Look>
void sample(const Opening& opening, const Domain& domain, double end, Look&& look) {
  constexpr int times = 33;
  const int d = domain.dimensions;
  const int first = opening.axis == 0 ? 1 : 0;
  const int second = d == 3 ? 3 - opening.axis - first : -1;
  for (int n = 0; n < times; ++n)
    for (int i = 0; i < places; ++i)
      for (int j = 0; j < (second < 0 ? 1 : places); ++j) {
        Vec3 place = opening.lower;
        place[opening.axis] = opening.side == 0 ? domain.lower[opening.axis] : domain.upper[opening.axis];
        const auto set = [&](int axis, int k) {
          const double share = (k + 0.5) / places;
          place[axis] = opening.lower[axis] + share * (opening.upper[axis] - opening.lower[axis]);
        };
        set(first, i);
        if (second >= 0) set(second, j);
        if (opening.where && !((*opening.where)(place[0], place[1], place[2], 0) > 0)) continue;
        if (!look(place, end * n / (times - 1))) return;
      }
}

bool holds_liquid(const Scene& scene, const Vec3& place) {
  const Domain& domain = scene.domain;
  const auto holds = [&](const SolidBox& box) {
    for (int axis = 0; axis < domain.dimensions; ++axis)
      if (place[axis] < box.lower[axis] || place[axis] > box.upper[axis]) return false;
    return true;
  };
  if (std::any_of(domain.boxes.begin(), domain.boxes.end(), holds)) return false;
  return scene.walls.empty() || scene.walls.distance(place) > 0;
}

// Whether some place of it, a spacing from the next, is clear of boxes and of walls that stand still: what moves may
// let liquid in later.
bool lets_liquid_in(const Scene& scene, const Opening& opening) {
  const Domain& domain = scene.domain;
  std::array<std::size_t, 3> count{1, 1, 1};
  for (int axis = 0; axis < domain.dimensions; ++axis)
    if (axis != opening.axis)
      count[axis] = static_cast<std::size_t>(
          std::clamp(std::ceil((opening.upper[axis] - opening.lower[axis]) / scene.spacing), 1.0, 1000.0));
  for (std::size_t n = 0; n < count[0] * count[1] * count[2]; ++n) {
    const std::array<std::size_t, 3> at{n % count[0], n / count[0] % count[1], n / (count[0] * count[1])};
    Vec3 place = opening.lower;
    for (int axis = 0; axis < domain.dimensions; ++axis)
      place[axis] += (static_cast<double>(at[axis]) + 0.5) / static_cast<double>(count[axis]) *
                     (opening.upper[axis] - opening.lower[axis]);
    place[opening.axis] = opening.side == 0 ? domain.lower[opening.axis] : domain.upper[opening.axis];
    if (opening.where && !((*opening.where)(place[0], place[1], place[2], 0) > 0)) continue;
    if (holds_liquid(scene, place)) return true;
    for (const Body& body : scene.bodies)
      if (body.motion && body.solid->distance(place) <= 0) return true;
  }
  return false;
}

void check_velocity(const Draft& draft, const Scene& scene, const Opening& opening, Problems& problems) {
  const std::string key = opening.name + (opening.velocity ? ".velocity" : ".flow_rate");
  const Node& node = draft.node(key) != nullptr ? *draft.node(key) : *draft.node(opening.name);
  const double inwards = opening.side == 0 ? 1 : -1;
  bool covered = false, refused = false;
  sample(opening, scene.domain, draft.options.time.end, [&](const Vec3& place, double t) {
    covered = true;
    const double speed = opening.velocity ? inwards * (*opening.velocity)(place, t)[opening.axis]
                                          : (*opening.flow_rate)(place[0], place[1], place[2], t);
    refused = !(speed >= 0);
    // Along the side too.
    if (!std::isfinite(opening.velocity ? length((*opening.velocity)(place, t)) : speed)) {
      problems.add(node, key + " is not a finite number at t = " + brief(t));
      return false;
    }
    if (speed >= 0) return true;
    std::string where = "(" + brief(place[0]);
    for (int axis = 1; axis < scene.domain.dimensions; ++axis) where += ", " + brief(place[axis]);
    problems.add(node, key + " leads out of the domain at " + where + "), t = " + brief(t) + ": " + brief(-speed) +
                           " outwards; an inflow leads in, for liquid that leaves write an [[outflow]]");
    return false;
  });
  if (!covered)
    problems.add(draft.node(opening.name + ".where") != nullptr ? *draft.node(opening.name + ".where") : node,
                 opening.name + ".where is nowhere positive on its side; the expression is that of a place on it");
  else if (!refused && !lets_liquid_in(scene, opening))
    problems.add(*draft.node(opening.name),
                 opening.name + " lets nothing enter: solids cover all of it; move it or the solids");
}

void check_pressure(const Draft& draft, const Scene& scene, const Opening& opening, Problems& problems) {
  const std::string key = opening.name + ".pressure";
  if (!opening.pressure || draft.node(key) == nullptr) return;
  sample(opening, scene.domain, draft.options.time.end, [&](const Vec3& place, double t) {
    if (std::isfinite((*opening.pressure)(place[0], place[1], place[2], t))) return true;
    problems.add(*draft.node(key), key + " is not a finite number at t = " + brief(t));
    return false;
  });
}

// Rate at which liquid enters, at the 33 times of sample().
std::vector<double> rates_of(const Scene& scene, const Opening& opening, double end) {
  const int up = scene.domain.dimensions - 1;
  double area = 1;
  for (int axis = 0; axis < scene.domain.dimensions; ++axis)
    if (axis != opening.axis) area *= opening.upper[axis] - opening.lower[axis];
  std::vector<double> sums, counts, times;
  sample(opening, scene.domain, end, [&](const Vec3& place, double t) {
    if (times.empty() || times.back() != t) {
      times.push_back(t);
      sums.push_back(0);
      counts.push_back(0);
    }
    ++counts.back();
    const bool wet = !opening.level || place[static_cast<std::size_t>(up)] < (*opening.level)(0, 0, 0, t);
    if (opening.velocity && wet && holds_liquid(scene, place))
      sums.back() += std::abs((*opening.velocity)(place, t)[opening.axis]);
    return true;
  });
  for (std::size_t n = 0; n < times.size(); ++n) {
    const double share = opening.where ? counts[n] / sampled_places(scene.domain) : 1;
    sums[n] = opening.flow_rate ? (*opening.flow_rate)(0, 0, 0, times[n]) : share * area * sums[n] / counts[n];
  }
  return sums;
}

bool closed(const Domain& domain) {
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (const Side& side : domain.sides[axis])
      if (!side.bounds_liquid()) return false;
  return true;
}

// Of the domain, outside bodies and boxes: of at most 100 places along an axis, to 1 %.
double volume_for_liquid(const Scene& scene) {
  const Domain& domain = scene.domain;
  std::array<std::size_t, 3> count{1, 1, 1};
  Vec3 cell{1, 1, 1};
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    const double length = domain.upper[axis] - domain.lower[axis];
    count[axis] = static_cast<std::size_t>(std::clamp(length / scene.spacing, 1.0, 100.0));
    cell[axis] = length / static_cast<double>(count[axis]);
  }
  double cells = 0;
  for (std::size_t n = 0; n < count[0] * count[1] * count[2]; ++n) {
    const std::array<std::size_t, 3> at{n % count[0], n / count[0] % count[1], n / (count[0] * count[1])};
    Vec3 place{};
    for (int axis = 0; axis < domain.dimensions; ++axis)
      place[axis] = domain.lower[axis] + (static_cast<double>(at[axis]) + 0.5) * cell[axis];
    cells += holds_liquid(scene, place) ? 1 : 0;
  }
  return cells * cell[0] * cell[1] * cell[2];
}

// A closed tank with room above its liquid: what enters until the end of the run must fit.
void check_room(const Draft& draft, const Scene& scene, double particle_volume, Problems& problems) {
  const double end = draft.options.time.end;
  std::vector<double> rates;
  const Opening* first = nullptr;
  for (const Opening& opening : scene.openings) {
    if (first == nullptr) first = &opening;
    const std::vector<double> own = rates_of(scene, opening, end);
    rates.resize(std::max(rates.size(), own.size()));
    for (std::size_t n = 0; n < own.size(); ++n) rates[n] += own[n];
  }
  const double held = particle_volume * static_cast<double>(scene.particles.size());
  const double room = volume_for_liquid(scene) - held;
  double entered = 0;
  for (std::size_t n = 1; n < rates.size(); ++n) {
    const double step = end / static_cast<double>(rates.size() - 1), gained = step * (rates[n - 1] + rates[n]) / 2;
    if (!(entered + gained > room)) {
      entered += gained;
      continue;
    }
    const double full = step * (static_cast<double>(n - 1) + (room - entered) / gained);
    problems.add(*draft.node(first->name),
                 first->name + " fills the closed tank: its room of " + brief(room) + " is full at t = " + brief(full) +
                     ", the run ends at " + brief(end) +
                     "; add an [[outflow]], open a side (top = \"open\"), or end the run before");
    return;
  }
}

}  // namespace

void check_openings(const Draft& draft, Problems& problems) {
  if (!draft.usable("inflow") || !draft.usable("outflow")) return;
  const std::vector<Named> all = all_of(draft);
  for (const Named& one : all) CheckOpening(draft, one, problems).check();
  if (draft.dimensions == 0) return;
  for (std::size_t k = 0; k < all.size(); ++k)
    for (std::size_t other = 0; other < k; ++other)
      if (share_a_place(draft, all[k].draft, all[other].draft))
        problems.add(*draft.node(all[k].name + ".side"), all[k].name + " and " + all[other].name +
                                                             " share a part of the " + all[k].draft.side +
                                                             " side; give them parts of their own by lower and upper");
}

std::vector<Opening> make_openings(const Draft& draft, const CompileExpression& compile, Problems& problems) {
  std::vector<Opening> openings;
  if (draft.dimensions == 0) return openings;
  for (const Named& named : all_of(draft)) {
    const OpeningDraft& one = named.draft;
    Opening opening;
    opening.name = named.name;
    opening.inflow = named.inflow();
    const auto [axis, end] = side_place(one.side, draft.dimensions);
    if (axis < 0) continue;
    opening.axis = axis;
    opening.side = end;
    for (std::size_t n = 0; n < draft.phases.size(); ++n)
      if (draft.phases[n].name == one.phase) opening.phase = n;
    for (std::size_t a = 0; a < static_cast<std::size_t>(draft.dimensions); ++a) {
      const auto [low, high] = extent(draft, one, a);
      opening.lower[a] = low;
      opening.upper[a] = high;
    }
    const auto scalar = [&](const std::optional<ExpressionText>& text, const char* key, Arguments arguments) {
      return text ? compile(*text, named.name + "." + key, arguments) : nullptr;
    };
    opening.where = scalar(one.where, "where", Arguments::place);
    opening.flow_rate = scalar(one.flow_rate, "flow_rate", Arguments::place_and_time);
    opening.pressure = scalar(one.pressure, "pressure", Arguments::place_and_time);
    opening.level = scalar(one.level, "level", Arguments::place_and_time);
    if (!one.velocity.empty()) {
      VectorExpression velocity;
      for (std::size_t a = 0; a < one.velocity.size() && a < 3; ++a)
        velocity.component[a] =
            compile(one.velocity[a], named.name + ".velocity[" + std::to_string(a) + "]", Arguments::place_and_time);
      opening.velocity = velocity;
    }
    if (!one.table.empty()) read_table(draft, named, opening, problems);
    openings.push_back(std::move(opening));
  }
  return openings;
}

void open_sides_at(const std::vector<Opening>& openings, Domain& domain) {
  // No two share a place: several may cover a side together.
  std::array<std::array<double, 2>, 3> share{};
  for (const Opening& opening : openings)
    share[static_cast<std::size_t>(opening.axis)][static_cast<std::size_t>(opening.side)] +=
        share_of_side(opening, domain);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t end = 0; end < 2; ++end) {
      if (share[axis][end] < 1 - 1e-9) continue;
      Side& side = domain.sides[static_cast<int>(axis)][static_cast<int>(end)];
      side.kind = BoundaryKind::open;
      side.opening = true;
    }
}

void check_openings_of(const Draft& draft, const Scene& scene, double particle_volume, Problems& problems) {
  const Opening* inflow = nullptr;
  bool outflow = false;
  for (const Opening& opening : scene.openings) {
    outflow = outflow || !opening.inflow;
    if (!opening.inflow) {
      check_pressure(draft, scene, opening, problems);
      continue;
    }
    if (inflow == nullptr) inflow = &opening;
    check_velocity(draft, scene, opening, problems);
  }
  if (inflow != nullptr && !outflow && !scene.free_surface)
    problems.add(*draft.node(inflow->name),
                 inflow->name +
                     " fills a tank that is full and closed; add an [[outflow]], or leave room above the "
                     "liquid");
  else if (inflow != nullptr && !outflow && closed(scene.domain) && problems.empty())
    check_room(draft, scene, particle_volume, problems);
}

}  // namespace spume
