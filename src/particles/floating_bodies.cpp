// SPDX-License-Identifier: MIT
#include "spume/particles/floating_bodies.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/operators/small_matrix.hpp"
#include "spume/particles/column_pressure.hpp"

namespace spume {
namespace {

RotationMatrix transposed(const RotationMatrix& m) {
  return {Vec3{m[0][0], m[1][0], m[2][0]}, Vec3{m[0][1], m[1][1], m[2][1]}, Vec3{m[0][2], m[1][2], m[2][2]}};
}

// The inertia in the axes of space of a body that has turned.
RotationMatrix turned(const RotationMatrix& rotation, const RotationMatrix& inertia) {
  return combined(combined(rotation, inertia), transposed(rotation));
}

RigidPlace turned_on(RigidPlace place, double dt) {
  place.rotation = combined(rotation_by_vector(multiply(dt, place.angular_velocity)), place.rotation);
  return place;
}

std::vector<double> multiply_square(const std::vector<double>& matrix, const std::vector<double>& x) {
  std::vector<double> result(x.size(), 0);
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = 0; j < x.size(); ++j) result[i] += matrix[i * x.size() + j] * x[j];
  return result;
}

// When a point that is `room` away, with a velocity and an acceleration away, comes there; of what is left of rounding
// never.
double time_to(double room, double velocity, double acceleration) {
  const double square = velocity * velocity - 2 * acceleration * room;
  if (square < 0) return infinite;
  const double time = 2 * room / (std::sqrt(square) - velocity);
  return time > 0 ? time : infinite;
}

Vec3 along(int axis) {
  Vec3 direction{};
  direction[axis] = 1;
  return direction;
}

// From a centre to the nearest of the places that are one beyond periodic sides.
Vec3 nearest_arm(const Domain& domain, Vec3 arm) {
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    const double period = domain.upper[axis] - domain.lower[axis];
    if (domain.periodic(axis)) arm[axis] -= period * std::round(arm[axis] / period);
  }
  return arm;
}

}  // namespace

// K - G m^-1 C.
class FloatingBodies::Coupled final : public ProjectionMatrix, public BodyCoupling {
 public:
  Coupled(const FloatingBodies& bodies, PressureOperator& liquid) : bodies_(bodies), liquid_(liquid) {}
  std::size_t size() const override { return liquid_.size(); }
  const SweepContext* context() const override { return liquid_.context(); }
  BodyCoupling* coupling() override { return this; }
  ProjectionMatrix& liquid() override { return liquid_; }
  std::vector<double> relative_response(std::span<const std::int32_t> members) const override {
    return bodies_.relative_response(members);
  }
  Dots apply(std::span<const float> x, std::span<float> y, std::span<const float> w) override {
    liquid_.apply(x, y, w);
    const std::vector<double> a = bodies_.accelerations(x, false);
    return parallel_reduce(
        y.size(), Dots{},
        [&](std::size_t first, std::size_t last) {
          Dots sum;
          for (std::size_t i = first; i < last; ++i) {
            double value = y[i];
            for (std::size_t k = 0; k < a.size(); ++k) value -= a[k] * bodies_.column_[k][i];
            y[i] = static_cast<float>(value);
            sum.wy += double{w[i]} * y[i];
            sum.yy += double{y[i]} * y[i];
          }
          return sum;
        },
        [](const Dots& one, const Dots& other) {
          return Dots{one.wy + other.wy, one.yy + other.yy};
        });
  }
  void residual(std::span<const double> q, std::span<const double> b, std::span<double> r, bool given) override {
    liquid_.residual(q, b, r, given);
    add(bodies_.accelerations(q, given), 1, r);
  }
  void subtract_product(double scale, std::span<const float> x, std::span<double> r) override {
    liquid_.subtract_product(scale, x, r);
    add(bodies_.accelerations(x, false), scale, r);
  }

 private:
  void add(const std::vector<double>& a, double scale, std::span<double> r) const {
    parallel_for(r.size(), [&](std::size_t i) {
      for (std::size_t k = 0; k < a.size(); ++k) r[i] += scale * a[k] * bodies_.column_[k][i];
    });
  }
  const FloatingBodies& bodies_;
  PressureOperator& liquid_;
};

