// SPDX-License-Identifier: MIT
// What exists for a scene, its equations of state, its first pressure, and quantities of the present state.
#include "spume/methods/wcsph/flow.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"

namespace spume::wcsph {
namespace {

// Sound is ten times as fast as the flow: the density changes by Ma^2 = 1 % (Monaghan 1994, Morris et al. 1997).
constexpr double sound_over_speed = 10;
// Exponents of the equation of state (Monaghan 1994; Colagrossi and Landrini 2003). A phase is a gas where its density
// is below a fiftieth of the largest: the lightest liquids have half of that of water, the heaviest gases a hundredth.
constexpr double liquid_exponent = 7, gas_exponent = 1.4, gas_density_ratio = 0.02;

double norm(const Vec3& v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

// Free fall through the domain, the work of the forces along its longest side, the walls and the first velocities.
double expected_speed_of(const LoadedCase& loaded) {
  const double given = loaded.options.get<CompressibilityOptions>().max_speed;
  if (given > 0) return given;
  const Scene& scene = loaded.scene;
  const Domain& domain = scene.domain;
  const InitialParticles& p = scene.particles;
  double speed2 = 0, length = 0;
  Vec3 centre{};
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    length = std::max(length, domain.upper[axis] - domain.lower[axis]);
    centre[axis] = (domain.lower[axis] + domain.upper[axis]) / 2;
    speed2 = std::max(speed2, 2 * std::abs(scene.fluid.gravity[axis]) * (domain.upper[axis] - domain.lower[axis]));
  }
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (const Side& side : domain.sides[axis])
      if (side.velocity) speed2 = std::max(speed2, std::pow(norm((*side.velocity)(centre, 0)), 2));
  for (const BodyMotion& motion : scene.motions)
    for (int k = 0; k <= 100; ++k) {
      const RigidPlace place = given_place(motion, loaded.options.time.end * k / 100);
      speed2 = std::max(speed2, std::pow(norm(place.velocity) + norm(place.angular_velocity) * length / 2, 2));
    }
  for (std::size_t i = 0; i < p.size(); ++i) {
    Vec3 u{}, r{};
    for (int axis = 0; axis < domain.dimensions; ++axis) {
      u[axis] = p.velocity[axis][i];
      r[axis] = p.position[axis][i];
    }
    speed2 = std::max(speed2, std::pow(norm(u), 2));
    if (scene.body_force) speed2 = std::max(speed2, 2 * length * norm((*scene.body_force)(r, 0)));
  }
  return std::sqrt(speed2);
}

std::vector<PhaseLaw> laws_of(const Scene& scene, double expected_speed) {
  std::vector<PhaseLaw> laws;
  double largest = 0;
  for (const Phase& phase : scene.phases) largest = std::max(largest, phase.density);
  for (const Phase& phase : scene.phases)
    laws.push_back({phase.density, phase.viscosity, phase.sound_speed,
                    phase.exponent > 0                            ? phase.exponent
                    : phase.density < gas_density_ratio * largest ? gas_exponent
                                                                  : liquid_exponent});
  PhaseLaw& heaviest = *std::max_element(laws.begin(), laws.end(),
                                         [](const PhaseLaw& a, const PhaseLaw& b) { return a.density < b.density; });
  if (heaviest.sound_speed == 0) heaviest.sound_speed = sound_over_speed * expected_speed;
  // The others have the stiffness B of the heaviest: sound is 14 times as fast in air as in water.
  for (PhaseLaw& law : laws)
    if (law.sound_speed == 0) law.sound_speed = std::sqrt(law.exponent * heaviest.stiffness() / law.density);
  return laws;
}

// Particles under tension clump, and pressures below zero would let them: where no hydrostatic pressure keeps them
// above it, the dynamic one does. Shifting keeps the particles apart by itself, and a background pressure would only
// drive its noise: the vortices of cases/taylor_green_wcsph decay too fast by 16 % with it and by 1.4 % without.
double background_of(const LoadedCase& loaded, const Features& features, double speed,
                     const std::vector<PhaseLaw>& laws) {
  const double given = loaded.options.get<CompressibilityOptions>().background_pressure;
  if (given >= 0) return given;
  if (features.gravity || features.shifting || loaded.scene.free_surface) return 0;
  double density = 0;
  for (const PhaseLaw& law : laws) density = std::max(density, law.density);
  return density * speed * speed;
}

Vec3 gravity_across_sides(const Scene& scene) {
  Vec3 g{};
  for (int axis = 0; axis < scene.domain.dimensions; ++axis)
    if (!scene.domain.periodic(axis)) g[axis] = scene.fluid.gravity[axis];
  return g;
}

// x^7 without a logarithm: water is most of most scenes.
double power(double x, double exponent) {
  if (exponent != liquid_exponent) return std::pow(x, exponent);
  const double x3 = x * x * x;
  return x3 * x3 * x;
}

}  // namespace

double PhaseLaw::pressure(double excess) const {
  return stiffness() * (power(1 + excess, exponent) - 1);
}
double PhaseLaw::excess(double pressure) const {
  return std::pow(1 + pressure / stiffness(), 1 / exponent) - 1;
}
// c^2 = dp / d rho = c_0^2 (1 + s)^(gamma - 1).
double PhaseLaw::local_sound_speed(double excess) const {
  return sound_speed * std::sqrt(power(1 + excess, exponent) / (1 + excess));
}

Features::Features(const LoadedCase& loaded) : BoundaryFeatures(loaded.scene.domain, loaded.scene.bodies) {
  const Scene& scene = loaded.scene;
  several = scene.phases.size() > 1;
  gravity = norm(gravity_across_sides(scene)) > 0;
  viscosity =
      std::any_of(scene.phases.begin(), scene.phases.end(), [](const Phase& phase) { return phase.viscosity > 0; });
  friction = viscosity && no_slip;
  const CompressibilityOptions& smoothing = loaded.options.get<CompressibilityOptions>();
  diffusion = smoothing.density_filter == DensityFilter::delta && smoothing.diffusion > 0;
  shepard = smoothing.density_filter == DensityFilter::shepard;
  shifting = smoothing.shifting == Shifting::on ||
             (smoothing.shifting == Shifting::automatic && !several && !scene.free_surface);
}

Flow::Flow(const LoadedCase& loaded_case)
    : loaded(loaded_case),
      options(loaded_case.options),
      scene(loaded_case.scene),
      features(loaded_case),
      resolution(scene.domain.dimensions, scene.spacing, options.resolution.kernel, options.resolution.smoothing_ratio),
      dimensions(scene.domain.dimensions),
      skin(options.get<ListOptions>().skin * scene.spacing),
      expected_speed(expected_speed_of(loaded_case)),
      laws(laws_of(scene, expected_speed)),
      background(background_of(loaded_case, features, expected_speed, laws)),
      wall_gravity(gravity_across_sides(scene)),
      particles(dimensions, scene.particles),
      boundary(scene.domain, scene.spacing, make_body_walls(scene, resolution)),
      arrangement(scene.domain, resolution, particles.volume, particles.size(), skin) {
  FieldSet& fields = particles.fields;
  particles.add_vector(acceleration, "acceleration", Lifetime::state);
  particles.add_vector(listed, "listed_position", Lifetime::state);
  if (features.shifting) particles.add_vector(shift, "shifting_velocity", Lifetime::state);
  excess = &fields.add<double>("density_excess", Lifetime::state);
  phase_number = &fields.add<std::int64_t>("phase", Lifetime::state);
  parallel_for(size(), [&](std::size_t i) {
    (*phase_number)[i] = scene.particles.phase[i];
    (*excess)[i] = 0;
    for (int axis = 0; axis < dimensions; ++axis) (*acceleration[axis])[i] = (*listed[axis])[i] = 0;
    for (int axis = 0; features.shifting && axis < dimensions; ++axis) (*shift[axis])[i] = 0;
  });
  if (features.gravity) start_density();
  find_signal();
}

// Liquid reaches round bodies: cells without particles take the mean of their row.
void Flow::fill_bodies(std::vector<double>& density, std::size_t rows) const {
  for (std::size_t row = 0; row < rows; ++row) {
    double sum = 0, count = 0;
    for (std::size_t k = row; k < density.size(); k += rows)
      if (density[k] > 0) {
        sum += density[k];
        ++count;
      }
    for (std::size_t k = row; k < density.size(); k += rows)
      if (density[k] == 0 && count > 0) density[k] = sum / count;
  }
}

// The first pressure carries the weight of what is above in a column of the width of a spacing.
void Flow::start_density() {
  const Domain& domain = scene.domain;
  const int up = dimensions - 1;
  const double g = -wall_gravity[up], side = scene.spacing;
  std::array<std::size_t, 3> cells{1, 1, 1};
  for (int axis = 0; axis < dimensions; ++axis)
    cells[axis] = static_cast<std::size_t>(std::ceil((domain.upper[axis] - domain.lower[axis]) / side)) + 1;
  const auto index = [&](int axis, std::size_t i) {
    const double k = ((*particles.position[axis])[i] - domain.lower[axis]) / side;
    return std::min(static_cast<std::size_t>(std::max(k, 0.0)), cells[axis] - 1);
  };
  const std::size_t rows = cells[up];
  const auto column = [&](std::size_t i) {
    std::size_t k = index(0, i);
    if (dimensions == 3) k = k * cells[1] + index(1, i);
    return k * rows;
  };
  std::vector<double> density(rows * cells[0] * (dimensions == 3 ? cells[1] : 1)), above(density.size());
  for (std::size_t i = 0; i < size(); ++i) density[column(i) + index(up, i)] = law(i).density;
  if (features.bodies) fill_bodies(density, rows);
  for (std::size_t first = 0; first < density.size(); first += rows)
    for (std::size_t k = rows - 1; k-- > 0;)
      above[first + k] = above[first + k + 1] + g * density[first + k + 1] * side;
  parallel_for(size(), [&](std::size_t i) {
    const std::size_t row = index(up, i);
    const double top = domain.lower[up] + side * static_cast<double>(row + 1);
    (*excess)[i] = law(i).excess(above[column(i) + row] + g * law(i).density * (top - (*particles.position[up])[i]));
  });
}

double Flow::kinetic_energy() const {
  return parallel_sum(size(),
                      [&](std::size_t i) { return mass(i) * squared_norm(particles.velocity, dimensions, i) / 2; });
}

double Flow::potential_energy() const {
  return parallel_sum(size(), [&](std::size_t i) {
    double sum = 0;
    for (int axis = 0; axis < dimensions; ++axis)
      sum -= wall_gravity[axis] * ((*particles.position[axis])[i] - arrangement.origin[axis]);
    return mass(i) * sum;
  });
}

// The integral of p / rho^2 d rho from rho_0 on, times the mass.
double Flow::compression_energy() const {
  return parallel_sum(size(), [&](std::size_t i) {
    const PhaseLaw& own = law(i);
    const double x = 1 + (*excess)[i], gamma = own.exponent;
    const double of_state = gamma == 1 ? std::log(x) : (std::pow(x, gamma - 1) - 1) / (gamma - 1);
    return particles.volume * own.stiffness() * (of_state + 1 / x - 1);
  });
}

double Flow::largest_excess(std::size_t phase_wanted) const {
  return parallel_max(size(), 0.0,
                      [&](std::size_t i) { return phase_of(i) == phase_wanted ? std::abs((*excess)[i]) : 0.0; });
}

// A mean of two viscosities is at most twice that of the particle.
double Flow::largest_kinematic_viscosity() const {
  double largest = 0;
  for (const PhaseLaw& law : laws) largest = std::max(largest, law.viscosity / law.density);
  return features.several ? 2 * largest : largest;
}

void Flow::find_signal() {
  signal = parallel_max(size(), 0.0, [&](std::size_t i) {
    return law(i).local_sound_speed((*excess)[i]) + std::sqrt(squared_norm(particles.velocity, dimensions, i));
  });
  largest_speed = std::sqrt(
      parallel_max(size(), 0.0, [&](std::size_t i) { return squared_norm(particles.velocity, dimensions, i); }));
}

std::string Flow::laws_in_words() const {
  std::string text = "(3): largest speed " + brief(expected_speed) + " m/s";
  for (std::size_t n = 0; n < laws.size(); ++n)
    text += ", sound in " + scene.phases[n].name + " " + brief(laws[n].sound_speed) + " m/s (exponent " +
            brief(laws[n].exponent) + ")";
  if (background > 0) text += ", background " + brief(background) + " Pa";
  return text;
}

double Flow::leased_bytes() const {
  double sum = particles.fields.scratch().idle_bytes();
  const auto add = [&sum](const auto&... arrays) { ((sum += arrays.bytes()), ...); };
  for (const auto* vector : {&half_velocity, &place})
    for (const auto& array : *vector) add(array);
  for (const auto* vector : {&viscous_force, &pressure_force, &way, &flux, &concentration})
    for (const auto& array : *vector) add(array);
  add(next_excess, pressure, wall_pressure, wall_density, volume, reduced_excess, rate, diffusion, carried, density,
      phase, viscosity);
  return sum;
}

}  // namespace spume::wcsph
