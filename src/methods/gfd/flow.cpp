// SPDX-License-Identifier: MIT
// What exists for a scene, and quantities of the present state.
#include "spume/methods/gfd/flow.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "spume/core/parallel.hpp"
#include "spume/particles/expected_speed.hpp"
#include "spume/scene/document.hpp"

namespace spume::gfd {
namespace {

std::vector<double> of_phases(const Scene& scene, double Phase::*property) {
  std::vector<double> values;
  for (const Phase& phase : scene.phases) values.push_back(phase.*property);
  return values;
}

bool differ(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [&](double value) { return value != values.front(); });
}

// What the gradient of a pressure does not see of it and the matrix does adds up in the pressure of implicit steps,
// which find its change. In a heavy phase that moves nothing until it acts on the light one beside it: static drops 30
// times as dense as their surroundings rest, those of 100 and 1000 times break up within two of their capillary times.
// With 0.95 of the last pressure they rest, with 0.98 they do not. Where the pressure does not need it the velocity
// would change with it by 4 % (viscous_drop, 5 times as dense, 12 across).
double share_kept(const std::vector<double>& densities) {
  constexpr double alike = 10, share = 0.95;
  const auto [least, most] = std::minmax_element(densities.begin(), densities.end());
  return *most > alike * *least ? share : 1;
}

}  // namespace

Features::Features(const LoadedCase& loaded)
    : BoundaryFeatures(loaded.scene.domain, loaded.scene.bodies, loaded.scene.openings) {
  const Scene& scene = loaded.scene;
  const Vec3& g = scene.fluid.gravity;
  interfaces = scene.phases.size() > 1;
  density_jump = differ(of_phases(scene, &Phase::density));
  tension = interfaces && scene.surface_tension > 0;
  forces = scene.body_force.has_value();
  for (int axis = 0; axis < scene.domain.dimensions; ++axis)
    if (g[axis] != 0) (scene.domain.periodic(axis) ? forces : gravity) = true;
  const std::vector<double> mu = of_phases(scene, &Phase::viscosity);
  viscosity = std::any_of(mu.begin(), mu.end(), [](double value) { return value > 0; });
  viscosity_jump = viscosity && differ(mu);
  const ShiftingOptions& shift = loaded.options.get<ShiftingOptions>();
  shifting = shift.on;
  shift_correction = shifting && shift.velocity_correction != ShiftCorrection::none;
  const std::vector<std::string>& written = loaded.options.output.fields;
  writes_diffusion = std::find(written.begin(), written.end(), diffusion_field) != written.end();
  density_relaxation = loaded.options.get<PressureOptions>().density_relaxation < never_relaxed;
}

// Where the properties vary the filtered ones lie between those of the phases: so does their ratio, up to the ratio of
// the largest viscosity to the least density of the mixture, which no particle reaches.
ViscousChoice::ViscousChoice(const LoadedCase& loaded, const Resolution& resolution) {
  constexpr double far_below = 5;
  const Scene& scene = loaded.scene;
  const TimeOptions& time = loaded.options.time;
  const LimitOptions& limits = loaded.options.get<LimitOptions>();
  double largest = 0;
  for (const Phase& phase : scene.phases) largest = std::max(largest, phase.viscosity / phase.density);
  if (!(largest > 0)) {
    reason = "inviscid";
    return;
  }
  limit = limits.diffusive * resolution.spacing * resolution.spacing / largest;
  speed = expected_speed(scene, time.end);
  if (!scene.openings.empty()) {
    reason = "explicit, beside openings";
    return;
  }
  implicit = limits.viscosity == ViscousSteps::implicit;
  reason = std::string("time.viscosity = \"") + (implicit ? "implicit" : "explicit") + '"';
  if (limits.viscosity != ViscousSteps::automatic) return;
  SmallestStep other;
  if (speed > 0) other.bound(time.courant * resolution.smoothing_length / speed, "courant, at the expected speed");
  if (scene.phases.size() > 1 && scene.surface_tension > 0)
    other.bound(limits.capillary * capillary_time(scene), "capillary");
  if (time.max_step > 0) other.bound(time.max_step, "max_step");
  if (time.end < other.limit().dt) {
    reason = "explicit: nothing in the scene tells a speed";
    return;
  }
  implicit = other.limit().dt > far_below * limit;
  reason = (implicit ? "(12) implicit" : "explicit") + std::string(": the viscous limit is ") + brief(limit) + ", " +
           (implicit ? "far below " : "beside ") + brief(other.limit().dt) + " of " + other.limit().limited_by;
}