FloatingBodies::FloatingBodies(const Scene& scene, const Resolution& resolution, BodyWalls& walls, bool centred)
    : scene_(scene),
      walls_(walls),
      forces_(scene, resolution, walls),
      centred_(centred),
      spacing_(resolution.spacing),
      contacts_at_(scene, resolution, walls) {
  for (std::size_t m = 0; m < scene.motions.size(); ++m) {
    const BodyMotion& motion = scene.motions[m];
    if (!motion.floats) continue;
    State state;
    state.place.pivot = state.place.position = motion.pivot;
    for (int axis = 0; axis < 3; ++axis) {
      if (motion.free_along[axis] != 0) freedoms_.push_back({motions_.size(), axis});
      if (motion.free_about[axis] != 0) freedoms_.push_back({motions_.size(), 3 + axis});
    }
    motions_.push_back(m);
    now_.push_back(state);
  }
  next_ = now_;
  column_.resize(freedoms_.size());
  image_pressure_.resize(freedoms_.size());
}

FloatingBodies::~FloatingBodies() = default;

void FloatingBodies::advance(double dt) {
  // An impact gives its speed whole, however long the step after it: a fifth of a step would give it by 60 %.
  const double half = (step_of_impact_ > 0 ? step_of_impact_ : dt) / 2;
  step_ = dt;
  next_ = now_;
  for (State& state : next_) {
    RigidPlace& place = state.place;
    if (centred_) {
      place.velocity = add(place.velocity, multiply(half, state.acceleration));
      place.angular_velocity = add(place.angular_velocity, multiply(half, state.angular_acceleration));
    }
    place.position = add(place.position, multiply(dt, place.velocity));
    place = turned_on(place, dt);
  }
  place_walls();
}

void FloatingBodies::place_walls() {
  for (std::size_t b = 0; b < motions_.size(); ++b) {
    const RigidPlace& place = next_[b].place;
    const double half = centred_ ? step_ / 2 : 0;
    // Velocities belong to the middles of the steps before and after.
    walls_.set_place(motions_[b], place, turned_on(place, -half), turned_on(place, centred_ ? half : step_));
  }
}

ProjectionMatrix& FloatingBodies::couple(ProjectionSolver& solver, const PressureRows& rows, Arrangement& arrangement,
                                         ParticleStore& particles, const Liquid& liquid,
                                         const BodyContacts::Surroundings& surroundings) {
  set_forces(liquid);
  set_contacts(surroundings);
  set_columns(solver, rows, arrangement, particles);
  coupled_ = std::make_unique<Coupled>(*this, solver.bind(rows, arrangement.context, arrangement.packed));
  return *coupled_;
}

void FloatingBodies::set_forces(const Liquid& liquid) {
  const std::size_t count = freedoms_.size();
  std::vector<double> mass(count * count, 0);
  given_force_.assign(count, 0);
  for (std::size_t k = 0; k < count; ++k) {
    const auto [body, axis] = freedoms_[k];
    const BodyMotion& motion = scene_.motions[motions_[body]];
    const RigidPlace& place = next_[body].place;
    const RotationMatrix inertia = turned(place.rotation, motion.inertia);
    if (axis < 3) {
      mass[k * count + k] = motion.mass;
      given_force_[k] += motion.mass * scene_.fluid.gravity[axis];
      continue;
    }
    const Vec3 momentum = rotated(inertia, place.angular_velocity);
    given_force_[k] -= cross(place.angular_velocity, momentum)[axis - 3];
    for (std::size_t j = 0; j < count; ++j)
      if (freedoms_[j].body == body && freedoms_[j].axis >= 3)
        mass[k * count + j] = inertia[static_cast<std::size_t>(axis - 3)][freedoms_[j].axis - 3];
  }
  factor_cholesky(mass.data(), static_cast<int>(count));
  inverse_mass_.assign(count * count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    double* const row = &inverse_mass_[i * count];
    row[i] = 1;
    solve_cholesky(mass.data(), static_cast<int>(count), row);
  }

  std::vector<BodyForces::PressureWeight> weights;
  std::vector<SurfaceForce> given;
  forces_.find_weights(liquid.fields, weights, given);
  // Per particle, in the order of particles: the sums below have one order.
  std::stable_sort(weights.begin(), weights.end(),
                   [](const auto& a, const auto& b) { return a.particle < b.particle; });
  particle_.clear();
  force_.clear();
  moduli_.assign(count, 0);
  for (const BodyForces::PressureWeight& weight : weights) {
    if (particle_.empty() || particle_.back() != weight.particle) {
      particle_.push_back(weight.particle);
      force_.resize(force_.size() + count, 0);
    }
    double* const sums = force_.data() + force_.size() - count;
    for (std::size_t k = 0; k < count; ++k) {
      const auto [body, axis] = freedoms_[k];
      if (scene_.bodies[static_cast<std::size_t>(weight.body)].motion != motions_[body]) continue;
      const Vec3 arm = nearest_arm(scene_.domain, subtract(weight.place, next_[body].place.position));
      const double density = liquid.fields.density(static_cast<std::size_t>(weight.particle));
      sums[k] += density * (axis < 3 ? weight.force[axis] : cross(arm, weight.force)[axis - 3]);
      moduli_[k] += density * length(weight.force) * (axis < 3 ? 1 : length(arm));
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    const auto [body, axis] = freedoms_[k];
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      if (scene_.bodies[b].motion != motions_[body]) continue;
      const Vec3 force = add(given[b].viscous, given[b].pressure),
                 torque = add(given[b].viscous_torque, given[b].pressure_torque),
                 about = subtract(torque, cross(next_[body].place.position, force));
      given_force_[k] += axis < 3 ? force[axis] : about[axis - 3];
    }
    if (liquid.potential != nullptr)
      for (std::size_t e = 0; e < particle_.size(); ++e)
        given_force_[k] -= force_[e * count + k] * (*liquid.potential)[static_cast<std::size_t>(particle_[e])];
  }
}

