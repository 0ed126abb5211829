// SPDX-License-Identifier: MIT
// Arrays that a step needs for a while. A stage leases one, whoever reads it last releases it, and the memory serves
// the next lease of the same type: what a step holds at a time is what exists, not what it ever names. Contents are
// undefined after a lease.
#pragma once

#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

#include "spume/core/array.hpp"

namespace spume {

class ScratchPool {
 public:
  // Gives `array` room for `size` elements; one that holds a lease keeps it.
  template <class T>
  void lease(Array<T>& array, std::size_t size) {
    auto& idle = std::get<std::vector<Array<T>>>(idle_);
    if (array.capacity() == 0 && !idle.empty()) {
      array.swap(idle.back());
      idle.pop_back();
    }
    array.resize(size);
  }
  template <class T, std::size_t count>
  void lease(std::array<Array<T>, count>& arrays, int used, std::size_t size) {
    for (int k = 0; k < used; ++k) lease(arrays[static_cast<std::size_t>(k)], size);
  }

  // Takes the memory back; the array is empty afterwards.
  template <class T>
  void release(Array<T>& array) {
    if (array.capacity() == 0) return;
    auto& idle = std::get<std::vector<Array<T>>>(idle_);
    idle.emplace_back();
    idle.back().swap(array);
  }
  template <class T, std::size_t count>
  void release(std::array<Array<T>, count>& arrays) {
    for (Array<T>& array : arrays) release(array);
  }

  // Of what is not leased now.
  double idle_bytes() const {
    double sum = 0;
    std::apply([&](const auto&... lists) { ((add_bytes(lists, sum)), ...); }, idle_);
    return sum;
  }

 private:
  template <class List>
  static void add_bytes(const List& list, double& sum) {
    for (const auto& array : list) sum += array.bytes();
  }
  std::tuple<std::vector<Array<double>>, std::vector<Array<float>>, std::vector<Array<std::int32_t>>,
             std::vector<Array<std::uint8_t>>>
      idle_;
};

// An array leased for a scope.
template <class T>
class ScratchArray : public Array<T> {
 public:
  ScratchArray(ScratchPool& pool, std::size_t size) : pool_(pool) { pool.lease<T>(*this, size); }
  ScratchArray(const ScratchArray&) = delete;
  ScratchArray& operator=(const ScratchArray&) = delete;
  ~ScratchArray() { pool_.release<T>(*this); }

 private:
  ScratchPool& pool_;
};

}  // namespace spume
