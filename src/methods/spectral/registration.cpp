// SPDX-License-Identifier: MIT
#include "spume/methods/spectral/registration.hpp"

#include "spume/methods/spectral/options.hpp"
#include "spume/methods/spectral/spectral.hpp"
#include "spume/scene/document.hpp"

namespace spume::spectral {
namespace {

void check(Draft& draft, Problems& problems) {
  check_spectral(draft, problems);
  check_particles(draft, problems);
}

// The states of the integrator; left out are the planes of a product, whose share falls with the size of the grid.
double bytes_per_point(const Draft& draft) {
  const SpectralOptions& numerics = draft.options.get<SpectralOptions>();
  // Three components of N/2 + 1 complex modes are 3 numbers per point.
  const double number = numerics.precision == FieldPrecision::f64 ? 8 : 4;
  const double states = numerics.integrator == Integrator::ab2 ? 3 : 4;
  return 3 * number * states;
}

// Runge-Kutta stays accurate up to its stability, 0.55 and 1.06 (1.73 / pi and 3.34 / pi). Particles keep the steps of
// Adams-Bashforth.
constexpr double courant_of_ab2 = 0.2, courant_of_rk3 = 0.5, courant_of_rk4 = 0.9;
double default_courant(const Case& options, const Scene&) {
  const Integrator integrator = options.get<SpectralOptions>().integrator;
  if (options.get<ParticleCaseOptions>().any() || integrator == Integrator::ab2) return courant_of_ab2;
  return integrator == Integrator::rk3 ? courant_of_rk3 : courant_of_rk4;
}

// The same in both precisions.
std::vector<OutputFieldInfo> output_fields(const Case&) {
  std::vector<OutputFieldInfo> infos;
  for (const auto& field : Spectral<double>::output_fields()) infos.push_back({field.name});
  return infos;
}

std::unique_ptr<Method> make(const LoadedCase& loaded) {
  if (loaded.options.get<SpectralOptions>().precision == FieldPrecision::f32)
    return std::make_unique<Spectral<float>>(loaded);
  return std::make_unique<Spectral<double>>(loaded);
}

}  // namespace

Registration registration() {
  Registration method;
  method.name = "spectral";
  method.description = "pseudo-spectral simulation of homogeneous turbulence in a periodic box, with point particles";
  method.uses_grid = true;
  method.sections = spectral_sections();
  method.check = check;
  method.bytes_per_particle = bytes_per_point;
  method.default_courant = default_courant;
  method.default_courant_in_words = "ab2 and particles " + brief(courant_of_ab2) + ", rk3 " + brief(courant_of_rk3) +
                                    ", rk4 " + brief(courant_of_rk4);
  method.output_fields = output_fields;
  method.probe_scalars = [](const Case&) { return std::vector<ProbeScalar>{{"pressure", "pressure"}}; };
  method.make = make;
  return method;
}

}  // namespace spume::spectral
