// SPDX-License-Identifier: MIT
#include "spume/particles/settling.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/core/random.hpp"
#include "spume/core/vectors.hpp"
#include "spume/operators/sph_operators.hpp"
#include "spume/particles/wall_contacts.hpp"
#include "spume/scene/document.hpp"

namespace spume {
namespace {

constexpr double off_lattice = 0.2;            // spacings along each axis at most; 0.1 and 0.3 end in the same speeds
constexpr double longest_settling_move = 0.1;  // spacings a round
// Of h^2 grad C: stands eigenvalues of the moves up to 4 with all of the last one kept.
constexpr double settling_coefficient = 0.5;
// The slope of the force of wall_parting.hpp, times h^2 / 4: 1.5 of its stress in the plane where it begins, 3.1 a
// twentieth of a spacing nearer to the side.
constexpr double over_stress_of_sides = 3;
constexpr int even_after = 100;  // rounds: neighbours are evenly spaced, no layer has stretched
// Of gravity. Moves that end where forces are a saddle's grow: of fourteen tanks of 900 to 4,000 particles that end at
// 0.005 six pass 0.01 sqrt(gH) within 20 sqrt(H/g), at 0.001 four, at 0.0003 none passes 0.007 and ten stay below
// 0.001.
constexpr double settled = 0.0003;
// Rounds in which neither the largest nor the mean square of the accelerations falls by a hundredth: a particle in a
// slot in which it cannot rest has 15.7 g from round 300 to round 4,000, and the mean stays that of its surroundings.
// After 500 such rounds four of 40 tanks around random bodies are left with 0.7 to 6 % of gravity, which then settle.
constexpr int stalled = 1500;
constexpr double lower = 0.99;

}  // namespace

// Moves gather momentum until they go against the forces (O'Donoghue and Candes 2015): k rounds after that k / (k + 3)
// of the last one is kept. Four tanks of 1,000 to 4,000 particles take 490 to 1,030 rounds, with 0.9 throughout (the
// heavy ball of Polyak 1964) 530 to 1,380.
struct Settling::Round {
  // Of the last round, by identifier: the order of the particles changes.
  VectorScratch way, outwards;  // the direction of a contact
  int downhill = 0;             // rounds
  double worst = 0;             // acceleration, over that of gravity
  std::size_t of = 0;           // the particle that has it
  double squares = 0;           // of the accelerations, summed
  double least_worst = INFINITY, least_squares = INFINITY;
  int since = 0;  // rounds since one of them was lowered

