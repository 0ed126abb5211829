// SPDX-License-Identifier: MIT
#include "spume/particles/body_forces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/operators/moving_least_squares.hpp"
#include "spume/particles/column_pressure.hpp"
#include "spume/particles/near_particles.hpp"

namespace spume {
namespace {

// Spacings: a place before the surface that the surface itself does not hide.
constexpr double before_surface = 0.1;
// Spacings: how deep that place is in another wall that the surface lies on, but for what walls are off.
constexpr double inside_another = 0.9 * before_surface;
// Of the sum of all weights: what pins the fit of a velocity to that of a no-slip surface.
constexpr double pinned = 10;
// Of a cubic through the surface, the sum of the moduli of a slope times h: 8.8 with liquid all around, on jittered
// lattices in two and three dimensions, up to 300 where the liquid ends beside the element. In a boundary layer of four
// spacings parabolas have slopes 4 % too low and cubics 0.7 %.
constexpr double steepest = 12;
// Of a full kernel sum: less before an element is the edge of the liquid.
constexpr double wet_share = 0.5;
// Spacings: from an element to a particle that stands in the gap before it, the narrowest gap with room for one, and
// the widest in which what is caught has no pressure of its own. Bodies lie on walls with a clearance of 0.1.
constexpr double in_gap = 1, room_in_gap = 1, crushing_gap = 0.25;

constexpr std::size_t block_of_elements = 256;

// Bodies that are not always there, or not of their full size.
bool any_grows(const Scene& scene) {
  return std::any_of(scene.motions.begin(), scene.motions.end(),
                     [](const BodyMotion& motion) { return motion.release.has_value(); });
}

bool is_outside(const Domain& domain, const Vec3& place) {
  for (int axis = 0; axis < domain.dimensions; ++axis)
    if (!domain.periodic(axis) && (place[axis] < domain.lower[axis] || place[axis] > domain.upper[axis])) return true;
  return false;
}

}  // namespace

// Positions in the order of the cells.
struct BodyForces::Sorted {
  CellOrder cells;
  std::array<std::vector<double>, 3> sorted;
  std::array<const double*, 3> position{};

