// SPDX-License-Identifier: MIT
// Bubbles of a case: what they are made of, which models act on them, and where they come from. The sections [bubbles],
// [[sparger]] and [[bubble_cloud]] fill these groups of options. A method that carries bubbles names the sections in
// its registration and calls the checks in its own.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "spume/core/vec3.hpp"

namespace spume {

struct Draft;
class Expression;
class Problems;
struct Scene;
struct Section;

// Density of the gas of a case in SI that gives none, kg/m3: air at 20 C.
inline constexpr double air_density = 1.2;
// The state of so many bubbles alone takes 14 GB, 136 bytes each.
inline constexpr double most_bubbles_of_a_cloud = 1e8;

// stable: relaxation solved in closed form, any step; substep: explicit Euler, spacing / radius sub-steps.
enum class BubbleIntegrator { stable, substep };
// How liquid and bubbles share momentum: -grad(alpha p), or -alpha grad p.
enum class MomentumForm { mixture_pressure, two_fluid };
enum class SurfaceReaction { surface, liquid };
// The probability with which a bubble is entrained that costs more than what is left of a budget.
enum class EntrainmentOverdraft {
  affordable,  // left / cost
  printed,     // 1 - left / cost, King section 3.4.1 (iii) and (iv)
};
enum class SizeLaw { monodisperse, truncated_gaussian, log_normal };

// Radii: all `mean`; Gaussian cut to [minimum, maximum]; or log-normal with median `mean` and `deviation` that of log
// a.
struct BubbleSizes {
  SizeLaw law = SizeLaw::monodisperse;
  double mean = 0;
  double deviation = 0;
  double minimum = 0;
  double maximum = 0;
};

struct BubbleOptions {
  bool on = false;                            // the case has a section [bubbles]
  double tension = 0;                         // surface tension over liquid density: 1/We, length3/time2; 0: not given
  double density_ratio = 1000 / air_density;  // liquid over gas: water over air
  bool entrainment = false;
  bool breakup = false;
  bool fluctuations = false;
  bool surface_interaction = true;
  bool fluid_inertia = false;
  BubbleIntegrator integrator = BubbleIntegrator::stable;
  MomentumForm momentum_form = MomentumForm::mixture_pressure;
  SurfaceReaction surface_reaction = SurfaceReaction::surface;  // who feels the reaction to the braking force
  double lift_coefficient = 0.5;
  double virtual_mass_coefficient = 0.5;
  double viscosity_constant = 0.6;     // C_nuB of the bubble-induced viscosity
  double fluctuation_constant = 1;     // C of the time scale of the fluctuations
  double entrainment_constant = 0.01;  // C_eps
  double entrainment_threshold = 0.2;  // dissipation above which bubbles are entrained
  EntrainmentOverdraft entrainment_overdraft = EntrainmentOverdraft::affordable;
  double deformation_constant = 8.2;     // c_def
  double schmidt = 700;                  // of the persistence at the surface
  double hinze_radius = 0;               // tension^(3/5) / 2 unless given
  double smallest_entrained_radius = 0;  // hinze_radius / 20 unless given
  int trace_every = 0;                   // traces of the bubbles whose identifier is a multiple of this; 0: none
  double trace_interval = 0;             // of the traces; 0: with every row of series.csv
};

enum class SpargerShape { point, disc, line };

// Bubbles released at a volumetric rate.
struct Sparger {
  SpargerShape shape = SpargerShape::point;
  Vec3 position{};    // point, centre of a horizontal disc, start of a line
  Vec3 end{};         // end of a line
  double radius = 0;  // of a disc
  BubbleSizes sizes;
  std::shared_ptr<const Expression> rate;  // gas volume per time, an expression of t
};

// Bubbles placed at random in a box or a ball at one time.
struct BubbleCloud {
  Vec3 lower{}, upper{};
  bool ball = false;
  Vec3 centre{};
  double radius = 0;
  std::int64_t number = 1;
  double time = 0;
  BubbleSizes sizes;
};

struct BubbleSources {
  std::vector<Sparger> spargers;
  std::vector<BubbleCloud> clouds;
};

std::vector<Section> bubble_sections();

// Gas and liquid, radii against the spacing, sources inside the domain; completes BubbleOptions.
void check_bubbles(Draft& draft, Problems& problems);

// What can be told of spargers and clouds only beside the compiled rates and the initial liquid.
void check_bubble_sources(const Draft& draft, const Scene& scene, Problems& problems);

}  // namespace spume
