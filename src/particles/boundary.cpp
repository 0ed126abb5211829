// SPDX-License-Identifier: MIT
#include "spume/particles/boundary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/periodic_grid.hpp"
#include "spume/particles/pockets.hpp"

namespace spume {
namespace {

// In spacings: a particle is kept this far from a wall, since on it it would coincide with its own image. A lid-driven
// cavity at 1/40 has the same bits with 1e-4 and 1e-2; by t = 0.6 the kinetic energy of dam_break_3d at 0.03 changes by
// 0.01 % and 0.002 %.
constexpr double wall_gap = 1e-3;

std::vector<Opening> openings_of(const OpenGates* gates) {
  std::vector<Opening> openings;
  if (gates != nullptr)
    for (const OpenGate& gate : gates->list) openings.push_back(*gate.opening);
  return openings;
}

bool any_outside(const double* x, std::size_t first, std::size_t last, double lower, double upper) {
  std::int64_t outside = 0;  // as wide as the places, which the compiler then takes several at a time
  for (std::size_t i = first; i < last; ++i) outside |= x[i] > lower && x[i] < upper ? 0 : 1;
  return outside != 0;
}

}  // namespace

BoundaryKind kind_of_face(const Domain& domain, int axis, int face) {
  return face < 2 ? domain.sides[axis][face].kind : domain.boxes[static_cast<std::size_t>(face - 2) / 2].kind;
}

BoundaryFeatures::BoundaryFeatures(const Domain& domain, const std::vector<Body>& all_bodies,
                                   const std::vector<Opening>& all_openings) {
  for (const Opening& opening : all_openings) {
    openings = true;
    outflow = outflow || !opening.inflow;
  }
  for (const Body& body : all_bodies) {
    if (body.wall == BoundaryKind::open) continue;
    bodies = true;
    moving_bodies = moving_bodies || body.velocity || body.motion;
    displaced_bodies = displaced_bodies || body.motion;
    no_slip = no_slip || body.wall == BoundaryKind::no_slip;
  }
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (const Side& side : domain.sides[axis]) {
      images = images || side.kind != BoundaryKind::open;
      no_slip = no_slip || side.kind == BoundaryKind::no_slip;
      if (!side.velocity) continue;
      moving_walls = true;
      displaced_walls = displaced_walls || side.velocity->component[axis] != nullptr;
    }
  absorbing_walls = AbsorbingWalls::any(domain);
  images = images || bodies || openings || !domain.boxes.empty();
  for (const SolidBox& box : domain.boxes) no_slip = no_slip || box.kind == BoundaryKind::no_slip;
}

Boundary::Boundary(const Domain& domain, double spacing, std::unique_ptr<BodyWalls> bodies,
                   std::unique_ptr<OpenSides> openings, const OpenGates* gates)
    : features(domain, bodies == nullptr ? std::vector<Body>{} : bodies->bodies(),
               openings_of(openings != nullptr ? &openings->gates() : gates)),
      domain_(domain),
      spacing_(spacing),
      bodies_(std::move(bodies)),
      openings_(std::move(openings)),
      gates_(openings_ != nullptr ? &openings_->gates() : gates) {
  for (int axis = 0; axis < domain.dimensions; ++axis) walls[axis] = {domain.lower[axis], domain.upper[axis]};
  next_walls = walls;
  if (openings_ != nullptr) wall_speed = openings_->largest_speed();
  if (features.absorbing_walls) absorbing_ = std::make_unique<AbsorbingWalls>(domain, spacing);
  unite_solids(walls);
}

void Boundary::unite_solids(const WallPositions& at) {
  if (!domain_.boxes.empty()) solids_ = std::make_shared<const SolidUnion>(domain_, at, spacing_);
}

void Boundary::take_walls(const WallPositions& at) {
  unite_solids(at);
  if (bodies_ != nullptr) bodies_->set_sides(at);
}

void Boundary::return_walls() {
  next_walls = walls;
  if (features.displaced_walls) take_walls(walls);
}

void Boundary::advance(double t, double dt) {
  next_walls = walls;
  if (openings_ != nullptr) openings_->advance(t, dt);
  if (features.displaced_walls) move_walls(t, dt);
  // After the sides: wall points beyond them take no part.
  if (features.displaced_bodies) bodies_->move_to(t + dt);
}

void Boundary::move_walls(double t, double dt) {
  if (absorbing_ != nullptr) absorbing_->advance(t, dt);
  for (int axis = 0; axis < domain_.dimensions; ++axis)
    for (int side = 0; side < 2; ++side) {
      const auto& velocity = domain_.sides[axis][side].velocity;
      if (!velocity || velocity->component[axis] == nullptr) continue;
      Vec3 centre;
      for (std::size_t a = 0; a < 3; ++a) centre[a] = (domain_.lower[a] + domain_.upper[a]) / 2;
      centre[axis] = walls[axis][side];
      // Simpson's rule in time: exact for walls whose velocity is cubic over a step.
      const double mean = ((*velocity)(centre, t)[axis] + 4 * (*velocity)(centre, t + dt / 2)[axis] +
                           (*velocity)(centre, t + dt)[axis]) /
                          6;
      next_walls[axis][side] += mean * dt;
      if (domain_.sides[axis][side].absorption) next_walls[axis][side] += absorbing_->way(side);
    }
  take_walls(next_walls);
}

ImageRules Boundary::image_rules(double support_radius) const {
  ImageRules rules;
  rules.dimensions = domain_.dimensions;
  rules.support_radius = support_radius;
  for (int axis = 0; axis < domain_.dimensions; ++axis) {
    rules.lower[axis] = next_walls[axis][0];
    rules.upper[axis] = next_walls[axis][1];
    for (int side = 0; side < 2; ++side) {
      const BoundaryKind kind = domain_.sides[axis][side].kind;
      rules.sides[axis][side] = kind == BoundaryKind::periodic ? ImageKind::periodic
                                : is_wall(kind)                ? ImageKind::mirror
                                                               : ImageKind::none;
    }
  }
  rules.solids = solids_;
  rules.find_nearest = find_nearest_images;
  if (gates_ != nullptr)
    rules.open_at = [this](int axis, int side, const Vec3& foot) { return gates_->open_at(axis, side, foot); };
  return rules;
}

void Boundary::make_images(Arrangement& arrangement, ParticleStore& particles, const VectorField& at,
                           double largest_length_ratio, const WallTimes& times, bool find_wet) {
  const double support_radius = arrangement.grid.support_radius() * largest_length_ratio;
  const auto r = read(at);
  WallPointView wall_points;
  if (bodies_ != nullptr) {
    if (ThinWalls* thin = bodies_->thin(); thin != nullptr) {
      thin->set_sides(image_rules(support_radius));
      thin->measure(r, particles.size(), support_radius);
    }
    if (find_wet) bodies_->find_stencils(arrangement, at, particles.volume, times.velocity, times.ahead);
    wall_points = bodies_->wet();
  }
  const WallStencils* stencils = bodies_ == nullptr ? nullptr : &bodies_->stencils();
  if (openings_ != nullptr) {
    if (stencils == nullptr)
      stencils_.clear();
    else
      stencils_ = *stencils;
    for (int axis = 0; axis < domain_.dimensions; ++axis) {
      point_position_[axis].resize(wall_points.size);
      std::copy_n(wall_points.position[axis], wall_points.size, point_position_[axis].data());
    }
    openings_->find_stencils(arrangement, at, times.place, bodies_ == nullptr ? nullptr : bodies_->thin(), stencils_,
                             point_position_);
    stencils = &stencils_;
    wall_points = {.size = stencils_.size(), .source = stencils_.nearest.data()};
    for (int axis = 0; axis < domain_.dimensions; ++axis) wall_points.position[axis] = point_position_[axis].data();
  }
  const bool wet = wall_points.size > 0;
  arrangement.context.walls = wet ? stencils : nullptr;
  arrangement.images.build(image_rules(support_radius), arrangement.grid, r[0], r[1], r[2], particles.size(),
                           wet ? &wall_points : nullptr, &particles.scratch());
  if (bodies_ != nullptr) bodies_->look(arrangement.images);
  find_rules(arrangement.images, support_radius, times);
  find_image_pressure(arrangement, at, times);
}

void Boundary::move_images(Arrangement& arrangement, const std::array<const double*, 3>& at, const WallTimes& times) {
  const double support_radius = arrangement.grid.support_radius();
  const WallPointView points = bodies_ == nullptr ? WallPointView{} : bodies_->wet();
  arrangement.images.move(image_rules(support_radius), at, points.size > 0 ? &points : nullptr);
  arrangement.move(at);
  if (features.moving_walls) find_rules(arrangement.images, support_radius, times);
}

void Boundary::find_rules(const Images& images, double support_radius, const WallTimes& times) {
  const ImageRules rules = image_rules(support_radius);
  const auto& paths = images.paths();
  const int d = domain_.dimensions;
  velocity_rule_.sign.resize(paths.size());
  reflection_.resize(paths.size());
  const auto reflect = [&](std::array<float, 3>& sign, int axis, BoundaryKind kind) {
    if (kind == BoundaryKind::free_slip) sign[axis] = -sign[axis];
    if (kind == BoundaryKind::no_slip)
      for (float& s : sign) s = -s;
  };
  for (std::size_t p = 0; p < paths.size(); ++p) {
    std::array<float, 3> sign{1, 1, 1};
    for (int axis = 0; axis < d; ++axis)
      for (const int face : paths[p].face[axis])
        if (face >= 0) reflect(sign, axis, kind_of_face(domain_, axis, face));
    for (int axis = 0; axis < d; ++axis)
      if (const auto side = paths[p].side[axis]; side >= 0) reflect(sign, axis, domain_.sides[axis][side].kind);
    velocity_rule_.sign[p] = sign;
    for (int axis = 0; axis < 3; ++axis)
      reflection_[p][axis] = axis < d ? static_cast<float>(Images::sign(paths[p], rules, axis)) : 1.0F;
  }
  if (features.no_slip) mirror_rule_.sign = reflection_;
  mirror_rule_.friction = false;
  double of_points = bodies_ != nullptr ? bodies_->largest_speed() : 0;
  if (openings_ != nullptr) of_points = std::max(of_points, openings_->largest_speed());
  if (bodies_ != nullptr || openings_ != nullptr) next_wall_speed = of_points;
  if (!features.moving_walls) return;
  find_offsets(images, times.velocity, true, velocity_rule_);
  if (features.no_slip && features.displaced_walls) find_offsets(images, times.velocity, false, mirror_rule_);
  // An image behind a wall moves with twice the velocity of the wall.
  const double of_images = 0.5 * std::sqrt(parallel_max(images.size(), 0.0, [&](std::size_t k) {
                             double speed2 = 0;
                             for (int a = 0; a < d; ++a) {
                               const double u = velocity_rule_.offset[a][k];
                               speed2 += u * u;
                             }
                             return speed2;
                           }));
  next_wall_speed = std::max(of_images, of_points);
  if (std::isfinite(of_images)) return;
  StepFailure::Details details;
  details.cause = "the velocity of a wall is not a finite number";
  details.option = "domain.wall_velocity";
  details.value = of_images;
  throw StepFailure(details);
}

// What moving walls add to the velocities of images at time t; with friction no-slip walls along their planes too.
void Boundary::find_offsets(const Images& images, double t, bool friction, VelocityImageRule& rule) const {
  const int d = domain_.dimensions;
  const std::size_t m = images.size();
  for (int axis = 0; axis < d; ++axis) rule.offset[axis].resize(m);
  parallel_blocks(m, 4096, [&](std::size_t, std::size_t first, std::size_t last) {
    // Expressions keep their variables inside: each block evaluates its own copies.
    std::array<std::array<VectorExpression, 2>, 3> velocity;
    for (int axis = 0; axis < d; ++axis)
      for (int side = 0; side < 2; ++side)
        if (domain_.sides[axis][side].velocity) velocity[axis][side] = domain_.sides[axis][side].velocity->clone();
    for (std::size_t k = first; k < last; ++k) {
      std::array<double, 3> offset{};
      const ImagePath& path = images.paths()[static_cast<std::size_t>(images.path()[k])];
      const auto reflect = [&](int axis, int face) {
        const bool side = face < 2;  // of the domain; boxes stand still
        const bool holds = friction && kind_of_face(domain_, axis, face) == BoundaryKind::no_slip;
        Vec3 wall{};
        if (side && domain_.sides[axis][face].velocity) {
          Vec3 foot{};
          for (int a = 0; a < d; ++a) foot[a] = images.position(a)[k];
          foot[axis] = next_walls[axis][face];
          wall = with_correction(velocity[axis][face](foot, t), axis, face, t);
        }
        for (int a = 0; a < d; ++a)
          if (holds || a == axis) offset[a] = 2 * wall[a] - offset[a];
      };
      for (int axis = 0; axis < d; ++axis) {
        for (const int face : path.face[axis])
          if (face >= 0) reflect(axis, face);
        const auto side = path.side[axis];
        if (side >= 0 && is_wall(domain_.sides[axis][side].kind)) reflect(axis, side);
      }
      for (int a = 0; a < d; ++a) rule.offset[a][k] = static_cast<float>(offset[a]);
    }
  });
}

// Behind a wall with the acceleration a, as Du/Dt = -grad q demands: q_k = q - a . (r_k - r), r being the place that
// the image mirrors. Mirrored as they are, pressures leave the row of particles at such a wall with half of its
// gradient.
void Boundary::find_image_pressure(Arrangement& arrangement, const VectorField& at, const WallTimes& times) {
  const double duration = times.ahead - times.velocity;
  arrangement.context.image_pressure = nullptr;
  if (!displaces() || !(duration > 0)) return;
  const Images& images = arrangement.images;
  const int d = domain_.dimensions;
  image_pressure_.resize(images.size());
  std::array<std::array<double, 2>, 3> acceleration{};
  for (int axis = 0; axis < d; ++axis)
    for (int side = 0; side < 2; ++side) {
      const auto& velocity = domain_.sides[axis][side].velocity;
      if (!velocity || velocity->component[axis] == nullptr) continue;
      Vec3 middle;
      for (std::size_t a = 0; a < 3; ++a) middle[a] = (domain_.lower[a] + domain_.upper[a]) / 2;
      middle[axis] = next_walls[axis][side];
      acceleration[axis][side] = (wall_velocity(axis, side, middle, times.ahead)[axis] -
                                  wall_velocity(axis, side, middle, times.velocity)[axis]) /
                                 duration;
    }
  const auto r = read(at);
  const std::int32_t* point = bodies_ == nullptr ? nullptr : images.wall_point();
  const Array<double>* behind = bodies_ == nullptr ? nullptr : &bodies_->pressure_behind();
  parallel_for(images.size(), [&](std::size_t k) {
    const bool of_point = point != nullptr && point[k] >= 0;
    const auto g = static_cast<std::size_t>(of_point ? point[k] : 0);
    double sum = of_point && g < behind->size() ? (*behind)[g] : 0;
    const ImagePath& path = images.paths()[static_cast<std::size_t>(images.path()[k])];
    for (int axis = 0; axis < d && features.displaced_walls; ++axis)
      if (const auto side = path.side[axis]; side >= 0 && acceleration[axis][side] != 0) {
        const double from = of_point ? point_place(g, axis) : r[axis][images.source()[k]];
        sum -= acceleration[axis][side] * (images.position(axis)[k] - from);
      }
    image_pressure_[k] = sum;
  });
  arrangement.context.image_pressure = image_pressure_.data();
}

double Boundary::point_place(std::size_t g, int axis) const {
  return openings_ != nullptr ? point_position_[axis][g] : bodies_->wet().position[axis][g];
}

VelocityImageRule Boundary::predicted_rule() const {
  VelocityImageRule rule = volume_rule();
  rule.before_pressure = true;
  return rule;
}

// A side with openings holds back what is not before an outflow.
void Boundary::keep_before_sides(const WallPositions& at, int axis, Vec3& position, Vec3* velocity) const {
  const double tiny = wall_gap * spacing_, lower = at[axis][0], upper = at[axis][1];
  double& x = position[axis];
  const auto holds = [&](int side) {
    if (gates_->outflow_at(axis, side, position)) return false;
    const Side& of = domain_.sides[axis][side];
    return is_wall(of.kind) || of.opening || gates_->open_at(axis, side, position);
  };
  if (x < lower + tiny && holds(0)) {
    x = std::clamp(2 * lower - x, lower + tiny, upper);
    if (velocity != nullptr) (*velocity)[axis] = std::max((*velocity)[axis], 0.0);
  } else if (x > upper - tiny && holds(1)) {
    x = std::clamp(2 * upper - x, lower, upper - tiny);
    if (velocity != nullptr) (*velocity)[axis] = std::min((*velocity)[axis], 0.0);
  }
}

bool Boundary::holds(int axis, int side) const {
  if (is_wall(domain_.sides[axis][side].kind)) return true;
  if (gates_ == nullptr || !domain_.sides[axis][side].opening) return false;
  Vec3 middle;
  for (std::size_t a = 0; a < 3; ++a) middle[a] = (domain_.lower[a] + domain_.upper[a]) / 2;
  return !gates_->outflow_at(axis, side, middle);
}

// Ways across thin bodies count, and solids have no such bound. Wedges reach farther than a gap.
bool Boundary::has_no_quick_bound() const {
  return solids_ != nullptr || gates_ != nullptr || (bodies_ != nullptr && bodies_->thin() != nullptr);
}

bool Boundary::clear_of_bodies(const Vec3& place) const {
  return bodies_ == nullptr || bodies_->surely_farther(place, narrowest_wedge * spacing_);
}

bool Boundary::clear_of_sides(const Vec3& place) const {
  if (has_no_quick_bound()) return false;
  for (int axis = 0; axis < domain_.dimensions; ++axis)
    if (!(place[axis] > walls[axis][0] + gap() && place[axis] < walls[axis][1] - gap())) return false;
  return clear_of_bodies(place);
}

bool Boundary::clear_of_sides(const WallPositions& at, const std::array<const double*, 3>& places, std::size_t first,
                              std::size_t last) const {
  if (has_no_quick_bound()) return false;
  for (int axis = 0; axis < domain_.dimensions; ++axis)
    if (!domain_.periodic(axis) && any_outside(places[axis], first, last, at[axis][0] + gap(), at[axis][1] - gap()))
      return false;
  for (std::size_t i = first; i < last && bodies_ != nullptr; ++i) {
    Vec3 place{};
    for (int axis = 0; axis < domain_.dimensions; ++axis) place[axis] = places[axis][i];
    if (!clear_of_bodies(place)) return false;
  }
  return true;
}

void Boundary::go_round(const WallPositions& at, const std::array<double*, 3>& places, std::size_t first,
                        std::size_t last) const {
  for (int axis = 0; axis < domain_.dimensions; ++axis) {
    const double lower = at[axis][0], upper = at[axis][1];
    if (!domain_.periodic(axis) || !any_outside(places[axis], first, last, lower, upper)) continue;
    for (std::size_t i = first; i < last; ++i) places[axis][i] = wrap_periodic(places[axis][i], lower, upper - lower);
  }
}

void Boundary::apply_walls(const WallPositions& at, Vec3& position, Vec3* velocity, const Vec3* from) const {
  const double tiny = wall_gap * spacing_;
  if (from != nullptr && bodies_ != nullptr && bodies_->thin() != nullptr)
    bodies_->keep_before_thin(*from, position, velocity, tiny);
  for (int axis = 0; axis < domain_.dimensions; ++axis) {
    double& x = position[axis];
    const double lower = at[axis][0], upper = at[axis][1];
    if (gates_ != nullptr && !domain_.periodic(axis)) {
      keep_before_sides(at, axis, position, velocity);
      continue;
    }
    if (domain_.periodic(axis)) {
      x = wrap_periodic(x, lower, upper - lower);
      continue;
    }
    // Reflected, and never so far back that a fast particle crosses the domain.
    if (x < lower + tiny && is_wall(domain_.sides[axis][0].kind)) {
      x = std::clamp(2 * lower - x, lower + tiny, lower + domain_.upper[axis] - domain_.lower[axis]);
      if (velocity != nullptr) (*velocity)[axis] = std::max((*velocity)[axis], 0.0);
    } else if (x > upper - tiny && is_wall(domain_.sides[axis][1].kind)) {
      x = std::clamp(2 * upper - x, upper - domain_.upper[axis] + domain_.lower[axis], upper - tiny);
      if (velocity != nullptr) (*velocity)[axis] = std::min((*velocity)[axis], 0.0);
    }
  }
  if (bodies_ != nullptr) bodies_->keep_outside(position, velocity, wall_gap * spacing_);
  if (solids_ == nullptr || !solids_->inside(position)) return;
  // Out through the nearest face, as far before it as it was behind, unless another solid is there.
  const Vec3 foot = solids_->nearest_free(position, 0);
  Vec3 outward{}, before = foot, reflected = foot;
  for (int axis = 0; axis < domain_.dimensions; ++axis) {
    const double depth = foot[axis] - position[axis];
    if (depth == 0) continue;
    outward[axis] = depth > 0 ? 1 : -1;
    before[axis] += outward[axis] * tiny;
    reflected[axis] += depth + outward[axis] * tiny;
  }
  position = solids_->inside(reflected) ? before : reflected;
  if (velocity == nullptr) return;
  for (int axis = 0; axis < domain_.dimensions; ++axis)
    if ((*velocity)[axis] * outward[axis] < 0) (*velocity)[axis] = 0;
}

void Boundary::hold_liquid(const WallPositions& at, Vec3& position, Vec3* velocity, const Vec3* from,
                           const Vec3* wedge_from) const {
  apply_walls(at, position, velocity, from);
  if (bodies_ == nullptr) return;
  const Vec3 held = position;
  lead_out_of_wedges(*this, position, velocity, wedge_from != nullptr ? wedge_from : from);
  // Out of a wedge beside one side may be behind another.
  for (int axis = 0; axis < domain_.dimensions && position != held; ++axis) {
    if (domain_.periodic(axis)) position[axis] = wrap_periodic(position[axis], at[axis][0], at[axis][1] - at[axis][0]);
    if (is_wall(domain_.sides[axis][0].kind)) position[axis] = std::max(position[axis], at[axis][0] + gap());
    if (is_wall(domain_.sides[axis][1].kind)) position[axis] = std::min(position[axis], at[axis][1] - gap());
  }
}

double Boundary::gap() const {
  return wall_gap * spacing_;
}

double Boundary::bytes() const {
  double sum =
      (bodies_ == nullptr ? 0 : bodies_->bytes()) + (openings_ == nullptr ? 0 : openings_->bytes() + stencils_.bytes());
  for (const auto* rule : {&velocity_rule_, &mirror_rule_})
    for (const auto& array : rule->offset) sum += array.bytes();
  return sum + image_pressure_.bytes();
}

void Boundary::save_walls(StateWriter& writer) const {
  std::array<double, 6> all{};
  for (std::size_t axis = 0; axis < 3; ++axis) std::copy_n(walls[axis].data(), 2, all.data() + 2 * axis);
  writer.f64("walls", all);
  if (absorbing_ != nullptr) absorbing_->save(writer);
}

void Boundary::load_walls(StateReader& reader, double t) {
  Array<double> all;
  reader.f64("walls", all);
  if (all.size() != 6) throw FileError("the checkpoint was written by another version of the method");
  for (std::size_t axis = 0; axis < 3; ++axis) walls[axis] = {all[2 * axis], all[2 * axis + 1]};
  if (absorbing_ != nullptr) absorbing_->load(reader, t);
  return_walls();
  if (features.displaced_bodies) bodies_->move_to(t);
  if (bodies_ != nullptr) bodies_->accept();
}

bool inside_solid(const Domain& domain, const Vec3& point) {
  return std::any_of(domain.boxes.begin(), domain.boxes.end(), [&](const SolidBox& box) {
    for (int axis = 0; axis < domain.dimensions; ++axis)
      if (point[axis] <= box.lower[axis] || point[axis] >= box.upper[axis]) return false;
    return true;
  });
}

}  // namespace spume
