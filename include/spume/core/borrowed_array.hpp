// SPDX-License-Identifier: MIT
// Numbers of any type, for a scope, in memory of a pool that is leased as floats, which every step has: what is wanted
// where no step's own arrays are needs no memory. Contents are undefined.
#pragma once

#include <cstddef>
#include <utility>

#include "spume/core/scratch_pool.hpp"

namespace spume {

template <class T>
class BorrowedArray {
 public:
  BorrowedArray(ScratchPool& pool, std::size_t size) : pool_(pool), size_(size) {
    pool_.lease(memory_, (size * sizeof(T) + sizeof(float) - 1) / sizeof(float));
  }
  BorrowedArray(const BorrowedArray&) = delete;
  BorrowedArray& operator=(const BorrowedArray&) = delete;
  ~BorrowedArray() { pool_.release(memory_); }

  // Arrays are aligned for all types; nobody reads the memory as floats.
  T* data() const { return reinterpret_cast<T*>(memory_.data()); }
  std::size_t size() const { return size_; }

 private:
  ScratchPool& pool_;
  mutable Array<float> memory_;
  std::size_t size_;
};

}  // namespace spume
