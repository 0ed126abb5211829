// SPDX-License-Identifier: MIT
// A 64-byte aligned array for hot loops. Growing keeps the contents; shrinking keeps the memory, so that a
// run in steady state allocates nothing. New memory is first touched by the threads that will use it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

namespace spume {

// Bytes held by all arrays of the process and the number of allocations made so far. The allocation
// count is what the steady-state tests compare between steps.
struct ArrayStatistics {
  std::int64_t bytes;
  std::int64_t peak_bytes;
  std::int64_t allocations;
};
ArrayStatistics array_statistics();

namespace detail {
void* allocate_aligned(std::size_t bytes);  // zero-filled in parallel (first touch); throws std::bad_alloc
void release_aligned(void* pointer, std::size_t bytes) noexcept;
}  // namespace detail

template <class T>
class Array {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Array() = default;
  explicit Array(std::size_t size) { resize(size); }
  Array(std::size_t size, T value) : Array(size) { fill(value); }
  Array(const Array& other) { *this = other; }
  Array(Array&& other) noexcept { swap(other); }
  Array& operator=(const Array& other) {
    if (this != &other) {
      resize(other.size_);
      if (size_ > 0) std::memcpy(static_cast<void*>(data_), other.data_, size_ * sizeof(T));
    }
    return *this;
  }
  Array& operator=(Array&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Array() { detail::release_aligned(data_, capacity_ * sizeof(T)); }

  void swap(Array& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

  // Contents up to the smaller size are kept; new elements beyond the old capacity are zero.
  void resize(std::size_t size) {
    reserve(size);
    size_ = size;
  }
  // Grows geometrically so that slowly growing sets settle after a few steps.
  void reserve(std::size_t wanted) {
    if (wanted <= capacity_) return;
    const std::size_t grown = capacity_ + capacity_ / 4;
    const std::size_t capacity = wanted > grown ? wanted : grown;
    T* fresh = static_cast<T*>(detail::allocate_aligned(capacity * sizeof(T)));
    if (size_ > 0) std::memcpy(static_cast<void*>(fresh), data_, size_ * sizeof(T));
    detail::release_aligned(data_, capacity_ * sizeof(T));
    data_ = fresh;
    capacity_ = capacity;
  }
  // Room for `size` elements and a 32nd more, without the contents: for large arrays that are written anew, of which
  // the quarter that reserve() grows by would stay unused.
  void fit(std::size_t size) {
    if (size > capacity_) {
      release();
      reserve(size + size / 32);
    }
    size_ = size;
  }
  void release() { Array().swap(*this); }
  double bytes() const { return static_cast<double>(capacity_ * sizeof(T)); }
  void fill(T value) {
    for (std::size_t i = 0; i < size_; ++i) data_[i] = value;
  }

  T* data() { return data_; }
  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  bool empty() const { return size_ == 0; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }
  operator std::span<T>() { return {data_, size_}; }
  operator std::span<const T>() const { return {data_, size_}; }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace spume