  Sorted(const Fields& fields, int dimensions) {
    cells.build(fields.grid, fields.position[0], fields.position[1], fields.position[2], fields.particles);
    const Array<std::int32_t>& order = cells.order();
    for (int axis = 0; axis < dimensions; ++axis) {
      sorted[axis].resize(fields.particles);
      parallel_for(fields.particles, [&, axis](std::size_t k) {
        sorted[axis][k] = fields.position[axis][static_cast<std::size_t>(order[k])];
      });
      position[axis] = sorted[axis].data();
    }
  }
};

BodyForces::Fields::Fields(const Arrangement& arrangement, const ParticleStore& store, const WallPositions& walls)
    : sides(walls),
      grid(arrangement.grid),
      particles(store.size()),
      position(read(store.position)),
      velocity(read(store.velocity)),
      particle_volume(store.volume) {}

BodyForces::BodyForces(const Scene& scene, const Resolution& resolution, const BodyWalls& walls)
    : scene_(scene),
      resolution_(resolution),
      walls_(walls),
      gravity_(gravity_across_sides(scene)),
      is_full_(!scene.free_surface && scene.openings.empty()),
      elements_(scene, walls, resolution.spacing) {}

template <int dimensions>
BodyForces::Traction BodyForces::traction(const Fields& fields, const Sorted& table, NearParticles& near,
                                          const Element& element, const Vec3& wall_velocity,
                                          std::vector<PressureWeight>* weights) const {
  const double h = resolution_.smoothing_length, reach = fit_reach * resolution_.support_radius;
  const Vec3 normal = multiply(1 / length(element.area), element.area);
  Traction found;
  struct Near {
    std::size_t particle;
    Vec3 offset;
    double weight;
  };
  const ThinWalls* thin = walls_.thin();
  const double spacing = resolution_.spacing;
  const Vec3 eye = add(element.middle, multiply(before_surface * spacing, normal));
  if (is_beyond(element.middle, fields.sides) ||
      (scene_.bodies.size() > 1 && walls_.distance(scene_.domain.inside(eye)) < -inside_another * spacing)) {
    found.before = Before::wall;
    return found;
  }
  near.find(scene_.domain, fields.grid, table.cells, table.position, element.middle, reach);
  if (near.size() == 0 && is_outside(scene_.domain, element.middle)) return found;  // of what goes on beyond open sides
  std::vector<Near> before;
  const double free = thin == nullptr ? infinite : thin->distance(eye);
  double sum = 0, covered = 0, nearest2 = infinite, least_height = infinite;
  with_plain_kernel(dimensions, resolution_.kernel, [&]<int d, class Kernel>() {
    const double scale = fields.particle_volume * Kernel::normalisation(d) / std::pow(h, d);
    for (std::size_t k = 0; k < near.size(); ++k) {
      Vec3 offset{};
      for (int axis = 0; axis < d; ++axis) offset[axis] = near.offset(axis, k);
      if (dot(offset, normal) < 0) continue;
      if (free < reach) {
        const Vec3 place = add(element.middle, offset);
        if (thin->hides(eye, free, place, thin->free_distance(place))) continue;
      }
      const double r = std::sqrt(near.r2(k)), weight = WendlandC2::w(WendlandC2::support * r / reach);
      before.push_back(
          {static_cast<std::size_t>(table.cells.order()[static_cast<std::size_t>(near.particle(k))]), offset, weight});
      sum += weight;
      nearest2 = std::min(nearest2, near.r2(k));
      least_height = std::min(least_height, dot(offset, normal));
      covered += 2 * scale * Kernel::w(r / h);
    }
  });
  MovingLeastSquares<dimensions> fit;
  const auto fill = [&](bool pin) {
    fit.resize(before.size() + (pin ? 1 : 0));
    for (std::size_t k = 0; k < before.size(); ++k) {
      for (int axis = 0; axis < dimensions; ++axis) fit.offset(axis)[k] = before[k].offset[axis] / h;
      fit.weight()[k] = before[k].weight;
    }
    if (!pin) return;
    for (int axis = 0; axis < dimensions; ++axis) fit.offset(axis)[before.size()] = 0;
    fit.weight()[before.size()] = pinned * sum;
  };
  fill(false);
  bool is_wet = covered >= wet_share;
  std::optional<double> gap;
  if (!is_wet || least_height < crushing_gap * spacing) gap = walls_.gap_before(element.middle, normal, fields.sides);
  if (is_wet && gap && *gap == 0) gap.reset();  // a fold of its own surface
  if (gap && *gap == 0) {
    found.before = Before::wall;
    return found;
  }
  is_wet = is_wet || (!gap && !before.empty() && is_free(eye, fields.sides) &&
                      covered >= wet_share * free_share(element, fields.sides));
  const int order = is_wet ? fit.fit(2) : -1;
  const bool fitted = order >= 0;
  const bool crushed = gap && *gap < crushing_gap * spacing;
  if (!fitted || crushed) {
    // In liquid that fills its domain no pressure is that of a void, and what a constant pressure does to a closed
    // surface is nothing: without its part there it had a force of any size.
    const bool has_gap = (gap && *gap < room_in_gap * spacing) || (is_full_ && floats(element));
    const bool caught = gap && std::sqrt(nearest2) < in_gap * spacing;
    found.before = crushed ? Before::gap : caught ? Before::liquid : has_gap ? Before::gap : Before::nothing;
    found.in_gap = found.before != Before::nothing;
  } else {
    found.before = Before::liquid;
  }
  if (!fitted && found.before != Before::liquid) return found;
  for (const Near& one : before) found.density += one.weight / sum * fields.density(one.particle);
  found.first_weight = weights == nullptr ? 0 : weights->size();
  const auto value = fit.value();
  for (std::size_t k = 0; k < before.size(); ++k) {
    const double share = fitted ? value[k] : before[k].weight / sum;
    if (order < 1) found.value -= share * found.density * dot(gravity_, before[k].offset);  // a mean
    if (weights != nullptr)
      weights->push_back({static_cast<std::int32_t>(before[k].particle), element.body, element.middle,
                          multiply(-share, element.area)});
    else
      found.value += share * fields.pressure(before[k].particle);
  }
  found.last_weight = weights == nullptr ? 0 : weights->size();
  found.pressure = multiply(-found.value, element.area);
  const bool holds = scene_.bodies[static_cast<std::size_t>(element.body)].wall == BoundaryKind::no_slip;
  double viscosity = fields.dynamic_viscosity;
  if (fields.viscosity != nullptr) {
    viscosity = 0;
    for (const Near& one : before) viscosity += one.weight / sum * fields.viscosity[one.particle];
  }
  if (!fitted || !(viscosity > 0) || !holds) return found;
  fill(true);
  std::array<Vec3, 3> gradient{};  // [a][b] = d u_a / d x_b
  const auto differentiate = [&](int order) {
    if (!fit.factor(order)) return false;
    for (int b = 0; b < dimensions; ++b) {
      const auto slope = fit.gradient(b, h);
      double moduli = 0;
      for (std::size_t k = 0; k < before.size(); ++k) moduli += std::abs(slope[k]);
      if (order > 2 && moduli * h > steepest) return false;
      for (int a = 0; a < dimensions; ++a) {
        double total = slope[before.size()] * wall_velocity[a];
        for (std::size_t k = 0; k < before.size(); ++k) total += slope[k] * fields.velocity[a][before[k].particle];
        gradient[a][b] = total;
      }
    }
    return true;
  };
  if (!differentiate(3) && !differentiate(2) && !differentiate(1)) return found;
  for (int a = 0; a < dimensions; ++a)
    for (int b = 0; b < dimensions; ++b)
      found.viscous[a] += viscosity * (gradient[a][b] + gradient[b][a]) * element.area[b];
  // Beside a surface that holds the liquid the rate of stretching along the normal is that of the density: none. What
  // the velocities have of it is an error of the projection, 5 % of the friction on a cylinder.
  found.viscous = subtract(found.viscous, multiply(dot(found.viscous, normal), normal));
  return found;
}

bool BodyForces::is_beyond(const Vec3& place, const WallPositions& sides) const {
  const Domain& domain = scene_.domain;
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (const std::size_t end : {0U, 1U}) {
      const double beyond = place[axis] - sides[static_cast<std::size_t>(axis)][end];
      if (is_wall(domain.sides[axis][end].kind) && (end == 0 ? beyond < 0 : beyond > 0)) return true;
    }
  return false;
}

bool BodyForces::is_free(const Vec3& place, const WallPositions& sides) const {
  return !is_beyond(place, sides) && walls_.distance(scene_.domain.inside(place)) > 0;
}

// By places of a lattice of a spacing that begins at the element.
double BodyForces::free_share(const Element& element, const WallPositions& sides) const {
  const int dimensions = scene_.domain.dimensions;
  const double spacing = resolution_.spacing;
  const Vec3 normal = multiply(1 / length(element.area), element.area);
  Vec3 least{};  // the axis that the normal is farthest from
  least[std::abs(normal[0]) < std::abs(normal[1]) ? 0 : 1] = 1;
  const Vec3 aside = dimensions == 3 ? unit(cross(normal, least)) : Vec3{-normal[1], normal[0]};
  const Vec3 across = dimensions == 3 ? cross(normal, aside) : Vec3{};
  const int most = static_cast<int>(resolution_.support_radius / spacing), most_across = dimensions == 3 ? most : 0;
  double free = 0, all = 0;
  with_plain_kernel(dimensions, resolution_.kernel, [&]<int, class Kernel>() {
    for (int i = 0; i <= most; ++i)
      for (int j = -most; j <= most; ++j)
        for (int k = -most_across; k <= most_across; ++k) {
          const Vec3 offset = add(multiply((i + 0.5) * spacing, normal),
                                  add(multiply(j * spacing, aside), multiply(k * spacing, across)));
          const double weight = Kernel::w(length(offset) / resolution_.smoothing_length);
          if (!(weight > 0)) continue;
          all += weight;
          if (is_free(add(element.middle, offset), sides)) free += weight;
        }
  });
  return free / all;
}

void BodyForces::fill_gaps(std::vector<Traction>& of, std::vector<std::vector<PressureWeight>>* weights) const {
  using Role = SurfaceElements::Role;
  std::vector<Role> role;
  std::vector<std::size_t> gaps;
  for (std::size_t e = 0; e < of.size(); ++e) {
    if (of[e].before == Before::gap) gaps.push_back(e);
    role.push_back(of[e].before == Before::gap      ? Role::seeks
                   : of[e].before == Before::liquid ? Role::source
                   : of[e].before == Before::wall   ? Role::none
                                                    : Role::end);
  }
  if (gaps.empty()) return;
  const std::vector<std::int32_t> nearest = elements_.nearest_sources(role, gaps);
  for (std::size_t k = 0; k < gaps.size(); ++k) {
    if (nearest[k] < 0) continue;
    const auto source = static_cast<std::size_t>(nearest[k]);
    const Traction& from = of[source];
    Traction& gap = of[gaps[k]];
    gap.pressure = {};  // that of what is caught there
    if (weights != nullptr) {
      std::vector<PressureWeight>& caught = (*weights)[gaps[k] / block_of_elements];
      for (std::size_t w = gap.first_weight; w < gap.last_weight; ++w) caught[w].force = {};
    }
    if (from.before != Before::liquid) continue;
    const Element own = now(elements_[gaps[k]]), other = now(elements_[source]);
    gap.value = from.value + from.density * dot(gravity_, scene_.domain.shortest(subtract(own.middle, other.middle)));
    gap.pressure = multiply(-gap.value, own.area);
    if (weights == nullptr) continue;
    const double size = dot(other.area, other.area);
    std::vector<PressureWeight>& block = (*weights)[source / block_of_elements];
    for (std::size_t w = from.first_weight; w < from.last_weight; ++w) {
      const double share = -dot(block[w].force, other.area) / size;
      block.push_back({block[w].particle, own.body, own.middle, multiply(-share, own.area)});
    }
  }
}

BodyForces::Element BodyForces::now(const Element& element) const {
  const auto body = static_cast<std::size_t>(element.body);
  if (!scene_.bodies[body].motion) return element;
  const RigidPlace& place = walls_.part_of(body).place;
  const double growth = std::pow(place.scale, scene_.domain.dimensions - 1);
  return {scene_.domain.inside(place.now(element.middle)), multiply(growth, place.direction_now(element.area)),
          element.body};
}

Vec3 BodyForces::whole_middle(std::size_t e) const {
  const RigidWalls& walls = walls_.part_of(static_cast<std::size_t>(elements_[e].body));
  return walls.motion() == nullptr ? elements_[e].middle : walls.place.now(elements_[e].middle);
}

bool BodyForces::floats(const Element& element) const {
  const auto& motion = scene_.bodies[static_cast<std::size_t>(element.body)].motion;
  return motion && scene_.motions[*motion].floats;
}

std::optional<std::size_t> BodyForces::floats_through(const WallPositions& sides) const {
  // Those that lie on each other at the start do not count.
  const double deep = 0.5 * resolution_.spacing;
  const Domain& domain = scene_.domain;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Element& element = elements_[e];
    if (!floats(element)) continue;
    const auto body = static_cast<std::size_t>(element.body);
    const RigidWalls& own = walls_.part_of(body);
    const Vec3 at = own.place.now(element.middle);
    for (int axis = 0; axis < domain.dimensions; ++axis) {
      const auto [lower, upper] = sides[static_cast<std::size_t>(axis)];
      if ((is_wall(domain.sides[axis][0].kind) && at[axis] < lower - deep) ||
          (is_wall(domain.sides[axis][1].kind) && at[axis] > upper + deep))
        return body;
    }
    for (std::size_t other = 0; other < scene_.bodies.size(); ++other) {
      const RigidWalls& walls = walls_.part_of(other);
      if (scene_.bodies[other].wall == BoundaryKind::open || &walls == &own) continue;
      if (!walls.surely_farther(at, 0) && walls.distance(at) < -deep) return body;
    }
  }
  return std::nullopt;
}