Flow::Flow(const LoadedCase& loaded_case)
    : loaded(loaded_case),
      options(loaded_case.options),
      scene(loaded_case.scene),
      features(loaded_case),
      resolution(scene.domain.dimensions, scene.spacing, options.resolution.kernel, options.resolution.smoothing_ratio),
      dimensions(scene.domain.dimensions),
      largest_shift(
          largest_stable_shift(dimensions, options.resolution.kernel, options.resolution.smoothing_ratio, false)),
      densities(of_phases(scene, &Phase::density)),
      viscosities(of_phases(scene, &Phase::viscosity)),
      viscous(loaded_case, resolution),
      kept_pressure(share_kept(densities)),
      particles(dimensions, scene.particles),
      openings(features.openings ? std::make_unique<BufferLayers>(scene, resolution, 0, particles) : nullptr),
      boundary(scene.domain, scene.spacing, make_body_walls(scene, resolution), nullptr,
               openings == nullptr ? nullptr : &openings->gates()),
      first_volume(scene.phases.size()),
      arrangement(scene.domain, resolution, particles.volume, particles.size()),
      moments(particles,
              {.kernel_sum = true, .concentration_gradient = features.shifting, .correction = false, .fading = {}}),
      colours(colours_of(scene)),
      phase_volume(scene.phases.size()),
      solver(boundary, projection_options(options.get<PressureOptions>(), options.spacing)) {
  FieldSet& fields = particles.fields;
  pressure = &fields.add<double>("pressure", Lifetime::state);
  phase_number = &fields.add<std::int64_t>("phase", Lifetime::state);
  if (features.density_jump) last_density = &fields.add<float>("last_density", Lifetime::state);
  for (int k = 0; k < dimensions * (dimensions + 1) / 2; ++k)
    correction[static_cast<std::size_t>(k)] =
        &fields.add<float>("truncation_tensor_" + std::to_string(k), Lifetime::result);
  particles.add_vector(offset, "offset", Lifetime::result);
  laplacian_factor = &fields.add<float>("laplacian_factor", Lifetime::result);
  density = &fields.add<float>("density", Lifetime::result);
  if (features.viscosity) viscosity = &fields.add<float>("viscosity", Lifetime::result);
  if (features.writes_diffusion) particles.add_vector(diffusion, diffusion_field, Lifetime::result);
  if (features.shifting) shift = std::make_unique<Shift>(particles, resolution);
  parallel_for(size(), [&](std::size_t i) { (*phase_number)[i] = scene.particles.phase[i]; });
  if (features.density_jump)
    parallel_for(size(),
                 [&](std::size_t i) { (*last_density)[i] = static_cast<float>(densities[scene.particles.phase[i]]); });
  if (features.openings) {
    openings->fill(*phase_number, {});
    layers = std::make_unique<LayerStencils>(scene, resolution, *openings);
  }
  speeds = find_speeds(arrangement, particles);
  double g2 = 0;
  for (int axis = 0; axis < dimensions && features.gravity; ++axis)
    if (!scene.domain.periodic(axis)) g2 += scene.fluid.gravity[axis] * scene.fluid.gravity[axis];
  weight = std::sqrt(g2) * parallel_sum(size(), [&](std::size_t i) { return mass(i); });
}

double Flow::largest_speed() const {
  if (!features.openings) return speeds.largest;
  return std::sqrt(parallel_max(size(), 0.0, [&](std::size_t i) {
    return in_domain(i) ? squared_norm(particles.velocity, dimensions, i) : 0.0;
  }));
}

double Flow::kinetic_energy() const {
  return parallel_sum(size(), [&](std::size_t i) {
    return in_domain(i) ? mass(i) * squared_norm(particles.velocity, dimensions, i) / 2 : 0.0;
  });
}

double Flow::potential_energy() const {
  if (!features.gravity) return 0;
  const double at_zero = gravity_potential(Vec3{});
  return parallel_sum(size(),
                      [&](std::size_t i) { return in_domain(i) ? mass(i) * (gravity_potential(i) - at_zero) : 0.0; });
}

double Flow::energy_without_potential() const {
  return kinetic_energy() + surface_energy(colours);
}

double Flow::mass() const {
  return parallel_sum(size(), [&](std::size_t i) { return in_domain(i) ? mass(i) : 0.0; });
}

