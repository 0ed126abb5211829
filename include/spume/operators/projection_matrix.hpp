// SPDX-License-Identifier: MIT
// The matrix of a pressure equation as its solver sees it, whatever sums it stands for.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "spume/operators/dots.hpp"

namespace spume {

struct SweepContext;
struct TiedRows;

class ProjectionMatrix;

// Of a matrix K - G R in which R q is how bodies that float are accelerated by q.
class BodyCoupling {
 public:
  virtual ~BodyCoupling() = default;
  virtual ProjectionMatrix& liquid() = 0;  // K
  // R q of what is 1 on some unknowns, ascending, and 0 elsewhere: of each acceleration, over what all unknowns would
  // make of it if their pushes had one direction and nothing held the bodies.
  virtual std::vector<double> relative_response(std::span<const std::int32_t> members) const = 0;
};

class ProjectionMatrix {
 public:
  virtual ~ProjectionMatrix() = default;
  virtual std::size_t size() const = 0;
  // The lists, images and wall points that its rows pass over; null: rows meet more than these.
  virtual const SweepContext* context() const { return nullptr; }
  // What rows of liquid that touches bodies which float meet beside these; null: nothing.
  virtual BodyCoupling* coupling() { return nullptr; }
  // Rows whose unknown follows from others; null: none.
  virtual const TiedRows* tied() const { return nullptr; }
  // y = A x in float, with sum w y and sum y y accumulated in double in fixed blocks.
  virtual Dots apply(std::span<const float> x, std::span<float> y, std::span<const float> w) = 0;
  // r = b - A q with q, differences and sums in double. `given` false: without the pressures given behind openings, as
  // for a change of q.
  virtual void residual(std::span<const double> q, std::span<const double> b, std::span<double> r, bool given) = 0;
  // r -= scale A x with x in float and all else as in residual().
  virtual void subtract_product(double scale, std::span<const float> x, std::span<double> r) = 0;
};

}  // namespace spume
