// SPDX-License-Identifier: MIT
// The free surface of les-sph: what its closure is exact for, and what it does to the energy of a wave.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "methods/les_sph_simulation.hpp"
#include "spume/core/random.hpp"

namespace spume::test {
namespace {

const std::string drop = R"(method = "les-sph"
[domain]
lower = [0, 0]
upper = [2, 2]
[resolution]
spacing = 0.05
[fluid]
reynolds = 100
froude = 1
mach = 0
[[liquid]]
centre = [1, 1]
radius = 0.4
[time]
end = 1
)";

const std::string still_water = R"(method = "les-sph"
[domain]
lower = [0, 0, 0]
upper = [0.4, 0.4, 0.5]
x = "periodic"
y = "periodic"
bottom = "free-slip"
[resolution]
spacing = 0.05
[fluid]
reynolds = 1e6
froude = 0.3193
mach = 0.05
[[liquid]]
upper = [0.4, 0.4, 0.3]
[time]
end = 4
)";

const std::string wave = R"(method = "les-sph"
[domain]
lower = [0, -1]
upper = [1, 0.25]
x = "periodic"
bottom = "free-slip"
[resolution]
spacing = 0.03125
[fluid]
reynolds = 1e9
froude = 1
mach = 0
[[liquid]]
where = "0.03*cos(2*pi*x) - y"
conform = true
[time]
end = 3
)";

// q linear with gradient b, and p such that it vanishes a depth s above each edge particle: p - p0 = -s n.b. The sums
// are exact for that whatever the arrangement; what is left is the rounding of floats, amplified by corrections of up
// to 6 and by neighbours' differences over a spacing.
TEST(LesSphSurface, GradientOfALinearPressureIsExactOnADisorderedSurface) {
  StagedFlow staged(drop);
  les_sph::Flow& flow = staged.flow;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const auto r = random_uniform(3, RandomPurpose::test, i, 0, 0);
    for (int axis = 0; axis < 2; ++axis)
      (*flow.particles.position[axis])[i] += 0.3 * flow.resolution.spacing * (2 * r[axis] - 1);
  }
  staged.run_before("shift", 0);
  flow.find_potential(0);
  ASSERT_GT(flow.surface->near_surface.size(), 20u);

  const double b[2] = {0.7, -1.3};
  for (std::size_t i = 0; i < flow.size(); ++i)
    (*flow.reduced_pressure)[i] =
        b[0] * (*flow.intermediate_position[0])[i] + b[1] * (*flow.intermediate_position[1])[i];
  for (std::size_t k = 0; k < flow.surface->near_surface.size(); ++k) {
    const auto i = static_cast<std::size_t>(flow.surface->near_surface[k]);
    double size = 0, along = 0;
    for (int axis = 0; axis < 2; ++axis) {
      const double n = (*flow.moments.normal[axis])[i];
      size += n * n;
      along += n * b[axis];
    }
    const double pressure =
        flow.surface->row(flow.moments, flow.sizes, flow.uniform_acceleration, k).hydrostatic_pressure -
        flow.surface->depth[k] * along / std::sqrt(size);
    (*flow.potential)[i] = (*flow.reduced_pressure)[i] - pressure;
  }
  FloatVectorScratch gradient;
  for (int axis = 0; axis < 2; ++axis) gradient[axis].resize(flow.size());
  gradient_sweep(flow.arrangement.context, flow.arrangement.packed, flow.reduced_pressure->data(), 0,
                 flow.moments.read_correction(), write(gradient));
  flow.surface->complete_gradient(flow.moments, flow.sizes, flow.uniform_acceleration, *flow.reduced_pressure,
                                  flow.potential, gradient);
  for (const std::int32_t i : flow.surface->near_surface)
    for (int axis = 0; axis < 2; ++axis) ASSERT_NEAR(gradient[axis][static_cast<std::size_t>(i)], b[axis], 1e-4);
}

// Liquid scattered to a quarter of its number density has a div r of about 0.7 everywhere, beside walls too, which is a
// quarter of the 2.94 of the bulk.
TEST(LesSphSurface, SprayBesideSolidsIsAllSurface) {
  StagedFlow staged(dam_break_3d + "[[solid]]\nlower = [0.75, 0.5, 0.5]\nupper = [1, 0.7, 1]\n",
                    {"resolution.spacing=0.05", "liquid.0.upper=[0.5, 0.35, 1]"});
  les_sph::Flow& flow = staged.flow;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const auto r = random_uniform(3, RandomPurpose::test, i, 0, 0);
    for (int axis = 0; axis < 3; ++axis) {
      const double stretch = axis < 2 ? 2 : 1;
      double& x = (*flow.particles.position[axis])[i];
      x = stretch * (x + flow.resolution.spacing * (r[axis] - 0.5));
    }
  }
  staged.run_before("shift", 0);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) inside += flow.surface->at_surface[i] == 0 ? 1 : 0;
  EXPECT_EQ(inside, 0u);
}

