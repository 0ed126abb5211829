// SPDX-License-Identifier: MIT
#include "spume/methods/spectral/options.hpp"

#include "spume/scene/document.hpp"
#include "spume/scene/option.hpp"

namespace spume {
namespace {

Section numerics() {
  using S = SpectralOptions;
  return section<S>("spectral")
      .word("integrator", &S::integrator,
            {{"ab2", Integrator::ab2}, {"rk3", Integrator::rk3}, {"rk4", Integrator::rk4}},
            "Adams-Bashforth 2, or Runge-Kutta of order 3 or 4; the viscous term is always exact")
      .word("dealiasing", &S::dealiasing,
            {{"padded", Dealiasing::padded}, {"two-thirds", Dealiasing::two_thirds}, {"none", Dealiasing::none}},
            "padded: products on a grid of 3N/2 points; two-thirds: modes above N/3 truncated; none: aliased products")
      .word("precision", &S::precision, {{"double", FieldPrecision::f64}, {"single", FieldPrecision::f32}},
            "precision of the fields and their transforms")
      .word("plans", &S::plans, {{"estimate", PlanEffort::estimate}, {"measured", PlanEffort::measured}},
            "planning of FFTW, for lengths with a prime factor above 5: the others have transforms of our own; "
            "measured plans "
            "are kept in the user's cache folder")
      .behind_output();
}

Section forcing() {
  using F = ForcingOptions;
  return section<F>("forcing")
      .word("kind", &F::kind,
            {{"none", ForcingKind::none}, {"shell", ForcingKind::shell}, {"linear", ForcingKind::linear}},
            "shell: constant injection at low wavenumbers; linear: rate times velocity")
      .option("wavenumber", &F::wavenumber, "2 pi / longest length", positive(),
              "shell: forced band wavenumber <= |k| < wavenumber + width")
      .absent(brief(F{}.wavenumber))
      .option("width", &F::width, "2 pi / longest length", positive(), "shell: width of the forced band")
      .absent(brief(F{}.width))
      .option("injection", &F::injection, "energy/mass/time", positive(), "shell: energy put in per mass and time")
      .absent("required for shell")
      .steerable()
      .option("rate", &F::rate, "1/time", positive(), "linear: acceleration over velocity")
      .absent("required for linear")
      .steerable()
      .behind_output();
}

Section initial() {
  using I = InitialOptions;
  return section<I>("initial")
      .word("kind", &I::kind,
            {{"taylor-green", InitialKind::taylor_green},
             {"abc", InitialKind::abc},
             {"random", InitialKind::random},
             {"expressions", InitialKind::expressions},
             {"checkpoint", InitialKind::checkpoint},
             {"rest", InitialKind::rest}},
            "velocity at the start")
      .required()
      .option("amplitude", &I::amplitude, "length/time", "taylor-green: one velocity; abc: A, B, C")
      .absent("1, or 1, 1, 1")
      .option("wavenumber", &I::wavenumber, "", between(1, 8192), "taylor-green, abc: periods in the box")
      .absent(brief(I{}.wavenumber))
      .option("velocity", &Draft::initial_velocity, "length/time",
              "expressions: of x y z, projected onto solenoidal fields")
      .absent("required for expressions")
      .option("spectrum", &Draft::initial_spectrum, "random: E(k) up to a factor, an expression of k")
      .absent("required for random")
      .option("energy", &I::energy, "energy/mass", positive(), "random: mean kinetic energy per mass")
      .absent("required for random")
      .option("file", &I::file, "checkpoint: checkpoint.h5 of a run on any grid, path from the working folder")
      .absent("required for checkpoint");
}

Section particles() {
  using P = ParticleCaseOptions;
  return section<P>("particles")
      .option("count", &P::count, "", between(1, most_particles), "number of particles")
      .absent("from volume_fraction")
      .option("volume_fraction", &P::volume_fraction, "1", above_up_to(0, close_packing),
              "volume of all particles over that of the box; sets their number")
      .absent("from count")
      .option("diameter", &P::diameter, "length", positive(), "diameter of every particle")
      .absent("see diameter_over_eta")
      .option("diameter_over_eta", &P::diameter_over_eta, "Kolmogorov length", positive(),
              "diameter over (nu^3 / forcing.injection)^(1/4)")
      .absent("see diameter")
      .option("diameters", &P::diameters, "length", "several diameters; the first is the reference")
      .absent("one diameter")
      .option("shares", &P::shares, "1", "share of the particles with each of the diameters")
      .absent("equal")
      .option("beta", &P::beta, "1", between(0, 3), "3 / (1 + 2 rho_particle / rho_fluid): bubbles 3, tracers 1")
      .absent("1")
      .option("stokes", &P::stokes, "1", positive(), "response time over (nu / forcing.injection)^(1/2)")
      .absent("from the diameter")
      .option("response_time", &P::response_time, "time", positive(),
              "tau of the Stokes drag; without it and stokes, diameter^2 / (12 beta nu)")
      .absent("from the diameter")
      .word("drag", &P::drag, {{"stokes", DragLaw::stokes}, {"schiller-naumann", DragLaw::schiller_naumann}},
            "drag law")
      .option("gravity", &P::gravity, "length/time2", "acceleration of gravity, three entries")
      .absent("none")
      .word(
          "coupling", &P::coupling,
          {{"one-way", Coupling::one_way},
           {"two-way", Coupling::two_way},
           {"four-way", Coupling::four_way},
           {"colliding", Coupling::colliding}},
          "one-way: the flow acts on the particles; two-way: particles also act on the flow; four-way: particles also "
          "collide; colliding: particles collide and do not act on the flow")
      .word("matching", &P::matching_by_sorting, {{"rounds", false}, {"sorting", true}},
            "search for the strongest overlaps; both give the same pairs")
      .when("coupling", {"four-way", "colliding"})
      .option("collision_sweeps", &P::collision_sweeps, "", between(1, 1000),
              "largest number of collisions of a particle per step; de Wit et al. (2024): 1")
      .when("coupling", {"four-way", "colliding"})
      .option("max_volume_fraction", &P::max_volume_fraction, "1", above_up_to(0, 1),
              "local volume fraction at which the force on the flow is clipped")
      .absent(brief(P{}.max_volume_fraction) + ", close packing")
      .when("coupling", {"two-way", "four-way"})
      .option(
          "remove_self_disturbance", &P::remove_self_disturbance,
          "particles see the velocity of the flow without the part that their own force makes on the grid; de Wit et "
          "al. (2024): false")
      .when("coupling", {"two-way", "four-way"})
      .option("mean_force_moves_fluid", &P::mean_force_moves_fluid,
              "the mean force of the particles accelerates the fluid; otherwise a mean pressure gradient balances it")
      .when("coupling", {"two-way", "four-way"})
      .option("frozen", &P::frozen, "particles are fixed at their initial positions")
      .option("spline_order", &P::spline_order, "", between(2, 6), "points per axis of the interpolation: 2, 4 or 6")
      .word("records", &P::double_records, {{"single", false}, {"double", true}},
            "precision of the interpolated velocity")
      .option("sort_every", &P::sort_every, "", at_least(1), "steps between sorts by grid cell")
      .word("placement", &P::placement,
            {{"random", Placement::random},
             {"lattice", Placement::lattice},
             {"clustered", Placement::clustered},
             {"file", Placement::file}},
            "initial positions")
      .option("clusters", &P::clusters, "", at_least(1), "clustered: number of clouds")
      .when("placement", {"clustered"})
      .option("cluster_radius", &P::cluster_radius, "shortest side", positive(),
              "clustered: standard deviation of a cloud")
      .absent(brief(P{}.cluster_radius))
      .when("placement", {"clustered"})
      .option("file", &P::file, "file: CSV of positions x, y, z; beside the case")
      .absent("placement is not \"file\"")
      .beside_case()
      .option("overlap_samples", &P::overlap_samples, "", not_negative(),
              "points drawn for the overlap ratio of each row of the series; 0: off")
      .option("lyapunov", &P::lyapunov, "", not_negative(),
              "reference particles of the Lyapunov exponents; 0: none; needs records = \"double\"")
      .whole_optional()
      .behind_output();
}

}  // namespace

std::vector<Section> spectral_sections() {
  return {initial(), numerics(), forcing(), particles()};
}

}  // namespace spume