std::vector<BodyForces::Traction> BodyForces::tractions(const Fields& fields, double t,
                                                        std::vector<std::vector<PressureWeight>>* weights) const {
  std::vector<Traction> of(elements_.size());
  if (weights != nullptr) weights->resize(block_count(elements_.size(), block_of_elements));
  const Sorted table(fields, scene_.domain.dimensions);
  parallel_blocks(elements_.size(), block_of_elements, [&](std::size_t b, std::size_t first, std::size_t last) {
    // Expressions keep their variables inside: each block evaluates its own copies.
    std::vector<VectorExpression> velocity;
    for (const Body& body : scene_.bodies)
      velocity.push_back(body.velocity ? body.velocity->clone() : VectorExpression{});
    NearParticles near;
    std::vector<PressureWeight>* const own = weights == nullptr ? nullptr : &(*weights)[b];
    for (std::size_t e = first; e < last; ++e) {
      const auto body = static_cast<std::size_t>(elements_[e].body);
      if ((weights != nullptr && !floats(elements_[e])) || walls_.part_of(body).absent()) continue;
      const Element element = now(elements_[e]);
      const Vec3 wall = scene_.bodies[body].motion ? walls_.part_of(body).velocity_at(element.middle)
                                                   : velocity[body](element.middle, t);
      of[e] = scene_.domain.dimensions == 3 ? traction<3>(fields, table, near, element, wall, own)
                                            : traction<2>(fields, table, near, element, wall, own);
    }
  });
  fill_gaps(of, weights);
  return of;
}