  void find_progress() {
    ++since;
    if (worst < lower * least_worst || squares < lower * least_squares) since = 0;
    least_worst = std::min(least_worst, worst);
    least_squares = std::min(least_squares, squares);
  }
};

// Its pressure stays that of the layer at its height.
Vec3 Settling::move(std::size_t i, const Vec3& way) const {
  const int dimensions = particles.dimensions;
  const Vec3 before = vector_at(particles.position, dimensions, i);
  const WayToContact went = go_to_contact(boundary, before, way);
  for (int axis = 0; axis < dimensions; ++axis) (*particles.position[axis])[i] = went.end[axis];
  const double head = dot(gravity, subtract(went.end, before));
  excess[i] = law(i).excess(law(i).pressure(excess[i]) + law(i).density * head);
  return went.outwards;
}

// Or will within the next move.
bool Settling::meets_side(std::size_t i) const {
  for (int axis = 0; axis < particles.dimensions; ++axis)
    for (std::size_t side = 0; side < 2; ++side)
      if (is_wall(scene.domain.sides[axis][side].kind) &&
          std::abs((*particles.position[axis])[i] - boundary.walls[axis][side]) <
              (0.5 + longest_settling_move) * resolution.spacing)
        return true;
  return false;
}

void Settling::step(Round& round) const {
  const int dimensions = particles.dimensions;
  const double g = length(gravity), h = resolution.smoothing_length,
               longest = longest_settling_move * resolution.spacing;
  with_forces([&](const Forces& now) {
    const auto identifier = [&](std::size_t i) { return static_cast<std::size_t>((*particles.identifier)[i]); };
    const auto acceleration = [&](std::size_t i) {
      const double specific_volume = 1 / law(i).density;
      return add(multiply(specific_volume, vector_at(now.force, dimensions, i)),
                 multiply(1 - still.lost_share(specific_volume), gravity));
    };
    const auto free = [&](std::size_t i, const Vec3& v) {
      return without_inward(v, vector_at(round.outwards, dimensions, identifier(i)));
    };
    const double power = parallel_sum(particles.size(), [&](std::size_t i) {
      return law(i).density * dot(free(i, acceleration(i)), free(i, vector_at(round.way, dimensions, identifier(i))));
    });
    round.downhill = power < 0 ? 0 : round.downhill + 1;
    const double kept = round.downhill / (round.downhill + 3.0);
    struct Worst {
      double acceleration = 0;
      std::size_t of = 0;
      double squares = 0;
    };
    const Worst worst = parallel_reduce(
        particles.size(), Worst{},
        [&](std::size_t first, std::size_t last) {
          Worst so_far;
          for (std::size_t i = first; i < last; ++i) {
            const std::size_t id = identifier(i);
            if (!moves(id)) continue;
            const Vec3 a = acceleration(i);
            const double size = length(free(i, a)) / g;
            so_far.squares += size * size;
            if (!(size <= so_far.acceleration)) so_far.acceleration = size, so_far.of = i;
            // The force of a move by h^2 grad C, under the largest pressure of a pair: over the support gravity adds
            // 2 h g rho.
            const double rho = law(i).density, pressure = std::max(double{now.pressure[i]}, 0.0) +
                                                          (meets_side(i) ? over_stress_of_sides * of_sides * rho : 0);
            const double of_move = 2 * (pressure + h * g * rho);
            Vec3 next = add(multiply(kept, free(i, vector_at(round.way, dimensions, id))),
                            multiply(settling_coefficient * h * h * rho / of_move, a));
            if (const double way = length(next); way > longest) next = multiply(longest / way, next);
            for (int axis = 0; axis < dimensions; ++axis) round.way[axis][id] = next[axis];
          }
          return so_far;
        },
        [](const Worst& a, const Worst& b) {
          const Worst& larger = a.acceleration >= b.acceleration ? a : b;
          return Worst{larger.acceleration, larger.of, a.squares + b.squares};
        });
    round.worst = worst.acceleration;
    round.of = worst.of;
    round.squares = worst.squares;
  });
}

// Sums of the kernel gradient are exact for linear fields on average. With the factor of the lattice the pressure holds
// layers that are 0.2 % larger.
void Settling::fit_gradient_scale() const {
  ScratchArray<float> divergence_of_position(particles.scratch(), particles.size());
  KernelMoments moments;
  moments.divergence_of_position = divergence_of_position.data();
  kernel_moment_sweep(arrangement.context, arrangement.packed,
                      {.shifting = false, .normals = false, .spacing = resolution.spacing, .fading = {}}, moments);
  const double sum = parallel_sum(particles.size(), [&](std::size_t i) { return double{divergence_of_position[i]}; });
  arrangement.context.gradient_scale *= particles.dimensions * static_cast<double>(particles.size()) / sum;
}

// The datum of a closed tank is free. Below zero pressure pulls particles to the ceiling: where rows of the lattice do
// not end on it, all pressures rise until that of the highest row is the weight of half a row.
void Settling::raise_datum() const {
  double lightest = INFINITY;
  for (const Phase& phase : scene.phases) lightest = std::min(lightest, phase.density);
  const double wanted = lightest * length(gravity) * resolution.spacing / 2;
  const double rise =
      parallel_max(particles.size(), 0.0, [&](std::size_t i) { return wanted - law(i).pressure(excess[i]); });
  parallel_for(particles.size(), [&](std::size_t i) { excess[i] = law(i).excess(law(i).pressure(excess[i]) + rise); });
}

std::string Settling::settle(const GoOn& go_on) const {
  if (!scene.free_surface) raise_datum();
  Round round;
  for (VectorScratch* vector : {&round.way, &round.outwards}) {
    particles.scratch().lease(*vector, particles.dimensions, particles.size());
    for (int axis = 0; axis < particles.dimensions; ++axis) (*vector)[axis].fill(0.0);
  }
  parallel_for(particles.size(), [&](std::size_t i) {
    const auto id = static_cast<std::size_t>((*particles.identifier)[i]);
    if (!moves(id)) return;
    // Step 1: the jitter of the scene has step 0.
    const auto random = random_uniform(scene.seed, RandomPurpose::initial_jitter, id, 1, 0);
    Vec3 aside{};
    for (int axis = 0; axis < particles.dimensions; ++axis)
      aside[axis] = off_lattice * resolution.spacing * (2 * random[axis] - 1);
    move(i, aside);
  });
  step(round);
  for (int n = 0; n < most_rounds && round.worst > settled && round.since < stalled; ++n) {
    parallel_for(particles.size(), [&](std::size_t i) {
      const auto id = static_cast<std::size_t>((*particles.identifier)[i]);
      if (!moves(id)) return;
      const Vec3 outwards = move(i, vector_at(round.way, particles.dimensions, id));
      for (int axis = 0; axis < particles.dimensions; ++axis) round.outwards[axis][id] = outwards[axis];
    });
    // Liquid below a surface can stretch instead.
    if (n == even_after && !scene.free_surface) fit_gradient_scale();
    step(round);
    round.find_progress();
    if (go_on && !go_on(how_far(n + 1, round))) break;
  }
  for (VectorScratch* vector : {&round.way, &round.outwards}) particles.scratch().release(*vector);
  return round.worst <= settled ? std::string() : in_words(round);
}

HowFar Settling::how_far(int rounds, const Round& round) const {
  return {"round " + std::to_string(rounds) + " of at most " + std::to_string(most_rounds) + ", largest acceleration " +
              brief(100 * round.worst) + " % of gravity, settled at " + brief(100 * settled) + " %",
          static_cast<double>(rounds) / most_rounds};
}

std::string Settling::in_words(const Round& round) const {
  std::string text = "the liquid is not at rest at the start: the particle at (";
  for (int axis = 0; axis < particles.dimensions; ++axis)
    text += (axis == 0 ? "" : ", ") + brief((*particles.position[axis])[round.of]);
  return text + ") is accelerated by " + brief(100 * round.worst) + " % of gravity";
}

}  // namespace spume