void FloatingBodies::set_columns(ProjectionSolver& solver, const PressureRows& rows, Arrangement& arrangement,
                                 ParticleStore& particles) {
  const std::size_t n = particles.size();
  const Images& images = arrangement.images;
  ScratchArray<double> zero(particles.scratch(), n);
  parallel_for(n, [&](std::size_t i) { zero[i] = 0; });
  for (std::size_t k = 0; k < freedoms_.size(); ++k) {
    const auto [body, axis] = freedoms_[k];
    const std::int32_t* point = images.wall_point();
    Array<double>& behind = image_pressure_[k];
    behind.resize(images.size());
    parallel_for(images.size(), [&, motion = motions_[body], axis = axis](std::size_t m) {
      behind[m] = point == nullptr || point[m] < 0 ? 0.0
                                                   : walls_.pressure_behind_unit(static_cast<std::size_t>(point[m]),
                                                                                 motion, along(axis % 3), axis >= 3);
    });
    SweepContext context = arrangement.context;
    context.image_pressure = behind.data();
    column_[k].resize(n);
    const std::span<const double> none(zero.data(), n);
    solver.bind(rows, context, arrangement.packed).residual(none, none, std::span(column_[k].data(), n), true);
    // What is given behind openings is none of the bodies' doing.
    if (context.walls != nullptr && context.walls->openings()) {
      ScratchArray<double> without(particles.scratch(), n);
      context.image_pressure = nullptr;
      solver.bind(rows, context, arrangement.packed).residual(none, none, std::span(without.data(), n), true);
      parallel_for(n, [&](std::size_t i) { column_[k][i] -= without[i]; });
    }
  }
}

void FloatingBodies::add_row(const BodyContact& contact, std::size_t motion, double sign, std::span<double> row,
                             double& speed) const {
  for (std::size_t k = 0; k < freedoms_.size(); ++k) {
    const auto [body, axis] = freedoms_[k];
    if (motions_[body] != motion) continue;
    const Vec3 arm = nearest_arm(scene_.domain, subtract(contact.point, next_[body].place.position));
    row[k] += sign * (axis < 3 ? contact.normal[axis] : cross(arm, contact.normal)[axis - 3]);
  }
  for (std::size_t body = 0; body < motions_.size(); ++body) {
    if (motions_[body] != motion) continue;
    const RigidPlace& place = next_[body].place;
    const Vec3 arm = nearest_arm(scene_.domain, subtract(contact.point, place.position));
    speed += sign * dot(contact.normal, add(place.velocity, cross(place.angular_velocity, arm)));
  }
}

