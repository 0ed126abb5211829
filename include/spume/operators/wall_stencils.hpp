// SPDX-License-Identifier: MIT
// Values at wall points: points inside a solid of any shape that stand for the liquid mirrored at its surface
// (S. Marrone et al., Comput. Methods Appl. Mech. Engrg. 200 (2011), fixed ghost particles).
//
// Wall point g at a depth s below its foot on the surface, with the normal n out of the solid, mirrors the point
// m = foot + s n of the liquid. A value there is a sum over particles near m,
//
//   f(m) = sum_j c_j f_j,   sum_j c_j = 1,
//
// by a moving-least-squares fit of the highest order, up to 2, that the particles bear. With the velocity u_w of the
// surface,
//
//   scalar            f_g = f(m)                                       zero normal gradient at the surface
//   vector            v_g = v(m) - 2 (v(m) . n) n
//   velocity          u_g = u(m) - 2 ((u(m) - u_w) . n) n             free-slip, and all walls in rates of volume
//                     u_g = 2 u_w - u(m) + e                           no-slip, where friction is meant
//
// with the bend e: what the cubic that fits the same particles and u_w at the foot, which is pinned, has behind the
// wall beside the other terms; a parabola where particles bear no cubic, 0 where the fit at m is not quadratic. Without
// e velocities are odd about the wall and the curvature of a boundary layer ends there: the liquid slips by 0.3
// spacings^2 times its curvature. A parabola through u(m) and its slope, without the foot, is unstable: it answers a
// particle of the first row with four times its velocity, and the spectrum of the viscous sums ends at -10.5 / h^2. It
// ends at -6.6 with e = 0 and with the parabola, and at -8.3 to -9.2 with the cubic.
//
// Points behind an opening of the domain (particles/open_sides.hpp) stand for liquid that is to enter or has left:
//
//   scalar, vector    f(m)
//   velocity          u_w                                              inflow: given
//                     u(m)                                             outflow; of an acceleration inflow too
//   pressure          q(m) - (m - r_g) . n (a . n)                     inflow: grad q . n = a . n
//                     (1 + s) q_o - s q(m)                             outflow: q_o on the side, s its share of the way
//                     q_o                                              without liquid at m
//
// m of a point that is about to enter is a layer of points ahead of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "spume/core/array.hpp"

namespace spume {

enum class PointKind : std::uint8_t { wall, inflow, outflow };

struct WallStencils {
  // Per wall point: its entries begin at first[g] and end at first[g + 1].
  Array<std::int64_t> first;
  std::array<Array<float>, 3> normal, wall_velocity;
  Array<std::uint8_t> no_slip;
  Array<std::int32_t> nearest;  // the particle nearest to m
  // Of openings; empty without. What the pressure q takes: sign f(m) + given.
  Array<PointKind> kind;
  // Of inflows: what a predicted velocity has beside u_w, see OpenSides::give_gradients().
  std::array<Array<float>, 3> predicted;
  Array<float> pressure_sign;
  Array<double> given_pressure;
  // Per entry.
  Array<std::int32_t> source;
  Array<double> coefficient;
  Array<double> bend;  // e = sum_j e_j (u_j - u_w); empty without no-slip walls

  std::size_t size() const { return nearest.size(); }
  bool openings() const { return !kind.empty(); }
  bool is_wall(std::size_t g) const { return kind.empty() || kind[g] == PointKind::wall; }
  double bytes() const;
  void clear();  // no points; the memory stays

  // f(m).
  template <class T>
  double mirrored(std::size_t g, const T* values) const {
    const std::int64_t begin = first[g], end = first[g + 1];
    const double* const c = coefficient.data();
    const std::int32_t* const j = source.data();
    double sum = 0;
#pragma omp simd reduction(+ : sum)
    for (std::int64_t k = begin; k < end; ++k) sum += c[k] * static_cast<double>(values[j[k]]);
    return sum;
  }
  // q_g; `given` false leaves out what is given, as for a correction of q.
  template <class T>
  double pressure(std::size_t g, const T* values, bool given) const {
    if (kind.empty()) return mirrored(g, values);
    return pressure_sign[g] * mirrored(g, values) + (given ? given_pressure[g] : 0.0);
  }
  // u_w.
  std::array<double, 3> surface_velocity(std::size_t g, int dimensions) const {
    std::array<double, 3> u{};
    for (int axis = 0; axis < dimensions; ++axis) u[axis] = wall_velocity[axis][g];
    return u;
  }
  // u_g; `moving` false leaves the velocity of the surface out, as for accelerations beside a steady wall; `before`
  // adds what the pressure of the step is to take away; `bends` false leaves e out, whose bound is not linear.
  std::array<double, 3> velocity(std::size_t g, int dimensions, const std::array<const double*, 3>& velocity,
                                 bool friction, bool moving, bool before, bool bends = true) const;
  // v_g.
  std::array<double, 3> vector(std::size_t g, int dimensions, const std::array<const float*, 3>& values) const;
};

}  // namespace spume
