// SPDX-License-Identifier: MIT
// Options of the spectral method: numerics and forcing. Its initial states stand in [initial], options_scene.cpp.
#include "option.hpp"

namespace spume {
namespace {

Section spectral() {
  return {.name = "spectral",
          .options =
              {
                  {.key = "integrator",
                   .type = OptionType::word,
                   .default_text = "\"ab2\"",
                   .words = {"ab2", "rk3", "rk4"},
                   .description = "Adams-Bashforth 2, or Runge-Kutta of order 3 or 4; the viscous term is always exact",
                   .set =
                       [](Draft& d, const Value& v) {
                         d.options.spectral.integrator = v.text == "ab2"   ? Integrator::ab2
                                                         : v.text == "rk3" ? Integrator::rk3
                                                                           : Integrator::rk4;
                       }},
                  {.key = "dealiasing",
                   .type = OptionType::word,
                   .default_text = "\"padded\"",
                   .words = {"padded", "two-thirds", "none"},
                   .description = "products on a grid of 3N/2 points, modes above N/3 cut, or aliased products",
                   .set =
                       [](Draft& d, const Value& v) {
                         d.options.spectral.dealiasing = v.text == "padded"       ? Dealiasing::padded
                                                         : v.text == "two-thirds" ? Dealiasing::two_thirds
                                                                                  : Dealiasing::none;
                       }},
                  {.key = "precision",
                   .type = OptionType::word,
                   .default_text = "\"double\"",
                   .words = {"double", "single"},
                   .description = "of the fields and their transforms",
                   .set =
                       [](Draft& d, const Value& v) {
                         d.options.spectral.precision = v.text == "double" ? FieldPrecision::f64 : FieldPrecision::f32;
                       }},
                  {.key = "plans",
                   .type = OptionType::word,
                   .default_text = "\"estimate\"",
                   .words = {"estimate", "measured"},
                   .description = "how FFTW plans; measured plans are kept in the user's cache folder",
                   .set =
                       [](Draft& d, const Value& v) {
                         d.options.spectral.plans = v.text == "measured" ? PlanEffort::measured : PlanEffort::estimate;
                       }},
              },
          .methods = {"spectral"}};
}

Section forcing() {
  const auto number = [](const char* key, const char* unit, const char* absent, Range range, const char* description,
                         double ForcingOptions::*member) {
    return Option{.key = key,
                  .type = OptionType::number,
                  .unit = unit,
                  .absent = absent,
                  .range = range,
                  .description = description,
                  .set = [member](Draft& d, const Value& v) { d.options.forcing.*member = v.number; }};
  };
  return {.name = "forcing",
          .options =
              {
                  {.key = "kind",
                   .type = OptionType::word,
                   .default_text = "\"none\"",
                   .words = {"none", "shell", "linear"},
                   .description = "shell: constant injection at low wavenumbers; linear: rate times velocity",
                   .set =
                       [](Draft& d, const Value& v) {
                         d.options.forcing.kind = v.text == "none"    ? ForcingKind::none
                                                  : v.text == "shell" ? ForcingKind::shell
                                                                      : ForcingKind::linear;
                       }},
                  number("wavenumber", "2 pi / longest length", "1", positive(),
                         "shell: forced are wavenumber <= |k| < wavenumber + width", &ForcingOptions::wavenumber),
                  number("width", "2 pi / longest length", "1", positive(), "shell: width of the forced band",
                         &ForcingOptions::width),
                  number("injection", "energy/mass/time", "required for shell", positive(),
                         "shell: energy put in per mass and time", &ForcingOptions::injection),
                  number("rate", "1/time", "required for linear", positive(), "linear: acceleration over velocity",
                         &ForcingOptions::rate),
              },
          .methods = {"spectral"}};
}

}  // namespace

std::vector<Section> spectral_sections() {
  return {spectral(), forcing()};
}

}  // namespace spume