// The velocity u + dt a of the next step is held to n . u >= -room / dt. What lies too near is set apart no faster than
// gravity takes back within a step.
void FloatingBodies::set_contacts(const BodyContacts::Surroundings& surroundings) {
  const std::size_t count = freedoms_.size();
  const double weight = length(scene_.fluid.gravity);
  contacts_ = contacts_at_.find(surroundings, step_);
  limits_ = {count, {}, {}};
  closing_.clear();
  limits_.row.resize(contacts_.size() * count, 0);
  held_.clear();
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const BodyContact& contact = contacts_[c];
    const std::span<double> row(&limits_.row[c * count], count);
    double speed = contact.given_speed;
    if (contact.of_point) add_row(contact, *contact.of_point, 1, row, speed);
    if (contact.of_other) add_row(contact, *contact.of_other, -1, row, speed);
    double limit = 0;
    if (step_ > 0) {
      double slowest = contact.room >= 0 ? -contact.room / step_ : std::min(-contact.room / step_, weight * step_);
      if (speed < 0 && contact.room + step_ * speed < 0) slowest = std::max(slowest, -contact.restitution * speed);
      limit = (slowest - speed) / step_;
    } else if (contact.room > 0) {
      limit = -infinite;  // at the start bodies are at rest
    }
    limits_.limit.push_back(limit);
    closing_.push_back(speed);
    if (std::find(touching_.begin(), touching_.end(), contact.key) == touching_.end()) continue;
    held_.push_back(c);
    if (!independent(inverse_mass_, limits_, held_)) held_.pop_back();
  }
  held_change_ = holding(inverse_mass_, limits_, held_);
  rounds_ = 0;
}

bool FloatingBodies::contacts_change(std::span<const double> q) {
  constexpr int most_rounds = 10;
  if (contacts_.empty()) return false;
  const std::vector<double> force = forces(q, true);
  if (is_nearest(inverse_mass_, force, limits_, held_, accelerations(q, true))) return false;
  std::vector<std::size_t> held = nearest_within(inverse_mass_, multiply_square(inverse_mass_, force), limits_).held;
  std::sort(held.begin(), held.end());
  if (held == held_) return false;
  held_ = std::move(held);
  held_change_ = holding(inverse_mass_, limits_, held_);
  return ++rounds_ < most_rounds;
}

template <class T>
std::vector<double> FloatingBodies::forces(std::span<const T> q, bool given) const {
  const std::size_t count = freedoms_.size();
  std::vector<double> force(count, 0);
  if (given) force = given_force_;
  for (std::size_t e = 0; e < particle_.size(); ++e) {
    const double value = q[static_cast<std::size_t>(particle_[e])];
    for (std::size_t k = 0; k < count; ++k) force[k] += force_[e * count + k] * value;
  }
  return force;
}

template <class T>
std::vector<double> FloatingBodies::accelerations(std::span<const T> q, bool given) const {
  std::vector<double> result = multiply_square(held_change_.change, forces(q, given));
  if (given)
    for (std::size_t k = 0; k < result.size(); ++k) result[k] += held_change_.given[k];
  return result;
}

std::vector<double> FloatingBodies::relative_response(std::span<const std::int32_t> members) const {
  const std::size_t count = freedoms_.size();
  std::vector<double> force(count, 0);
  for (std::size_t e = 0; e < particle_.size(); ++e) {
    if (!std::binary_search(members.begin(), members.end(), particle_[e])) continue;
    for (std::size_t k = 0; k < count; ++k) force[k] += force_[e * count + k];
  }
  std::vector<double> response = multiply_square(held_change_.change, force);
  for (std::size_t k = 0; k < count; ++k) {
    double most = 0;
    for (std::size_t j = 0; j < count; ++j) most += std::abs(inverse_mass_[k * count + j]) * moduli_[j];
    response[k] = most > 0 ? response[k] / most : 0;
  }
  return response;
}

void FloatingBodies::find_accelerations(std::span<const double> q, std::span<double> image_pressure) {
  const std::vector<double> found = accelerations(q, true);
  for (State& state : next_) state.acceleration = state.angular_acceleration = {};
  for (std::size_t k = 0; k < freedoms_.size(); ++k) {
    if (!std::isfinite(found[k])) {
      StepFailure::Details details;
      details.cause = "the acceleration of a floating body is not a finite number";
      details.option = "body.mass";
      details.value = found[k];
      throw StepFailure(details);
    }
    const auto [body, axis] = freedoms_[k];
    (axis < 3 ? next_[body].acceleration[axis] : next_[body].angular_acceleration[axis - 3]) = found[k];
  }
  parallel_for(image_pressure.size(), [&](std::size_t m) {
    for (std::size_t k = 0; k < found.size(); ++k) image_pressure[m] += found[k] * image_pressure_[k][m];
  });
}

