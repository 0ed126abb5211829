// SPDX-License-Identifier: MIT
// Every term is the size of an array per particle, in the order in which the stage comes to it.
#include "spume/methods/les_sph/traffic.hpp"

#include <variant>

namespace spume::les_sph::traffic {
namespace {

// Sizes per particle of vectors, symmetric matrices and gradients.
struct Sizes {
  explicit Sizes(const Liquid& liquid)
      : d(liquid.dimensions), vector(8 * d), float_vector(4 * d), symmetric(2 * d * (d + 1)), gradient(4 * d * d) {}
  double d;
  double vector, float_vector;  // of doubles and of floats
  double symmetric, gradient;   // of floats
};

double times(const Liquid& liquid, double per_particle) {
  return static_cast<double>(liquid.size()) * per_particle;
}

double per_value(const FieldSet::Field& field) {
  return std::visit([](const auto& array) { return static_cast<double>(sizeof(array[0])); }, field.values);
}

}  // namespace

double move(const Liquid& liquid) {
  return times(liquid, 3 * Sizes(liquid).vector);
}

double sort(const Liquid& liquid) {
  double permuted = 0;
  if (!liquid.table.already_sorted())
    for (const auto& field : liquid.fields.fields())
      if (field->lifetime == Lifetime::carried) permuted += 2 * per_value(*field) + 4;
  return liquid.table.build_traffic() + times(liquid, permuted);
}

// Coordinates are written in float and gathered from by way of the cells; lists are written once, with their sizes.
double neighbours(const Liquid& liquid) {
  const auto points = static_cast<double>(liquid.list.points());
  const auto cells = static_cast<double>(liquid.grid.cell_count()) * (liquid.images.size() > 0 ? 2 : 1);
  const Sizes size(liquid);
  return points * (size.vector + 2 * size.float_vector) + 4 * cells + 4 * static_cast<double>(liquid.list.entries()) +
         times(liquid, 12 + (liquid.varying ? 4 : 0));
}

double geometry(Liquid& liquid) {
  const Sizes size(liquid);
  double written = size.symmetric + 1 + 4 + 4;  // correction, whether there is one, div r, coupling
  if (liquid.kernel_sum != nullptr) written += 4;
  if (liquid.plan.shifting) written += size.float_vector;
  if (liquid.plan.free_surface) written += size.float_vector;
  return liquid.records.take_traffic() + times(liquid, written + (liquid.varying ? 8 : 0));
}

double shift(Liquid& liquid) {
  const Sizes size(liquid);
  double chosen = 2 * size.float_vector + (liquid.plan.free_surface ? 1 : 0) + (liquid.varying ? 12 : 0);
  // Filtered: packed, once more as the centre, written; then subtracted.
  if (liquid.plan.drift_removal) chosen += 3 * size.float_vector + 3 * size.float_vector;
  return liquid.records.take_traffic() + times(liquid, chosen);
}

double gradients(Liquid& liquid) {
  const Sizes size(liquid);
  double moved = size.vector + size.symmetric + 4;  // strain
  if (liquid.gradient_trace != nullptr && liquid.options.get<SchemeOptions>().centred) moved += 4;
  if (liquid.plan.stored_gradient) moved += size.gradient;
  if (liquid.plan.test_filter) moved += size.float_vector;
  if (liquid.plan.shift_correction) moved += 2 * size.float_vector;
  return liquid.records.take_traffic() + times(liquid, moved + (liquid.varying ? 8 : 0));
}

double shift_curvature(Liquid& liquid) {
  const Sizes size(liquid);
  return liquid.records.take_traffic() +
         times(liquid, size.gradient + size.float_vector + size.symmetric + 2 * size.float_vector);
}

double eddy_viscosity(Liquid& liquid) {
  const Sizes size(liquid);
  const TurbulenceModel model = liquid.options.get<TurbulenceOptions>().model;
  const double products = 3 * size.symmetric;
  double moved = 4 + 4;  // strain, viscosity
  if (model == TurbulenceModel::mixed_scale) moved += size.vector + size.float_vector;
  if (liquid.dynamic_closure()) {
    moved += size.vector;                                               // mean velocity
    moved += size.gradient + size.vector + 4 + products;                // products
    moved += 2 * products;                                              // filtered
    moved += size.float_vector + products;                              // contractions
    moved += model == TurbulenceModel::dynamic_lagrangian ? 32          // averages, read and written
                                                          : 3 * 8 + 8;  // written, filtered, read
  }
  moved += 4;  // the largest
  return liquid.records.take_traffic() + times(liquid, moved);
}

double prediction(Liquid& liquid) {
  const Sizes size(liquid);
  const Plan& plan = liquid.plan;
  double moved = 0;
  if (plan.gravity || plan.body_force) moved += size.vector + 8;
  if (plan.viscosity) {
    moved += 4 + 4 + (liquid.eddy_viscosity != nullptr ? 4 : 0) + (liquid.varying ? 8 : 0);  // diffusivity
    moved += size.vector + 4 + 4 + size.float_vector;                                        // viscous sweep
    moved += size.float_vector;
  }
  moved += 2 * size.vector + (liquid.varying ? size.float_vector + 4 : 0);
  if (plan.body_force && !liquid.uniform_body_force) moved += 3 * size.vector;
  return liquid.records.take_traffic() + times(liquid, moved);
}

double divergence(Liquid& liquid) {
  const Sizes size(liquid);
  const Plan& plan = liquid.plan;
  const bool potential = liquid.potential != nullptr;
  double moved = size.vector + size.symmetric + 8 + (potential ? 8 + 4 : 0);
  moved += 8;  // the largest
  if (liquid.options.get<SchemeOptions>().centred) moved += 4 + 16;
  if (liquid.options.get<SchemeOptions>().centred && plan.no_slip) moved += size.vector + size.symmetric + 4;
  if (plan.density_relaxation) moved += 2 * 4 + 16 + (plan.free_surface ? 2 * 4 : 0);
  moved += 4 + 4 + 3 * 4 + (plan.free_surface ? 4 + 1 : 0);                         // matrix
  moved += 16 + 8 + 4 + 4 + (potential ? 8 + 4 : 0) + (plan.free_surface ? 1 : 0);  // right-hand side
  return liquid.records.take_traffic() + times(liquid, moved);
}

double pressure(Liquid& liquid) {
  return liquid.records.take_traffic();
}

double projection(Liquid& liquid) {
  const Sizes size(liquid);
  double moved = 8;                                  // mean
  moved += 8 + size.symmetric + size.float_vector;   // gradient
  moved += size.float_vector + 1 + 2 * size.vector;  // velocity
  if (liquid.plan.mixture_pressure && liquid.varying) moved += 4;
  return liquid.records.take_traffic() + times(liquid, moved);
}

double accept(const Liquid& liquid) {
  const Sizes size(liquid);
  const Plan& plan = liquid.plan;
  double moved = size.vector;  // the largest speed
  if (!plan.body_force || liquid.uniform_body_force) {
    moved += size.vector;  // kinetic energy, and the height below
    for (int axis = 0; axis < liquid.dimensions; ++axis)
      if (!liquid.scene.domain.periodic(axis)) moved += 8;
  }
  moved += 2 * size.vector + (plan.bubbles ? 2 * size.vector : 0);
  if (plan.shifting) moved += size.float_vector;
  if (plan.shift_correction) moved += size.float_vector + (plan.free_surface ? 4 : 0);
  moved += 2 * size.vector;
  moved += 8 + 8 + (liquid.potential != nullptr ? 8 : 0);
  moved += 2 * size.vector + 4;  // extremes
  const double eddy = liquid.eddy_viscosity != nullptr ? 4 : 0;
  moved += eddy + (liquid.varying ? 4 + eddy : 0);
  if (plan.velocity_gradient) moved += 4 + eddy;  // dissipation
  return times(liquid, moved);
}

}  // namespace spume::les_sph::traffic
