// SPDX-License-Identifier: MIT
// Potentials of interfaces between phases: what jumps across an interface, sigma kappa of the tension or the weight of
// a jump of density, known in its band and continued across it. Equations (6) and (14) to (16) of Joubert, Wilke and
// Pizette (operators/interface_curvature.hpp); what averages over the kernel take of long waves is given back.
#pragma once

#include "spume/operators/interface_bands.hpp"
#include "spume/particles/arrangement.hpp"

namespace spume {

// A colour function C^n whose interface is followed.
struct Colour {
  std::size_t phase = 0;
  double tension = 0;         // share of sigma: sigma_ab = sigma_a + sigma_b
  double density_jump = 0;    // rho_n - rho_0
  Array<float> value{};       // C
  Array<float> potential{};   // phi - <phi>, at the particles that face another phase; 0 elsewhere
  double mean_potential = 0;  // <phi>
  double area = 0;            // of the interface: integral of |grad C|
  double is(std::uint8_t number) const { return number == phase ? 1 : 0; }  // c
};
// Of every phase but the first in a scene of two, else of all; none of one phase.
std::vector<Colour> colours_of(const Scene& scene);
// The interface of two phases is that of each of their colours.
double interface_area(const std::vector<Colour>& colours);
double surface_energy(const std::vector<Colour>& colours);

// Least sqrt((rho_a + rho_b) spacing^3 / (4 pi sigma)) of two phases; infinite without tension.
double capillary_time(const Scene& scene);

// Where interfaces are looked at.
struct InterfaceView {
  Arrangement& arrangement;
  const InterfaceBands& bands;
  const Resolution& resolution;
  double particle_volume;
  const std::vector<std::array<float, 3>>& reflection;  // of geometric vectors, per path of an image
  std::array<const float*, 6> correction;               // B of gfd_moments.hpp, at the varying particles
  ScratchPool& scratch;
  int smoothing;                                  // InterfaceOptions
  const Array<std::int64_t>* left_out = nullptr;  // of the area, particles with 0 or more; null: none
};

// Measures the interface of a colour, whose value is known, and adds to its potential.
class InterfaceMeasure {
 public:
  // Sets the potential of the colour to zero and finds its area. curved: its curvature is wanted.
  InterfaceMeasure(const InterfaceView& view, Colour& colour, bool curved);
  ~InterfaceMeasure();
  InterfaceMeasure(const InterfaceMeasure&) = delete;
  InterfaceMeasure& operator=(const InterfaceMeasure&) = delete;

  void add_tension();  // sigma kappa
  // The weight of the jump of density: height(i) = -g . (x_i - x_0), gravity across sides.
  template <class Height>
  void add_weight(const Vec3& gravity, Height&& height) {
    add(averages_of_height(), [&](std::size_t i, double distance) {
      double sum = height(i);
      for (int axis = 0; axis < view_.arrangement.context.dimensions; ++axis)
        sum += distance * gravity[axis] * normal_[axis][i];
      return colour_.density_jump * sum;
    });
  }

 private:
  void find_normals_and_area();
  static double averages_of_height();
  double distance(std::size_t i) const;  // from the interface along the normal
  // A potential from value(i, distance), measured through `averages` of the kernel.
  template <class Value>
  void add(double averages, Value&& value) {
    parallel_for(facing_.size(), [&](std::size_t s) {
      const auto i = static_cast<std::size_t>(facing_[s]);
      potential_[i] = static_cast<float>(value(i, distance(i)));
    });
    continue_across_band(averages);
  }
  void continue_across_band(double averages);

  const InterfaceView view_;
  const std::span<const std::int32_t> facing_;
  Colour& colour_;
  const double width_;  // of the kernel
  FloatVectorScratch normal_;
  Array<float> curvature_, weight_, potential_;
};

}  // namespace spume
