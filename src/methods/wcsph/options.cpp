// SPDX-License-Identifier: MIT
#include "spume/methods/wcsph/options.hpp"

namespace spume::wcsph {

Section compressibility_section() {
  using C = CompressibilityOptions;
  return section<C>("compressibility")
      .option(
          "max_speed", &C::max_speed, "m/s", not_negative(),
          "largest speed that is expected; sound is ten times as fast; 0: from gravity, forces and first velocities")
      .option("background_pressure", &C::background_pressure, "Pa", any_value,
              "added to every pressure; negative: rho max_speed^2 without gravity, free surface and shifting, what "
              "layers of "
              "liquids in a full tank need, else 0")
      .option("repulsion", &C::repulsion, "1", between(0, 0.2), "between phases, of the sum of their pressures")
      .steerable()
      .word("density_filter", &C::density_filter,
            {{"delta", DensityFilter::delta}, {"shepard", DensityFilter::shepard}, {"none", DensityFilter::none}},
            "smoothing of the density within each phase: diffusion, or the kernel average every so many steps")
      .option("diffusion", &C::diffusion, "1", between(0, 0.5), "coefficient of the diffusion of density")
      .steerable()
      .option("density_relaxation", &C::density_relaxation, "spacing", not_negative(),
              "way of the fastest particle over which densities follow the arrangement, below a free surface; 0: they "
              "do not")
      .word("shifting", &C::shifting, {{"auto", Shifting::automatic}, {"on", Shifting::on}, {"off", Shifting::off}},
            "of particles towards an even spacing; auto: in scenes without free surface, of one phase, with surface "
            "tension, or of liquids that flow in a full tank without bodies and openings")
      .word("interface_pressure", &C::interface_pressure,
            {{"auto", InterfacePressure::automatic},
             {"mean", InterfacePressure::mean},
             {"weighted", InterfacePressure::weighted}},
            "what phases meet at: the mean of their pressures, or that weighted with densities, under which "
            "accelerations are continuous; auto: weighted where phases lie in layers and where shifted liquids fill "
            "their tank; tension takes the mean")
      .option("filter_interval", &C::filter_interval, "", between(1, 10000), "steps between kernel averages")
      .option("settling_rounds", &C::settling_rounds, "", between(0, 100000),
              "most sweeps in which liquid that starts at rest settles before the first step; 0: it starts as filled");
}

Section list_section() {
  return section<ListOptions>("lists").option("skin", &ListOptions::skin, "spacing", above_up_to(0, 2),
                                              "how much farther than the kernel the lists of neighbours reach");
}

}  // namespace spume::wcsph
