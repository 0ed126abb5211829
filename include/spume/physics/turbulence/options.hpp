// SPDX-License-Identifier: MIT
// The section [turbulence]: closure of the unresolved stresses. A method that offers closures names it in its
// registration.
#pragma once

namespace spume {

struct Section;

enum class TurbulenceModel { none, mixed_scale, smagorinsky, dynamic_shepard, dynamic_lagrangian };

// What diffuses momentum: div(nu grad u), or div(2 nu S), which also holds at a surface free of stress.
enum class DiffusionForm { automatic, laplacian, stress };

struct TurbulenceOptions {
  TurbulenceModel model = TurbulenceModel::none;
  DiffusionForm diffusion = DiffusionForm::automatic;  // automatic: stress with a free surface
  double mixed_scale_constant = 0.06;
  double smagorinsky_constant = 0.18;
};

Section turbulence_section();

}  // namespace spume