// Water around a pillar, every particle displaced by up to a tenth of a spacing and the rows before the pillar moved
// towards it, to 0.35 spacings: whatever of the uppermost layer lacks the neighbours of liquid inside is of the
// surface.
TEST(LesSphSurface, AWallBesideTheSurfaceIsNotFaced) {
  StagedFlow staged(still_water + "[[solid]]\nlower = [0.25, 0.25, 0]\nupper = [0.35, 0.35, 0.5]\n",
                    {"domain.upper=[0.6, 0.6, 0.5]", "liquid.0.upper=[0.6, 0.6, 0.3]"});
  les_sph::Flow& flow = staged.flow;
  const double d = flow.resolution.spacing;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    const auto r = random_uniform(5, RandomPurpose::test, i, 0, 0);
    for (int axis = 0; axis < 3; ++axis) (*flow.particles.position[axis])[i] += 0.1 * d * (2 * r[axis] - 1);
    double& x = (*flow.particles.position[0])[i];
    if (x < 0.25 && x > 0.25 - 3 * d) x = std::min(x + 0.15 * d, 0.25 - 0.3 * d);
  }
  staged.run_before("shift", 0);
  int lacking = 0, inside = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    if ((*flow.intermediate_position[2])[i] < 0.26 || (*flow.moments.divergence_of_position)[i] > 2.2) continue;
    ++lacking;
    inside += flow.surface->at_surface[i] == 0 ? 1 : 0;
  }
  EXPECT_GT(lacking, 100);
  EXPECT_EQ(inside, 0);
}

// On the undisturbed lattice the uppermost layer lies half a spacing below the surface and nothing else does.
TEST(LesSphSurface, LatticeUnderAFlatSurfaceHasOneEdgeLayerHalfASpacingDeep) {
  StagedFlow staged(wave, {"liquid.0.where=\"-y\""});
  const les_sph::Flow& flow = staged.flow;
  const double dr = flow.resolution.spacing;
  staged.run_before("shift", 0);
  ASSERT_EQ(flow.surface->near_surface.size(), 32u);
  for (std::size_t k = 0; k < 32; ++k) {
    EXPECT_NEAR(flow.surface->depth[k], dr / 2, 1e-6);
    EXPECT_NEAR((*flow.intermediate_position[1])[static_cast<std::size_t>(flow.surface->near_surface[k])], -dr / 2,
                1e-12);
  }
}

// Two layers of the lattice below a flat surface are moved towards each other: no force acts, and the shift must not
// transport their liquid through the layers, or the surface would follow. A tenth of it comes back through the filter,
// from the layers below that give way.
TEST(LesSphSurface, ShiftMovesNoWholeLayerAlongTheNormal) {
  double moved[2] = {0, 0};
  for (const bool kept : {false, true}) {
    StagedFlow staged(wave,
                      {"liquid.0.where=\"-y\"", kept ? "shifting.remove_drift=true" : "shifting.remove_drift=false"});
    les_sph::Flow& flow = staged.flow;
    const double dr = flow.resolution.spacing;
    for (double& y : *flow.particles.position[1])
      if (std::abs(y + 1.5 * dr) < 0.1 * dr) y += 0.1 * dr;
    staged.run_before("shift", 0);
    flow.displacement = 1;
    flow.compute_shift();
    for (std::size_t i = 0; i < flow.size(); ++i)
      if ((*flow.intermediate_position[1])[i] > -2 * dr)
        moved[kept ? 1 : 0] = std::max(moved[kept ? 1 : 0], std::abs(double{(*flow.shift->displacement[1])[i]}) / dr);
  }
  EXPECT_LT(moved[1], 0.2 * moved[0]);
}