std::vector<SurfaceForce> BodyForces::add_up(const std::vector<Traction>& of) const {
  std::vector<SurfaceForce> total(scene_.bodies.size());
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    SurfaceForce& body = total[static_cast<std::size_t>(elements_[e].body)];
    const Vec3 middle = whole_middle(e);
    body.press(middle, of[e].pressure);
    body.rub(middle, of[e].viscous);
  }
  return total;
}

// What touches a wall has no liquid before it.
void BodyForces::add_pressure(const StillLiquid& still, const WallPositions& sides,
                              std::vector<SurfaceForce>& forces) const {
  constexpr double before = 0.05;  // spacings
  for (std::size_t e = 0; still && e < elements_.size(); ++e) {
    const auto body = static_cast<std::size_t>(elements_[e].body);
    if (walls_.part_of(body).absent()) continue;
    const Element element = now(elements_[e]);
    if (!is_free(add(element.middle, multiply(before * scene_.spacing / length(element.area), element.area)), sides))
      continue;
    const double pressure = dot(still.pressure_gradient(), subtract(element.middle, still.highest));
    forces[body].press(whole_middle(e), multiply(-pressure, element.area));
  }
}

std::vector<SurfaceForce> BodyForces::measure(const Fields& fields, double t) const {
  return add_up(tractions(fields, t, nullptr));
}

