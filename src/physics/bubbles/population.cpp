// SPDX-License-Identifier: MIT
#include "spume/physics/bubbles/population.hpp"

#include <string>
#include <variant>

namespace spume::bubbles {

Population::Population(const Models& models) {
  const std::string axes[3] = {"_x", "_y", "_z"};
  const auto vector = [&](std::array<Array<double>*, 3>& target, const std::string& name, Lifetime lifetime) {
    for (std::size_t a = 0; a < 3; ++a) target[a] = &fields.add<double>("bubble_" + name + axes[a], lifetime);
  };
  vector(position, "position", Lifetime::state);
  vector(velocity, "velocity", Lifetime::state);
  volume = &fields.add<double>("bubble_volume", Lifetime::state);
  birth_time = &fields.add<double>("bubble_birth_time", Lifetime::state);
  identifier = &fields.add<std::int64_t>("bubble_identifier", Lifetime::state);
  at_rest_in_liquid = &fields.add<std::int64_t>("bubble_at_rest_in_liquid", Lifetime::state);
  slip = &fields.add<double>("bubble_slip", Lifetime::state);
  if (models.fluctuations) {
    vector(fluctuation, "fluctuation", Lifetime::state);
    vector(next_fluctuation, "next_fluctuation", Lifetime::result);
  }
  if (models.breakup) {
    deformation = &fields.add<double>("bubble_deformation", Lifetime::state);
    dissipation_integral = &fields.add<double>("bubble_dissipation_integral", Lifetime::state);
  }
  if (models.gas) {
    oxygen = &fields.add<double>("bubble_oxygen", Lifetime::state);
    inert = &fields.add<double>("bubble_inert_gas", Lifetime::state);
  }
  if (models.surface) merge_time = &fields.add<double>("bubble_merge_time", Lifetime::state);
  vector(next_position, "next_position", Lifetime::sorted);
  vector(next_velocity, "next_velocity", Lifetime::result);
}

double Population::traffic() const {
  double bytes = 0;
  for (const auto& field : fields.fields())
    bytes += std::visit([](const auto& array) { return static_cast<double>(array.size() * sizeof(array[0])); },
                        field->values);
  return bytes;
}

double Population::total_volume() const {
  return parallel_sum(size(), [&](std::size_t b) { return (*volume)[b]; });
}

std::size_t Population::settle(double t) {
  std::size_t births = 0;
  for (const auto& list : pending_births_) births += list.size();
  if (births == 0) return 0;
  std::size_t slot = size();
  fields.resize(slot + births);
  for (const auto& list : pending_births_)
    for (const NewBubble& bubble : list) {
      for (std::size_t a = 0; a < 3; ++a) {
        (*position[a])[slot] = bubble.position[a];
        (*next_position[a])[slot] = bubble.position[a];
        (*velocity[a])[slot] = bubble.velocity[a];
        if (fluctuation[a] != nullptr) (*fluctuation[a])[slot] = bubble.fluctuation[a];
      }
      (*volume)[slot] = bubble.volume;
      if (oxygen != nullptr) {
        (*oxygen)[slot] = bubble.oxygen;
        (*inert)[slot] = bubble.inert;
      }
      (*birth_time)[slot] = t;
      (*slip)[slot] = 0;
      (*identifier)[slot] = next_identifier++;
      (*at_rest_in_liquid)[slot] = bubble.at_rest_in_liquid ? 1 : 0;
      if (deformation != nullptr) (*deformation)[slot] = (*dissipation_integral)[slot] = 0;
      if (merge_time != nullptr) (*merge_time)[slot] = not_merging;
      ++slot;
    }
  return births;
}

void Population::remove(const Array<std::uint8_t>& dead) {
  const std::size_t n = size();
  order_.resize(n);
  // Survivors by blocks: counted, then written; the dead follow them.
  constexpr std::size_t blocks = 64;
  const std::size_t block = std::max<std::size_t>(1, (n + blocks - 1) / blocks);
  std::array<std::size_t, blocks + 1> alive{};
  parallel_blocks(n, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) alive[b + 1] += dead[i] == 0 ? 1 : 0;
  });
  for (std::size_t b = 0; b < blocks; ++b) alive[b + 1] += alive[b];
  const std::size_t survivors = alive[blocks];
  if (survivors == n) return;
  parallel_blocks(n, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    std::size_t slot = alive[b], grave = survivors + first - alive[b];
    for (std::size_t i = first; i < last; ++i) order_[dead[i] == 0 ? slot++ : grave++] = static_cast<std::int32_t>(i);
  });
  fields.permute(order_);
  fields.resize(survivors);
}

void Population::sort(const CellGrid& grid) {
  const auto build = [&] {
    table_.build(grid, next_position[0]->data(), next_position[1]->data(), next_position[2]->data(), size());
  };
  build();
  if (!table_.already_sorted()) fields.permute(table_.order());
}

}  // namespace spume::bubbles
