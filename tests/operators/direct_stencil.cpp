// SPDX-License-Identifier: MIT
#include "operators/direct_stencil.hpp"

#include <cmath>

#include "support/direct_solution.hpp"

namespace spume::test {

DirectStencil direct_stencil(const JitteredParticles& particles, const std::array<double, 3>& x,
                             double support_radius) {
  DirectStencil stencil;
  std::vector<double> root_kernel;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    std::array<double, 3> offset{};
    double squared = 0;
    for (int d = 0; d < particles.dimensions; ++d) {
      offset[d] = std::remainder(particles.position[d][i] - x[d], 1.0);
      squared += offset[d] * offset[d];
    }
    const double s = std::sqrt(squared) / support_radius;
    if (s >= 1) continue;
    stencil.particle.push_back(i);
    stencil.offset.push_back(offset);
    root_kernel.push_back(std::sqrt(std::pow(1 - s, 4) * (1 + 4 * s)));
  }
  const int planes = particles.dimensions == 3 ? 3 : 0;
  std::vector<std::array<int, 3>> exponents;
  for (int a = 0; a <= 3; ++a)
    for (int b = 0; a + b <= 3; ++b)
      for (int c = 0; a + b + c <= 3 && c <= planes; ++c) exponents.push_back({a, b, c});
  const auto rows = static_cast<Eigen::Index>(exponents.size());
  const auto columns = static_cast<Eigen::Index>(root_kernel.size());
  Eigen::MatrixXd conditions(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j)
    for (Eigen::Index m = 0; m < rows; ++m) {
      double value = root_kernel[j];
      for (int d = 0; d < 3; ++d) value *= std::pow(stencil.offset[j][d] / support_radius, exponents[m][d]);
      conditions(m, j) = value;
    }
  const Eigen::MatrixXd solution = least_squares(conditions, Eigen::VectorXd::Unit(rows, 0));
  for (Eigen::Index j = 0; j < columns; ++j) stencil.weight.push_back(solution(j) * root_kernel[j]);
  return stencil;
}

}  // namespace spume::test