double Flow::momentum(int axis) const {
  return parallel_sum(size(),
                      [&](std::size_t i) { return in_domain(i) ? mass(i) * (*particles.velocity[axis])[i] : 0.0; });
}

bool Flow::keeps_momentum(int axis) const {
  if (!scene.domain.periodic(axis) || scene.body_force || features.bodies || features.openings ||
      scene.fluid.gravity[static_cast<std::size_t>(axis)] != 0)
    return false;
  for (int across = 0; across < dimensions; ++across)
    for (const Side& side : scene.domain.sides[static_cast<std::size_t>(across)])
      if (!scene.domain.periodic(across) && side.kind != BoundaryKind::free_slip) return false;
  return scene.domain.boxes.empty();
}

bool Flow::gains_no_energy(bool work_of_bodies_is_known) const {
  return !features.forces && !features.moving_walls && !features.openings &&
         (!features.moving_bodies || work_of_bodies_is_known);
}

double Flow::roundness() const {
  const double volume = phase_volume[1], pi = std::numbers::pi;
  const double least = dimensions == 3 ? std::cbrt(36 * pi * volume * volume) : 2 * std::sqrt(pi * volume);
  const double area = interface_area(colours);
  return area > 0 ? least / area : 1;  // a phase that has left has no interface
}

std::size_t Flow::particles_of(std::size_t n) const {
  return static_cast<std::size_t>(
      parallel_sum(size(), [&](std::size_t i) { return phase[i] == n && in_domain(i) ? 1.0 : 0.0; }));
}

void Flow::renew_layers(double dt) {
  openings->set_velocities(time, dt);
  openings->renew();
}

void Flow::sort_particles() {
  arrangement.sort(particles, particles.position);
}

void Flow::start_energy() {
  if (steps > 0) return;
  energy_supply = kinetic_energy() + potential_energy() + surface_energy(colours);
}

GfdStencils Flow::stencils() const {
  GfdStencils all;
  for (std::size_t k = 0; k < 6; ++k) all.correction[k] = correction[k] == nullptr ? nullptr : correction[k]->data();
  all.offset = read(offset);
  all.laplacian_factor = laplacian_factor->data();
  return all;
}

bool Flow::takes_viscosity_gradient() const {
  const Diffusion form = options.get<MomentumOptions>().diffusion;
  return features.viscosity_jump && (form == Diffusion::split || form == Diffusion::printed);
}

double Flow::gravity_potential(const Vec3& place) const {
  double sum = 0;
  for (int axis = 0; axis < dimensions; ++axis)
    if (!scene.domain.periodic(axis)) sum -= scene.fluid.gravity[axis] * (place[axis] - arrangement.origin[axis]);
  return sum;
}

double Flow::gravity_potential(std::size_t i) const {
  double sum = 0;
  for (int axis = 0; axis < dimensions; ++axis)
    if (!scene.domain.periodic(axis))
      sum -= scene.fluid.gravity[axis] * ((*particles.position[axis])[i] - arrangement.origin[axis]);
  return sum;
}

double Flow::hydrostatic_part(const Vec3& place, std::uint8_t of_phase) const {
  double sum = features.gravity ? -densities[of_phase] * gravity_potential(place) : 0;
  for (const Colour& colour : colours) sum += colour.mean_potential * colour.is(of_phase);
  return sum;
}

double Flow::hydrostatic_part(std::size_t i) const {
  double sum = features.gravity ? -densities[phase[i]] * gravity_potential(i) : 0;
  for (const Colour& colour : colours) sum += colour.mean_potential * colour.is(phase[i]);
  return sum;
}

// Not of a restored run, whose first reports come after the stages of the start, too.
void Flow::start_pressure() {
  if (steps > 0) return;
  parallel_for(size(), [&](std::size_t i) { (*pressure)[i] = hydrostatic_part(i); });
}

double Flow::leased_bytes() const {
  double sum = particles.fields.scratch().idle_bytes();
  const auto add = [&sum](const auto&... arrays) { ((sum += arrays.bytes()), ...); };
  for (const auto* vector : {&viscosity_gradient, &viscous_acceleration, &force_acceleration, &shift_velocity})
    for (const auto& array : *vector) add(array);
  for (const auto* vector : {&intermediate_velocity, &next_velocity})
    for (const auto& array : *vector) add(array);
  add(divergence, reduced_pressure, reciprocal_density, rows.diagonal, rows.right_hand_side, moments.kernel_sum);
  return sum;
}

}  // namespace spume::gfd