void BodyForces::integrate_beside_gaps(const Fields& fields, std::vector<SurfaceForce>& forces) const {
  std::vector<std::uint8_t> near_wall(elements_.size(), 0);
  parallel_for(elements_.size(), [&](std::size_t e) {
    if (walls_.part_of(static_cast<std::size_t>(elements_[e].body)).absent()) return;
    const Element element = now(elements_[e]);
    near_wall[e] =
        walls_.gap_before(element.middle, multiply(1 / length(element.area), element.area), fields.sides) ? 1 : 0;
  });
  if (std::none_of(near_wall.begin(), near_wall.end(), [](std::uint8_t near) { return near != 0; })) return;
  const std::vector<Traction> of = tractions(fields, 0, nullptr);
  const std::vector<SurfaceForce> integrals = add_up(of);
  std::vector<std::uint8_t> has_gap(forces.size(), 0);
  for (std::size_t e = 0; e < of.size(); ++e)
    if (of[e].in_gap) has_gap[static_cast<std::size_t>(elements_[e].body)] = 1;
  for (std::size_t b = 0; b < forces.size(); ++b) {
    if (has_gap[b] == 0) continue;
    forces[b].pressure = integrals[b].pressure;
    forces[b].pressure_torque = integrals[b].pressure_torque;
  }
}