// Depths, in spacings, of the uppermost row in the middle of a slab of eight rows, far wider than any support; spacings
// along the first and the other rows and between rows in units of dr.
std::vector<double> middle_depths(const std::string& text, double first_row, double rows_across, double rows_down) {
  StagedFlow staged(text);
  les_sph::Flow& flow = staged.flow;
  const double dr = flow.resolution.spacing;
  std::size_t used = 0;
  std::vector<std::size_t> middle;
  for (int row = 0; row < 8; ++row) {
    const double step = dr * (row == 0 ? first_row : rows_across);
    const int half = static_cast<int>(8 * dr / step);
    for (int k = -half; k <= half; ++k, ++used) {
      if (used >= flow.size()) throw std::logic_error("the case holds too few particles");
      (*flow.particles.position[0])[used] = 1 + (k + 0.3 * row) * step;
      (*flow.particles.position[1])[used] = 1 - rows_down * dr * row;
    }
  }
  // The others stay apart from the slab.
  for (std::size_t i = used; i < flow.size(); ++i) {
    (*flow.particles.position[0])[i] = 0.1;
    (*flow.particles.position[1])[i] = 0.1 + 1e-3 * static_cast<double>(i - used) * dr;
  }
  staged.run_before("shift", 0);
  std::vector<double> depths;
  for (std::size_t k = 0; k < flow.surface->near_surface.size(); ++k) {
    const auto i = static_cast<std::size_t>(flow.surface->near_surface[k]);
    const double x = (*flow.intermediate_position[0])[i], y = (*flow.intermediate_position[1])[i];
    if (std::abs(x - 1) < 2 * dr && std::abs(y - 1) < 0.1 * dr) depths.push_back(flow.surface->depth[k] / dr);
  }
  return depths;
}

// Strained without change of volume, a layer is as thick as it is long no more: half of it lies above its particles.
// The ramp of the column is sampled once a layer: its quadrature error is below 0.02 at these spacings.
TEST(LesSphSurface, DepthFollowsAStrainOfTheLattice) {
  for (const double down : {0.8, 1.0, 1.25}) {
    const std::vector<double> depths = middle_depths(drop, 1 / down, 1 / down, down);
    ASSERT_GE(depths.size(), 3u);
    for (const double depth : depths) EXPECT_NEAR(depth, down / 2, 0.02) << down;
  }
}

// A row with 4/3 as many particles on its length holds 4/3 of a layer; the surface lies 1/3 higher. The B-spline's sums
// are exact on a uniform row up to 0.2 % at this density.
TEST(LesSphSurface, DepthFollowsTheVolumeOfACrowdedRow) {
  const std::vector<double> depths = middle_depths(drop, 0.75, 1, 1);
  ASSERT_GE(depths.size(), 3u);
  for (const double depth : depths) EXPECT_NEAR(depth, 0.5 + 1.0 / 3, 0.01);
}

// Between two passages through the flat state, half a period apart, the kinetic energy of an inviscid wave returns to
// within the second order in the spacing, (2 pi / 32)^2 = 3.9 %.
TEST(LesSphSurface, StandingWaveKeepsItsEnergy) {
  Simulation run(wave);
  const double half_period = std::numbers::pi / std::sqrt(2 * std::numbers::pi);
  double peak[2] = {0, 0};  // of the first and of the second half period
  while (run.method.time() < 2 * half_period) {
    run.steps(1, 0.0125);
    double& highest = peak[run.method.time() < half_period ? 0 : 1];
    highest = std::max(highest, run.series().at("kinetic_energy"));
  }
  RecordProperty("ratio", std::to_string(peak[1] / peak[0]));
  EXPECT_NEAR(peak[1] / peak[0], 1, 0.039);
}

// Rounding moves the particles by 1e-7; a surface that does not hold a particle back as it rises lets that grow by a
// factor of forty per unit of time.
TEST(LesSphSurface, StillWaterStaysAtRestInThreeDimensions) {
  Simulation run(still_water);
  run.steps(200, 0.016);
  EXPECT_LT(run.series().at("max_speed"), 1e-5);
}

// Disturbed by a thousandth of a spacing it oscillates and calms down. With depths that are not shared within a layer
// its energy grows eightfold in the second unit of time.
TEST(LesSphSurface, DisturbedWaterCalmsDownInThreeDimensions) {
  Simulation run(still_water, {"initial.jitter=1e-3"});
  run.steps(100, 0.01);
  const double early = run.series().at("kinetic_energy");
  run.steps(100, 0.01);
  EXPECT_LT(run.series().at("kinetic_energy"), early);
}

