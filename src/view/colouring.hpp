// SPDX-License-Identifier: MIT
// What a family may be coloured by: one component of a field, or the size of a vector.
#pragma once

#include <string>
#include <vector>

#include "spume/view/frame.hpp"

namespace spume {

struct Colouring {
  std::string name, unit;
  std::size_t field = 0;
  int component = -1;  // -1: the size
};

std::vector<Colouring> all_colourings(const ParticleSnapshot& family);
std::vector<Colouring> all_colourings(const GridSnapshot& grid);
// The one that is wanted for the family, or the first; null without any.
const Colouring* chosen(const std::vector<Colouring>& list, const std::string& family, const FrameWish& wish);

}  // namespace spume
