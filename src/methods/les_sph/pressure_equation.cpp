// SPDX-License-Identifier: MIT
// The pressure equation of a step, King (3.17), for q = p + potential:
//
//   -lap q + M p = -div u* / dt + M p^n,   M = 1 / (c dt)^2  (zero when incompressible),
//
// rho = 1 here; p is divided by the density on the way in and multiplied on the way out. Rows are divided by
// d / div r, which makes the Laplacian exact for quadratic fields up to the anisotropy of the arrangement, and
// multiplied by the particle volume, which makes the matrix symmetric. p = 0 on the free surface enters by mirrored
// liquid (particles/surface.hpp); particles with too few neighbours for that hold p = 0 themselves.
#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/methods/les_sph/flow.hpp"
#include "spume/particles/number_density.hpp"

namespace spume::les_sph {
namespace {

// Of the bulk value of div r. Far below it div r tells of missing neighbours, not of the arrangement; the mirrored
// liquid makes up for those missing at a surface. The bound acts in a closed domain alone: with a surface, what is
// below its threshold, 0.78 of the bulk value, is raised to the bulk value.
constexpr double least_row_scale = 0.5;

}  // namespace

void Flow::find_divergence(double dt) {
  const std::size_t n = size();
  const double c = scene.fluid.sound_speed;
  equation = {c > 0 ? 1 / (c * c * dt * dt) : 0, -1 / dt, &divergence};
  ScratchPool& scratch = particles.scratch();
  scratch.lease(divergence, n);
  if (potential != nullptr) scratch.lease(potential_laplacian, n);
  std::optional<VelocityImageRule> predicted;
  if (features.openings) {
    boundary.give_gradients(read(advecting_velocity), read(intermediate_velocity), dt);
    predicted = boundary.predicted_rule();
  }
  divergence_sweep(arrangement.context, arrangement.packed, read(intermediate_velocity),
                   predicted ? *predicted : boundary.volume_rule(), moments.read_correction(),
                   potential == nullptr ? nullptr : potential->data(), divergence.data(),
                   potential == nullptr ? nullptr : potential_laplacian.data());
  next_max_divergence = parallel_max(n, 0.0, [&](std::size_t i) { return std::abs(divergence[i]); });
}

// Adds `factor` times tr(grad u . grad u), minus the rate of change of div u along frozen velocities, to `sum`.
void Flow::add_gradient_trace(const std::array<const double*, 3>& velocity, double factor, Array<double>& sum) {
  if (features.no_slip) {
    ScratchArray<float> trace(particles.scratch(), size());
    gradient_trace_sweep(arrangement.context, arrangement.packed, velocity, boundary.volume_rule(),
                         moments.read_correction(), trace.data());
    parallel_for(size(), [&](std::size_t i) { sum[i] += factor * trace[i]; });
    return;
  }
  parallel_for(size(), [&](std::size_t i) { sum[i] += factor * gradient_trace[i]; });
  particles.scratch().release(gradient_trace);
}

// The new velocity moves the particles from here to the next positions: it is made free of divergence half way, where
// div u = (div u here) - dt/2 tr(grad u . grad u). The step is then of second order, and a projection does not cost the
// energy dt |grad p|^2 / 2 per time.
void Flow::centre_divergence(double dt) {
  add_gradient_trace(read(advecting_velocity), -0.5 * dt, divergence);
}

void Flow::relax_density(double dt) {
  const double taken =
      even_out_density({.steps = options.get<PressureOptions>().density_relaxation,
                        .displacement = displacement,
                        .dt = dt,
                        .still = rest.share},
                       arrangement, boundary, intermediate_position, resolution, moments, surface.get(), divergence);
  volume = particles.volume * taken;
  particles.scratch().release(moments.kernel_sum);
}

// -lap p = tr(grad u . grad u), from the divergence of the momentum equation.
void Flow::set_first_source() {
  const std::size_t n = size();
  equation = {0, 1, &first_source};
  ScratchPool& scratch = particles.scratch();
  // What the step reads and the start does not: held through the solve it would be the most that a run ever holds.
  scratch.release(moments.kernel_sum);
  scratch.release(moments.concentration_gradient);
  if (surface != nullptr) surface->release_smoothed_normals(particles);
  scratch.release(velocity_gradient);
  scratch.release(filtered_velocity);
  scratch.lease(first_source, n);
  if (potential != nullptr) scratch.lease(potential_laplacian, n);
  if (features.openings) boundary.give_gradients({}, read(intermediate_velocity), 1);
  // Walls are taken to move steadily: the images of an acceleration have no part of their own.
  const VelocityImageRule steady{boundary.volume_rule().sign, {}, false, false};
  divergence_sweep(arrangement.context, arrangement.packed, read(intermediate_velocity), steady,
                   moments.read_correction(), potential == nullptr ? nullptr : potential->data(), first_source.data(),
                   potential == nullptr ? nullptr : potential_laplacian.data());
  parallel_for(n, [&](std::size_t i) { first_source[i] = -first_source[i]; });
  add_gradient_trace(read(particles.velocity), 1, first_source);
}

// V_j of (3.9), and with mixture-pressure alpha div((1/alpha) grad q), the left-hand side of King (3.17), by the
// geometric mean of 1/alpha: alpha_i / sqrt(alpha_i alpha_j).
void Flow::set_weights() {
  for (auto* array : {&rows.weight, &rows.row}) particles.scratch().lease(*array, size());
  parallel_for(size(), [&](std::size_t i) {
    const float root = bubbles->mixture_pressure() ? std::sqrt(sizes.volume_fraction[i]) : 1.0F;
    rows.weight[i] = sizes.volume_ratio[i] / root;
    rows.row[i] = root;
  });
}

void Flow::find_matrix(double dt) {
  give_pressures(time + dt);  // of the next time, as the potential is
  set_matrix();
}

void Flow::give_pressures(double t) {
  if (!features.openings) return;
  const auto potential_of_place = [&](const Vec3& r) {
    return potential_at(r) + (force_potential ? (*force_potential)(*scene.body_force, r, t) : 0.0);
  };
  boundary.give_pressures(potential_of_place, t);
}

void Flow::set_matrix() {
  const std::size_t n = size();
  ScratchPool& scratch = particles.scratch();
  scratch.release(advecting_velocity);
  if (sizes.variable) set_weights();
  for (auto* array : {&rows.diagonal_shift, &rows.diagonal}) scratch.lease(*array, n);
  rows.pressure_fixed = surface != nullptr ? &surface->pressure_fixed : nullptr;
  rows.helmholtz = equation.helmholtz;
  rows.mean_is_removed = features.closed;
  rows.closed_off = surface != nullptr && surface->closed_off;
  rows.helmholtz_scale = [this](std::size_t i) { return row_scale(i); };
  // Bodies may enclose the liquid in a domain that is open.
  const bool enclosed = surface != nullptr && !features.outflow && surface->near_surface.size() == 0;
  rows.singular = (features.closed || enclosed) && equation.helmholtz == 0;
  rows.unsymmetric = features.bodies || features.openings || sizes.variable;  // weights of bubbles
  const auto volume = static_cast<float>(particles.volume);
  parallel_for(n, [&](std::size_t i) {
    rows.diagonal_shift[i] = static_cast<float>(equation.helmholtz * row_scale(i));
    const bool fixed = surface != nullptr && surface->pressure_fixed[i] != 0;
    rows.diagonal[i] = fixed ? 0.0F : volume * (moments.laplacian_diagonal[i] + rows.diagonal_shift[i]);
  });
  if (surface != nullptr) {
    surface_source.resize(surface->near_surface.size());
    parallel_for(surface->near_surface.size(), [&](std::size_t k) {
      const auto i = static_cast<std::size_t>(surface->near_surface[k]);
      const SurfaceRow row = surface->row(moments, sizes, acceleration_in_potential(), k);
      rows.diagonal_shift[i] += static_cast<float>(row.laplacian_diagonal);
      if (surface->pressure_fixed[i] == 0) rows.diagonal[i] += static_cast<float>(volume * row.laplacian_diagonal);
      surface_source[k] = row.laplacian_diagonal * row.hydrostatic_pressure;
      if (potential != nullptr) potential_laplacian[i] -= static_cast<float>(surface_source[k]);
    });
  }
  scratch.release(moments.laplacian_diagonal);
  set_right_hand_side();
  scratch.release(divergence);
  scratch.release(first_source);
  scratch.release(potential_laplacian);
}

// What a row is multiplied by: d times as much as makes the Laplacian exact for quadratic fields.
double Flow::row_scale(std::size_t i) const {
  const double bulk = resolution.lattice.divergence_of_position;
  double div_r = std::max<double>((*moments.divergence_of_position)[i], least_row_scale * bulk);
  if (surface != nullptr) div_r += (1 - double{surface->interior_weight[i]}) * std::max(0.0, bulk - div_r);
  return div_r / dimensions;
}

// Right-hand side for q, times the volume, its norm in terms of p and that of the divergence in it.
void Flow::set_right_hand_side() {
  particles.scratch().lease(rows.right_hand_side, size());
  const Array<double>& source = *equation.source;
  struct Squares {
    double all = 0, source = 0;
  };
  const Squares squares = parallel_reduce(
      size(), Squares{},
      [&](std::size_t first, std::size_t last) {
        Squares sum;
        for (std::size_t i = first; i < last; ++i) {
          if (surface != nullptr && surface->pressure_fixed[i] != 0) {
            rows.right_hand_side[i] = 0;
            continue;
          }
          double source_factor = equation.source_scale, pressure_factor = equation.helmholtz;
          if (bubbles != nullptr && bubbles->mixture_pressure())
            source_factor *= sizes.alpha(i);
          else if (sizes.variable)
            pressure_factor *= bubbles->volume_fraction()[i] / sizes.alpha(i);
          const float scale = static_cast<float>(row_scale(i));
          const double known = (source_factor * source[i] + pressure_factor * (*pressure)[i] / density()) * scale;
          rows.right_hand_side[i] = particles.volume * (known + rows.diagonal_shift[i] * potential_of(i));
          const double in_pressure =
              particles.volume * (known - (potential == nullptr ? 0.0F : potential_laplacian[i]));
          const double of_divergence = particles.volume * source_factor * source[i] * scale;
          sum.all += in_pressure * in_pressure;
          sum.source += of_divergence * of_divergence;
        }
        return sum;
      },
      [](const Squares& a, const Squares& b) {
        return Squares{a.all + b.all, a.source + b.source};
      });
  rows.reference_norm = std::sqrt(squares.all);
  rows.source_norm = std::sqrt(squares.source);
  if (surface == nullptr) return;
  parallel_for(surface->near_surface.size(), [&](std::size_t k) {
    rows.right_hand_side[static_cast<std::size_t>(surface->near_surface[k])] += particles.volume * surface_source[k];
  });
}

void Flow::prepare_solver() {
  solver.prepare(rows, particles, intermediate_position, boundary);
}

void Flow::factorise() {
  solver.factorise(rows, solver.bind(rows, arrangement.context, arrangement.packed), particles);
}

void Flow::solve(const char* name) {
  rows.measured = steps % steps_between_measured == 0;
  if (floating != nullptr) {
    BodyForces::Fields fields(arrangement, particles, boundary.next_walls);  // where the liquid is held to
    fields.position = read(intermediate_position);
    fields.dynamic_viscosity = density() * viscosity();
    fields.density = [rho = density()](std::size_t) { return rho; };
    ProjectionMatrix& matrix =
        floating->couple(solver, rows, arrangement, particles, {fields, potential},
                         {boundary.next_walls, wall_times.ahead, boundary.absorption_at(wall_times.ahead)});
    const double norm = rows.reference_norm;
    do {
      rows.reference_norm = std::hypot(norm, given_norm(matrix, particles));
      solver.solve(rows, matrix, particles, *reduced_pressure);
    } while (floating->contacts_change(*reduced_pressure));
    floating->find_accelerations(*reduced_pressure, boundary.image_pressure());
  } else {
    PressureOperator& matrix = solver.bind(rows, arrangement.context, arrangement.packed);
    if (arrangement.context.image_pressure != nullptr)
      rows.reference_norm = std::hypot(rows.reference_norm, given_norm(matrix, particles));
    solver.solve(rows, matrix, particles, *reduced_pressure);
  }
  rows.release(particles.scratch());
  demand_convergence(solver.report(), name);
  if (!features.closed) return;
  const double mean = parallel_sum(size(), [&](std::size_t i) { return (*reduced_pressure)[i] - potential_of(i); }) /
                      static_cast<double>(std::max<std::size_t>(size(), 1));
  parallel_for(size(), [&](std::size_t i) { (*reduced_pressure)[i] -= mean; });
}

void Flow::solve_pressure() {
  // Starts from the pressure that the particle carries, where it is not fixed.
  const bool warm_start = options.get<PressureOptions>().warm_start;
  parallel_for(size(), [&](std::size_t i) {
    const bool fixed = surface != nullptr && surface->pressure_fixed[i] != 0;
    const double carried = fixed ? fixed_pressure(i) : !warm_start ? 0.0 : (*pressure)[i] / density();
    (*reduced_pressure)[i] = carried + potential_of(i);
  });
  solve("the pressure solve");
}

// 0 but where liquid that started at rest has another depth.
double Flow::fixed_pressure(std::size_t i) const {
  if (rest.lift == nullptr || surface->pressure_fixed[i] == 0) return 0;
  return (*rest.lift)[i] * length(acceleration_in_potential().at(i));
}

// As exact as `tolerance` asks: no later step makes up for what its residual leaves.
void Flow::solve_first_pressure() {
  rows.source_norm = 0;
  parallel_for(size(), [&](std::size_t i) { (*reduced_pressure)[i] = potential_of(i) + fixed_pressure(i); });
  solve("the first pressure solve");
  parallel_for(size(), [&](std::size_t i) { (*pressure)[i] = density() * ((*reduced_pressure)[i] - potential_of(i)); });
  if (acceleration[0] != nullptr) return;  // else the first acceleration reads these
  particles.scratch().release(intermediate_velocity);
  particles.scratch().release(varying_force);
}

}  // namespace spume::les_sph