// A breaking wave of steepness 0.55 until its crest overturns. Without forces other than gravity its energy above
// the level liquid must not grow by more than the half per cent that the case demands; with the surface half a layer
// above the uppermost particles, in place of by the volume below it, it grows by 3.7 %.
TEST(LesSphSurface, SteepWaveGainsNoEnergy) {
  Simulation run(wave_tank + R"case([constants]
chi = 0.55
eta = "(chi*cos(2*pi*x) + chi^2/2*cos(4*pi*x) + 3/8*chi^3*cos(6*pi*x))/(2*pi)"
amplitude = "chi*sqrt(1+chi^2)/sqrt(2*pi)"
[[liquid]]
where = "eta - y"
velocity = ["amplitude*cos(2*pi*x)*exp(2*pi*y)", "amplitude*sin(2*pi*x)*exp(2*pi*y)"]
conform = true
[time]
end = 1
)case");
  const auto energy = [&] {
    const auto series = run.series();
    return series.at("kinetic_energy") + series.at("potential_energy") + 0.25 * series.at("mass");
  };
  const double first = energy();
  double lowest = first, growth = 0;
  while (run.method.time() < 0.9) {
    run.steps(1, std::min(0.004, run.method.step_limit().dt));
    lowest = std::min(lowest, energy());
    growth = std::max(growth, energy() - lowest);
  }
  RecordProperty("growth", std::to_string(growth / first));
  EXPECT_LT(growth / first, 0.005);
}

// The formula over all pairs of particles and images.
TEST(SurfaceRipples, RiseIsThatOfTheFormula) {
  for (const std::string& text : {tank, wave, still_water, dam_break_3d}) {
    StagedFlow step(text);
    les_sph::Flow& flow = step.flow;
    const int d = flow.dimensions;
    for (std::size_t i = 0; i < flow.size(); ++i) {
      const auto r = random_uniform(9, RandomPurpose::test, i, 0, 0);
      for (int axis = 0; axis < d; ++axis) (*flow.particles.velocity[axis])[i] = r[axis] - 0.3;
    }
    const double dt = 0.001;
    step.run_before("shift", dt);
    const FreeSurface& surface = *flow.surface;
    const Images& images = flow.arrangement.images;
    const double radius2 = std::pow(flow.resolution.support_radius, 2);
    std::size_t seen = 0;
    for (std::size_t k = 0; k < surface.near_surface.size(); ++k) {
      const auto i = static_cast<std::size_t>(surface.near_surface[k]);
      const Vec3 at = vector_at(flow.intermediate_position, d, i), n = vector_at(flow.moments.normal, d, i);
      const double size = std::hypot(n[0], n[1], n[2]);
      double weights = 0, sum = 0;
      const auto add = [&](const Vec3& place, const Vec3& velocity, std::size_t j) {
        if (!surface.is_near(flow.moments, j)) return;
        double distance2 = 0, speed = 0;
        for (int axis = 0; axis < d; ++axis) {
          distance2 += std::pow(place[axis] - at[axis], 2);
          speed += velocity[axis] * n[axis] / size;
        }
        if (distance2 >= radius2) return;
        const double weight = (1 - double{surface.interior_weight[j]}) * std::pow(1 - distance2 / radius2, 2);
        weights += weight;
        sum += weight * speed;
      };
      for (std::size_t j = 0; j < flow.size(); ++j)
        add(vector_at(flow.intermediate_position, d, j), vector_at(flow.particles.velocity, d, j), j);
      const ImageRules rules = flow.boundary.image_rules(flow.resolution.support_radius);
      for (std::size_t m = 0; m < images.size(); ++m) {
        const auto j = static_cast<std::size_t>(images.source()[m]);
        Vec3 place{}, velocity = vector_at(flow.particles.velocity, d, j);
        for (int axis = 0; axis < d; ++axis) {
          place[axis] = images.position(axis)[m];
          velocity[axis] *= Images::sign(images.paths()[static_cast<std::size_t>(images.path()[m])], rules, axis);
        }
        add(place, velocity, j);
      }
      double own = 0;
      for (int axis = 0; axis < d; ++axis) own += (*flow.particles.velocity[axis])[i] * n[axis] / size;
      const double exact = size > 0 ? ripples_ahead * dt * (own - sum / weights) : 0;
      ASSERT_NEAR(surface.rise[k], exact, 1e-5 * dt) << text << i;
      seen += std::abs(exact) > 0.1 * dt ? 1 : 0;
    }
    EXPECT_GT(seen, surface.near_surface.size() / 4);
  }
}

}  // namespace
}  // namespace spume::test
