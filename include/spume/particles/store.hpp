// SPDX-License-Identifier: MIT
// The particles of a method: positions, velocities, identifiers, and whatever fields its stages name. Units are those
// of the scene.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "spume/core/field_set.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

// One array per dimension; null beyond the dimensions of the scene, or when no stage needs the vector.
using VectorField = std::array<Array<double>*, 3>;
using FloatVectorField = std::array<Array<float>*, 3>;
// The same, for those who read alone.
using ConstVectorField = std::array<const Array<double>*, 3>;
using ConstFloatVectorField = std::array<const Array<float>*, 3>;
// The same, leased for a part of a step.
using VectorScratch = std::array<Array<double>, 3>;
using FloatVectorScratch = std::array<Array<float>, 3>;

struct ParticleStore {
  ParticleStore(int scene_dimensions, const InitialParticles& initial);

  const int dimensions;
  const double volume;  // of every particle
  FieldSet fields;
  VectorField position{}, velocity{};
  Array<std::int64_t>* identifier = nullptr;

  std::size_t size() const { return fields.size(); }
  ScratchPool& scratch() { return fields.scratch(); }

  // Adds `<name>_x`, `_y` and, in three dimensions, `_z`.
  template <class T>
  void add_vector(std::array<Array<T>*, 3>& vector, const std::string& name, Lifetime lifetime) {
    static const char* const suffix[3] = {"_x", "_y", "_z"};
    for (int axis = 0; axis < dimensions; ++axis) vector[axis] = &fields.add<T>(name + suffix[axis], lifetime);
  }
};

template <class T>
std::array<const Array<T>*, 3> constant(const std::array<Array<T>*, 3>& vector) {
  return {vector[0], vector[1], vector[2]};
}

// Pointers to the components, null where there is none.
template <class T>
std::array<const T*, 3> read(const std::array<const Array<T>*, 3>& vector) {
  std::array<const T*, 3> pointers{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    pointers[axis] = vector[axis] == nullptr ? nullptr : vector[axis]->data();
  return pointers;
}
template <class T>
std::array<const T*, 3> read(const std::array<Array<T>*, 3>& vector) {
  return read(constant(vector));
}
template <class T, std::size_t count>
std::array<const T*, count> read(const std::array<Array<T>, count>& arrays) {
  std::array<const T*, count> pointers{};
  for (std::size_t k = 0; k < count; ++k) pointers[k] = arrays[k].empty() ? nullptr : arrays[k].data();
  return pointers;
}
template <class T>
std::array<T*, 3> write(const std::array<Array<T>*, 3>& vector) {
  std::array<T*, 3> pointers{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    pointers[axis] = vector[axis] == nullptr ? nullptr : vector[axis]->data();
  return pointers;
}
template <class T, std::size_t count>
std::array<T*, count> write(std::array<Array<T>, count>& arrays) {
  std::array<T*, count> pointers{};
  for (std::size_t k = 0; k < count; ++k) pointers[k] = arrays[k].empty() ? nullptr : arrays[k].data();
  return pointers;
}

// The vector of particle i, zero beyond the dimensions.
template <class T>
Vec3 vector_at(const std::array<Array<T>*, 3>& vector, int dimensions, std::size_t i) {
  Vec3 value{};
  for (int axis = 0; axis < dimensions; ++axis) value[axis] = (*vector[axis])[i];
  return value;
}
template <class T>
Vec3 vector_at(const std::array<Array<T>, 3>& vector, int dimensions, std::size_t i) {
  Vec3 value{};
  for (int axis = 0; axis < dimensions; ++axis) value[axis] = vector[axis][i];
  return value;
}

// u . u, summed along the axes in order.
template <class Vector>
double squared_norm(const Vector& vector, int dimensions, std::size_t i) {
  const Vec3 v = vector_at(vector, dimensions, i);
  double sum = 0;
  for (int axis = 0; axis < dimensions; ++axis) sum += v[axis] * v[axis];
  return sum;
}

}  // namespace spume