void BodyForces::find_weights(const Fields& fields, std::vector<PressureWeight>& weights,
                              std::vector<SurfaceForce>& given) const {
  std::vector<std::vector<PressureWeight>> blocks;
  given = add_up(tractions(fields, 0, &blocks));
  weights.clear();
  for (const auto& block : blocks) weights.insert(weights.end(), block.begin(), block.end());
}

RecordTable BodyForces::table() const {
  const int dimensions = scene_.domain.dimensions;
  RecordTable table;
  table.name = "bodies";
  table.title = "forces of the liquid on bodies, torques about the origin";
  table.when = RecordTable::When::series;
  table.columns = {{"t", "time"}, {"body", "number of the [[body]] entry, from 0"}};
  const auto add = [&](const std::string& name, int first, int last, const std::string& unit) {
    for (int a = first; a < last; ++a) table.columns.push_back({name + "_" + "xyz"[static_cast<std::size_t>(a)], unit});
  };
  const int about = dimensions == 3 ? 0 : 2;
  for (const char* kind : {"pressure", "viscous"})
    add(std::string(kind) + "_force", 0, dimensions, dimensions == 3 ? "force" : "force / length");
  for (const char* kind : {"pressure", "viscous"})
    add(std::string(kind) + "_torque", about, 3, dimensions == 3 ? "force length" : "force");
  if (scene_.motions.empty()) return table;
  add("position", 0, dimensions, "length");
  add("turn", about, 3, "degree");
  add("velocity", 0, dimensions, "length / time");
  add("spin", about, 3, "degree / time");
  if (any_grows(scene_)) table.columns.push_back({"scale", "1"});
  return table;
}

void BodyForces::add_rows(double t, const std::vector<SurfaceForce>& forces, std::vector<double>& rows) const {
  const int dimensions = scene_.domain.dimensions, about = dimensions == 3 ? 0 : 2;
  constexpr double degree = std::numbers::pi / 180;
  const auto add = [&](const Vec3& vector, int first, int last, double unit = 1) {
    for (int a = first; a < last; ++a) rows.push_back(vector[a] / unit);
  };
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
    if (scene_.bodies[b].wall == BoundaryKind::open) continue;
    rows.push_back(t);
    rows.push_back(static_cast<double>(b));
    for (const Vec3* force : {&forces[b].pressure, &forces[b].viscous}) add(*force, 0, dimensions);
    for (const Vec3* torque : {&forces[b].pressure_torque, &forces[b].viscous_torque}) add(*torque, about, 3);
    if (scene_.motions.empty()) continue;
    const RigidPlace& place = walls_.part_of(b).place;
    add(place.position, 0, dimensions);
    add(rotation_vector(place.rotation), about, 3, degree);
    add(place.velocity, 0, dimensions);
    add(place.angular_velocity, about, 3, degree);
    if (any_grows(scene_)) rows.push_back(place.scale);
  }
}

}  // namespace spume
