// SPDX-License-Identifier: MIT
// What a particle sees of the points around it, where something between them hides some: lists of neighbours then hold
// those that it sees.
#pragma once

#include <cstddef>

namespace spume {

class Sight {
 public:
  Sight() = default;
  Sight(const Sight&) = delete;
  Sight& operator=(const Sight&) = delete;
  virtual ~Sight() = default;
  // That nothing within its support is hidden from a particle; false where that is not known.
  virtual bool open_around(std::size_t particle) const = 0;
  // Points are numbered as in the lists: particles, then images. Of two particles each sees the other or neither does.
  virtual bool sees(std::size_t particle, std::size_t point) const = 0;
};

}  // namespace spume
