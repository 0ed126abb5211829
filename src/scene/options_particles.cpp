// SPDX-License-Identifier: MIT
// Options of [particles]: small spheres in the flow of the spectral method.
#include "option.hpp"

namespace spume {
namespace {

Option number(const char* key, const char* unit, const char* absent, Range range, const char* description,
              double ParticleCaseOptions::*member) {
  return {.key = key,
          .unit = unit,
          .absent = absent,
          .range = range,
          .description = description,
          .set = [member](Draft& d, const Value& v) { d.options.particles.*member = v.number; }};
}

Option numbers(const char* key, const char* unit, const char* absent, const char* description,
               std::vector<double> ParticleCaseOptions::*member) {
  return {.key = key,
          .type = OptionType::numbers,
          .unit = unit,
          .absent = absent,
          .description = description,
          .set = [member](Draft& d, const Value& v) { d.options.particles.*member = v.numbers; }};
}

Option integer(const char* key, const char* default_text, Range range, const char* description,
               std::int64_t ParticleCaseOptions::*member) {
  return {.key = key,
          .type = OptionType::integer,
          .default_text = default_text,
          .range = range,
          .description = description,
          .set = [member](Draft& d, const Value& v) { d.options.particles.*member = v.integer; }};
}

Option boolean(const char* key, const char* description, bool ParticleCaseOptions::*member) {
  return {.key = key,
          .type = OptionType::boolean,
          .default_text = "false",
          .description = description,
          .set = [member](Draft& d, const Value& v) { d.options.particles.*member = v.boolean; }};
}

Option word(const char* key, const char* default_text, std::vector<std::string> words, const char* description,
            std::function<void(ParticleCaseOptions&, const std::string&)> set) {
  return {.key = key,
          .type = OptionType::word,
          .default_text = default_text,
          .words = std::move(words),
          .description = description,
          .set = [set = std::move(set)](Draft& d, const Value& v) { set(d.options.particles, v.text); }};
}

}  // namespace

std::vector<Section> particle_sections() {
  using P = ParticleCaseOptions;
  Option count = integer("count", "", {1, 500000000}, "number of particles", &P::count);
  count.absent = "from volume_fraction";
  return {
      {.name = "particles",
       .options =
           {
               std::move(count),
               number("volume_fraction", "1", "from count", {0, 0.74, true, false},
                      "volume of all particles over that of the box; sets their number", &P::volume_fraction),
               number("diameter", "length", "see diameter_over_eta", positive(), "of every particle", &P::diameter),
               number("diameter_over_eta", "Kolmogorov length", "see diameter", positive(),
                      "diameter over (nu^3 / forcing.injection)^(1/4)", &P::diameter_over_eta),
               numbers("diameters", "length", "one diameter", "several diameters; the first is the reference",
                       &P::diameters),
               numbers("shares", "1", "equal", "share of the particles with each of the diameters", &P::shares),
               number("beta", "1", "1", between(0, 3), "3 / (1 + 2 rho_particle / rho_fluid): bubbles 3, tracers 1",
                      &P::beta),
               number("stokes", "1", "from the diameter", positive(),
                      "response time over (nu / forcing.injection)^(1/2)", &P::stokes),
               number("response_time", "time", "from the diameter", positive(),
                      "tau of the Stokes drag; without it and stokes, diameter^2 / (12 beta nu)", &P::response_time),
               word("drag", "\"stokes\"", {"stokes", "schiller-naumann"}, "law of the drag",
                    [](P& p, const std::string& w) {
                      p.drag = w == "stokes" ? ParticleDrag::stokes : ParticleDrag::schiller_naumann;
                    }),
               numbers("gravity", "length/time2", "none", "acceleration of gravity, three entries", &P::gravity),
               word("coupling", "\"one-way\"", {"one-way", "two-way", "four-way", "colliding"},
                    "flow moves particles; particles move the flow too; and exclude each other; colliding: exclude "
                    "each other, "
                    "while the flow feels nothing",
                    [](P& p, const std::string& w) {
                      p.coupling = w == "one-way"    ? ParticleCoupling::one_way
                                   : w == "two-way"  ? ParticleCoupling::two_way
                                   : w == "four-way" ? ParticleCoupling::four_way
                                                     : ParticleCoupling::colliding;
                    }),
               with({"coupling", {"four-way", "colliding"}},
                    word("matching", "\"rounds\"", {"rounds", "sorting"},
                         "how the strongest overlaps are found; both give the same pairs",
                         [](P& p, const std::string& w) { p.matching_by_sorting = w == "sorting"; })),
               with({"coupling", {"four-way", "colliding"}},
                    integer("collision_sweeps", "1", {1, 1000},
                            "four-way: collisions a particle may have in a step; the paper's is 1",
                            &P::collision_sweeps)),
               with({"coupling", {"two-way", "four-way"}},
                    number("max_volume_fraction", "1", "0.7405, close packing", above_up_to(0, 1),
                           "local volume fraction at which the force on the flow is clipped", &P::max_volume_fraction)),
               with({"coupling", {"two-way", "four-way"}},
                    boolean("mean_force_moves_fluid",
                            "the mean of their force accelerates the fluid, in place of a mean pressure gradient "
                            "that holds it",
                            &P::mean_force_moves_fluid)),
               boolean("frozen", "particles stay at rest where they are", &P::frozen),
               integer("spline_order", "4", {2, 6}, "points per axis of the interpolation: 2, 4 or 6",
                       &P::spline_order),
               word("records", "\"single\"", {"single", "double"}, "precision of the interpolated velocity",
                    [](P& p, const std::string& w) { p.double_records = w == "double"; }),
               integer("sort_every", "8", {1, unbounded}, "steps between sorts by grid cell", &P::sort_every),
               word("placement", "\"random\"", {"random", "lattice", "clustered", "file"}, "where particles start",
                    [](P& p, const std::string& w) {
                      p.placement = w == "random"      ? ParticlePlacement::random
                                    : w == "lattice"   ? ParticlePlacement::lattice
                                    : w == "clustered" ? ParticlePlacement::clustered
                                                       : ParticlePlacement::file;
                    }),
               with({"placement", {"clustered"}},
                    integer("clusters", "8", {1, unbounded}, "clustered: number of clouds", &P::clusters)),
               with({"placement", {"clustered"}},
                    number("cluster_radius", "shortest side", "0.05", positive(),
                           "clustered: standard deviation of a cloud", &P::cluster_radius)),
               {.key = "file",
                .type = OptionType::string,
                .absent = "placement is not \"file\"",
                .description = "file: CSV of positions x, y, z; beside the case",
                .set = [](Draft& d, const Value& v) { d.options.particles.file = v.text; },
                .beside_case = true},
               integer("overlap_samples", "20000", not_negative(),
                       "points drawn for the overlap ratio of each row of the series; 0: not found",
                       &P::overlap_samples),
               integer("lyapunov", "0", not_negative(),
                       "reference particles of the Lyapunov exponents; 0: none; needs records = \"double\"",
                       &P::lyapunov),
           },
       .methods = {"spectral"},
       .optional = true}};
}

}  // namespace spume