// A step that is longer than the last goes on with its acceleration until the middle.
double FloatingBodies::longest_step_after(double dt) const {
  // Spacings of what stands on a wall from the start: gives way to rounding alone.
  constexpr double rounding = 1e-3;
  double longest = infinite;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    double acceleration = 0;
    for (std::size_t k = 0; k < freedoms_.size(); ++k) {
      const auto [body, axis] = freedoms_[k];
      const State& state = next_[body];
      acceleration += limits_.row[c * freedoms_.size() + k] *
                      (axis < 3 ? state.acceleration[axis] : state.angular_acceleration[axis - 3]);
    }
    const BodyContact& contact = contacts_[c];
    const double room = std::max(contact.room, 0.0) + 0.1 * std::max(contact.clearance, 0.0) + rounding * spacing_;
    const double velocity = closing_[c] + (centred_ ? dt / 2 : dt) * acceleration;
    longest = std::min(longest, time_to(room, velocity, centred_ ? acceleration : 0));
  }
  return longest;
}

void FloatingBodies::accept(double dt) {
  const double part = centred_ ? dt / 2 : dt;  // the velocities reached were those of the middle of the step
  for (State& state : next_) {
    state.place.velocity = add(state.place.velocity, multiply(part, state.acceleration));
    state.place.angular_velocity = add(state.place.angular_velocity, multiply(part, state.angular_acceleration));
  }
  now_ = next_;
  step_ = 0;
  touching_.clear();
  step_of_impact_ = 0;
  for (const std::size_t c : held_) {
    touching_.push_back(contacts_[c].key);
    // Faster than what gravity adds while a body lies there.
    if (closing_[c] < -2 * length(scene_.fluid.gravity) * dt) step_of_impact_ = dt;
  }
  longest_step_ = dt > 0 && step_of_impact_ == 0 ? longest_step_after(dt) : infinite;
  place_walls();
}

double FloatingBodies::largest_speed() const {
  double largest = 0;
  for (const std::size_t motion : motions_) largest = std::max(largest, contacts_at_.largest_speed(motion));
  return largest;
}

double FloatingBodies::kinetic_energy() const {
  double sum = 0;
  for (std::size_t b = 0; b < motions_.size(); ++b) {
    const BodyMotion& motion = scene_.motions[motions_[b]];
    const RigidPlace& place = now_[b].place;
    const Vec3 spin = rotated(transposed(place.rotation), place.angular_velocity);
    sum += (motion.mass * dot(place.velocity, place.velocity) + dot(spin, rotated(motion.inertia, spin))) / 2;
  }
  return sum;
}

double FloatingBodies::potential_energy() const {
  double sum = 0;
  for (std::size_t b = 0; b < motions_.size(); ++b)
    sum -= scene_.motions[motions_[b]].mass * dot(scene_.fluid.gravity, now_[b].place.position);
  return sum;
}

void FloatingBodies::save(StateWriter& writer) const {
  std::vector<double> values;
  for (const State& state : now_) {
    const RigidPlace& place = state.place;
    for (const Vec3* vector :
         {&place.position, &place.rotation[0], &place.rotation[1], &place.rotation[2], &place.velocity,
          &place.angular_velocity, &state.acceleration, &state.angular_acceleration})
      values.insert(values.end(), vector->begin(), vector->end());
  }
  writer.f64("floating_bodies", values);
  std::vector<std::int64_t> touching;
  for (const BodyContact::Key& key : touching_) touching.insert(touching.end(), {key.point, key.other});
  writer.i64("touching_bodies", touching);
  const double steps[] = {step_of_impact_, longest_step_};
  writer.f64("steps_at_contacts", steps);
}

void FloatingBodies::load(StateReader& reader) {
  Array<double> values;
  reader.f64("floating_bodies", values);
  if (values.size() != 24 * now_.size())
    throw FileError("the checkpoint is of another number of floating bodies than the case has");
  std::size_t at = 0;
  for (State& state : now_) {
    RigidPlace& place = state.place;
    for (Vec3* vector : {&place.position, &place.rotation[0], &place.rotation[1], &place.rotation[2], &place.velocity,
                         &place.angular_velocity, &state.acceleration, &state.angular_acceleration})
      for (double& value : *vector) value = values[at++];
  }
  Array<std::int64_t> touching;
  reader.i64("touching_bodies", touching);
  touching_.clear();
  for (std::size_t k = 0; k + 1 < touching.size(); k += 2) touching_.push_back({touching[k], touching[k + 1]});
  reader.f64("steps_at_contacts", values);
  if (values.size() != 2) throw FileError("the checkpoint has no lengths of steps with contacts");
  step_of_impact_ = values[0];
  longest_step_ = values[1];
  next_ = now_;
  step_ = 0;
  place_walls();
}

}  // namespace spume
