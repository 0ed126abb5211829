// SPDX-License-Identifier: MIT
// Oxygen that bubbles exchange with the liquid (physics/oxygen): what they see of its concentration, what they give,
// and what they hold. It rides on the passes of the momentum exchange, with the same weights.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "liquid_record.hpp"
#include "spume/physics/bubbles/coupling.hpp"

namespace spume::bubbles {
namespace {

// m. Surface tension, which the pressure of a bubble leaves out, is as much as a quarter of an atmosphere then, and a
// bubble of air in saturated water lives for seconds (Epstein and Plesset 1950).
constexpr double least_radius = 5e-6;

}  // namespace

// Where the record has room the concentration comes with the other sums of a bubble: a sum of its own takes 0.05 to
// 0.07 us of it.
int BubbleCoupling::dissolved_slot() const {
  using namespace liquid_record;
  if (!exchanges_gas()) return -1;
  if (population_.fluctuation[0] == nullptr) return energy_at;
  return options_.breakup ? -1 : dissipation_at;
}

// The concentrations times what multiplies the values of liquid_records_.
void BubbleCoupling::pack_dissolved() {
  const std::size_t n = carrier_.size(), m = carrier_.arrangement.images.size();
  dissolved_.resize(n + m);
  parallel_for(n, [&](std::size_t i) {
    const float inverse = 1 / carrier_.sizes.length_ratio[i];
    dissolved_[i] =
        carrier_.sizes.volume_ratio[i] * inverse * inverse * inverse * static_cast<float>((*carrier_.dissolved)[i]);
  });
  const std::int32_t* source = carrier_.arrangement.images.source();
  parallel_for(m, [&](std::size_t k) { dissolved_[n + k] = dissolved_[static_cast<std::size_t>(source[k])]; });
}

float BubbleCoupling::sum_of_dissolved(const CrossSearch::Found& found) const {
  const float* weight = found.share2.data();  // set by sum_of_lines
  const std::int32_t* index = found.index.data();
  const float* values = dissolved_.data();
  // An addition takes longer than a load: eight sums side by side.
  float sum[simd::lanes] = {};
  std::size_t k = 0;
  for (; k + simd::lanes <= found.size; k += simd::lanes)
    for (std::size_t l = 0; l < simd::lanes; ++l) sum[l] += weight[k + l] * values[index[k + l]];
  for (; k < found.size; ++k) sum[k % simd::lanes] += weight[k] * values[index[k]];
  float total = 0;
  for (const float part : sum) total += part;
  return total;
}

// What bubble b gives over dt; it is taken over with the step.
float BubbleCoupling::dissolve(std::size_t b, double radius, double slip, double dt) {
  const oxygen::Exchange result =
      oxygen::exchange(*carrier_.gas, next_gas_[b].contents, oxygen::sphere(radius), (*population_.next_position[2])[b],
                       slip, dissolved_at_bubble_[b], dt);
  next_gas_[b] = {result.after, result.given, result.conductance, result.capacity};
  if (dissolves_whole(result.after, (*population_.next_position[2])[b])) {
    next_gas_[b].contents = {};
    next_gas_[b].given += oxygen::mass(result.after);
  }
  return static_cast<float>(next_gas_[b].given);
}

// One whose volume follows from its gas, and that has next to none: the liquid takes the rest.
bool BubbleCoupling::dissolves_whole(const oxygen::Contents& contents, double height) const {
  constexpr double least_volume = 4 * std::numbers::pi / 3 * least_radius * least_radius * least_radius;
  return carrier_.gas->shrinks && carrier_.gas->volume(contents.oxygen + contents.inert, height) < least_volume;
}

void BubbleCoupling::sum_gas() {
  const std::size_t nb = population_.size();
  const auto sum = [&](double GasState::*member) {
    return parallel_sum(nb, [&](std::size_t b) { return next_gas_[b].*member; });
  };
  next_gas_totals_ = {
      .given = sum(&GasState::given), .conductance = sum(&GasState::conductance), .capacity = sum(&GasState::capacity)};
  next_gas_totals_.area = parallel_sum(nb, [&](std::size_t b) {
    const double radius = population_.radius(b);
    return 4 * std::numbers::pi * radius * radius;
  });
}

void BubbleCoupling::accept_gas() {
  parallel_for(population_.size(), [&](std::size_t b) {
    const oxygen::Contents& contents = next_gas_[b].contents;
    (*population_.oxygen)[b] = contents.oxygen;
    (*population_.inert)[b] = contents.inert;
    if (carrier_.gas->shrinks)
      (*population_.volume)[b] = carrier_.gas->volume(contents.oxygen + contents.inert, (*population_.position[2])[b]);
    // A radius of zero is none that forces or breakup know: it goes in this step.
    if (carrier_.gas->shrinks && contents.oxygen + contents.inert == 0) dead_[b] = 1;
  });
  if (carrier_.gas->shrinks)
    oxygen_.dissolved += parallel_sum(population_.size(), [&](std::size_t b) {
      return next_gas_[b].contents.oxygen + next_gas_[b].contents.inert == 0 ? 1.0 : 0.0;
    });
  gas_totals_ = next_gas_totals_;
  oxygen_.given += gas_totals_.given;
}

// Gas of this mole fraction in bubbles without contents.
void BubbleCoupling::fill_new_bubbles(double fraction) {
  const auto filled = [&](std::size_t b) {
    double& oxygen = (*population_.oxygen)[b];
    if (oxygen != no_gas_yet) return 0.0;
    const double total = carrier_.gas->moles((*population_.volume)[b], (*population_.position[2])[b]);
    oxygen = fraction * total;
    (*population_.inert)[b] = total - oxygen;
    return oxygen;
  };
  oxygen_.released += oxygen::molar_mass * parallel_sum(population_.size(), filled);
}

double BubbleCoupling::oxygen_feed() const {
  double feed = 0;
  sources_.for_rates(carrier_.time, [&](const Vec3& place, double rate) {
    feed += oxygen::molar_mass * carrier_.gas->fraction * carrier_.gas->moles(rate, place[2]);
  });
  return feed;
}

void BubbleCoupling::each(const Each& see) const {
  for (std::size_t b = 0; b < population_.size(); ++b)
    see(vector_at(population_.next_position, 3, b), next_gas_[b].conductance, next_gas_[b].capacity);
}

void BubbleCoupling::add_gas_columns(SeriesTable& table) const {
  table.add("bubble_area", "length^2", [this] { return population_.empty() ? 0.0 : gas_totals_.area; });
  table.add("oxygen_released", "g, with the gas, since the start", [this] { return oxygen_.released; });
  table.add("oxygen_from_bubbles", "g, given to the liquid since the start", [this] { return oxygen_.given; });
  table.add("oxygen_left", "g, with bubbles that burst, since the start", [this] { return oxygen_.left; });
  if (carrier_.gas->shrinks)
    table.add("bubbles_dissolved", "1, whole, since the start", [this] { return oxygen_.dissolved; });
  table.add("oxygen_in_bubbles", "g", [this] {
    return oxygen::molar_mass *
           parallel_sum(population_.size(), [&](std::size_t b) { return (*population_.oxygen)[b]; });
  });
}

}  // namespace spume::bubbles
