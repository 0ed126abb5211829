// SPDX-License-Identifier: MIT
// The force of [forcing], and the energy that it and others put into the flow.
#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/core/parallel.hpp"
#include "spume/methods/spectral/flow.hpp"

namespace spume::spectral {

// The force that injects exactly forcing.injection: f = coefficient u on the shell (de Wit et al., below (2)); sums run
// over all of k-space. For the linear force the coefficient is the rate.
template <class T>
double Flow<T>::forcing_coefficient(const Modes<T>& potential) const {
  if (forcing_.kind == ForcingKind::none) return 0;
  if (forcing_.kind == ForcingKind::linear) return forcing_.rate;
  double sum = 0;
  const auto& k = layout_.wavenumber;
  for (std::size_t ix = 0; ix < layout_.points[0]; ++ix) {
    if (k[0][ix] * k[0][ix] >= shell_high_) continue;
    for (std::size_t iy = 0; iy < layout_.points[1]; ++iy) {
      if (k[0][ix] * k[0][ix] + k[1][iy] * k[1][iy] >= shell_high_) continue;
      for (std::size_t iz = 0; iz < layout_.modes_z; ++iz) {
        const double k2 = k[0][ix] * k[0][ix] + k[1][iy] * k[1][iy] + k[2][iz] * k[2][iz];
        if (k2 >= shell_high_) break;
        if (k2 < shell_low_ || k2 == 0) continue;
        double square = 0;
        for (const auto& field : potential)
          square += std::norm(std::complex<double>(field[ix * layout_.plane + iy * layout_.row + iz]));
        sum += ModeLayout::weight(iz) * k2 * square;
      }
    }
  }
  return sum > std::numeric_limits<double>::min() ? forcing_.injection / sum : 0;
}

template <class T>
void Flow<T>::set_forcing_coefficient() {
  forcing_coefficient_ = forcing_coefficient(argument());
}

template <class T>
double Flow<T>::forced_energy() const {
  const double growth = forcing_coefficient(potential_);
  return forcing_.kind == ForcingKind::shell && growth > 0 ? forcing_.injection / (2 * growth) : 0;
}

template <class T>
EnergyBudget Flow<T>::measure_budget() const {
  const auto [nx, ny, nz] = layout_.points;
  struct Sums {
    double energy = 0, dissipation = 0, forced = 0, work = 0;
  };
  std::vector<Sums> sums(nx);
  const double coefficient = forcing_coefficient(potential_);
  parallel_blocks(nx, 1, [&, ny = ny](std::size_t, std::size_t ix, std::size_t) {
    Sums& sum = sums[ix];
    for (std::size_t iy = 0; iy < ny; ++iy)
      for (std::size_t iz = 0; iz < layout_.modes_z; ++iz) {
        const std::size_t at = ix * layout_.plane + iy * layout_.row + iz;
        const double k[3] = {layout_.wavenumber[0][ix], layout_.wavenumber[1][iy], layout_.wavenumber[2][iz]};
        const double k2 = k[0] * k[0] + k[1] * k[1] + k[2] * k[2], weight = ModeLayout::weight(iz);
        std::complex<double> b[3];
        double square = 0;
        for (std::size_t c = 0; c < 3; ++c) square += std::norm(b[c] = std::complex<double>(potential_[c][at]));
        sum.energy += weight * (k2 > 0 ? k2 : 1) * square / 2;
        sum.dissipation += weight * viscosity_ * k2 * k2 * square;
        if (forcing_.kind == ForcingKind::linear || (k2 >= shell_low_ && k2 < shell_high_))
          sum.forced += weight * coefficient * k2 * square;
        if (force_[0] == nullptr) continue;
        for (std::size_t c = 0; c < 3; ++c) {
          const std::size_t p = (c + 1) % 3, q = (c + 2) % 3;
          const std::complex<double> u = k2 > 0 ? std::complex<double>(0, 1) * (k[p] * b[q] - k[q] * b[p]) : b[c];
          sum.work += weight * (std::conj(u) * std::complex<double>(force_[c][at])).real();
        }
      }
  });
  EnergyBudget budget;
  for (const Sums& sum : sums) {
    budget.energy += sum.energy;
    budget.dissipation += sum.dissipation;
    budget.injection += sum.forced;
    budget.work += sum.work;
  }
  if (forcing_.kind == ForcingKind::none) budget.injection = 0;
  return budget;
}

// Energy and dissipation that the last update found; the mean velocity is not among its wavenumbers.
template <class T>
EnergyBudget Flow<T>::tallied(const Modes<T>& potential) const {
  EnergyBudget budget;
  for (const Tally& tally : tallies_)
    for (std::size_t l = 0; l < tally.square.size(); ++l) {
      budget.energy += tally.square[l] / 2;
      budget.dissipation += viscosity_ * tally.enstrophy[l];
    }
  for (const auto& field : potential) budget.energy += std::norm(std::complex<double>(field[0])) / 2;
  return budget;
}

// At the end of the step, with the force of particles that the step had: see Flow::budget.
template <class T>
EnergyBudget Flow<T>::fresh_budget() const {
  if (force_[0] != nullptr) return measure_budget();
  EnergyBudget fresh = tallied(potential_);
  if (forcing_.kind == ForcingKind::shell)
    fresh.injection = forcing_coefficient(potential_) > 0 ? forcing_.injection : 0;
  if (forcing_.kind == ForcingKind::linear) {
    double mean = 0;
    for (const auto& field : potential_) mean += std::norm(std::complex<double>(field[0])) / 2;
    fresh.injection = 2 * forcing_.rate * (fresh.energy - mean);
  }
  return fresh;
}

template <class T>
void Flow<T>::measure_balance() {
  const EnergyBudget fresh = fresh_budget();
  const auto gain = [](const EnergyBudget& b) { return b.injection + b.work - b.dissipation; };
  integrated_gain_ += step_.dt / 2 * (gain(budget_) + gain(fresh));
  integrated_dissipation_ += step_.dt / 2 * (budget_.dissipation + fresh.dissipation);
  budget_ = fresh;
}

// Modes (kx, ky, 0) and (-kx, -ky, 0) are both stored. What keeps them from being each other's conjugates is in no
// velocity, so that nothing but viscosity acts on it; a force in proportion to the modes makes its rounding grow at the
// rate of the energy that it puts in, until after some hundred units of time it holds all of the energy.
template <class T>
void Flow<T>::join_conjugates() {
  const auto [nx, ny, nz] = layout_.points;
  const auto& k = layout_.wavenumber;
  parallel_blocks(nx / 2 + 1, 1, [&, nx = nx, ny = ny](std::size_t, std::size_t ix, std::size_t) {
    const std::size_t other_x = (nx - ix) % nx;
    for (std::size_t iy = 0; iy < ny; ++iy) {
      const std::size_t other_y = (ny - iy) % ny;
      if (!joins(k[0][ix] * k[0][ix] + k[1][iy] * k[1][iy]) || (ix == other_x && iy > other_y)) continue;
      for (auto& field : potential_) {
        Complex& one = field[ix * layout_.plane + iy * layout_.row];
        Complex& other = field[other_x * layout_.plane + other_y * layout_.row];
        const Complex mean = (one + std::conj(other)) / T(2);
        one = mean;
        other = std::conj(mean);
      }
    }
  });
}

template <class T>
double Flow<T>::shell_bytes() const {
  const auto& k = layout_.wavenumber;
  std::size_t modes = 0;
  for (const double x : k[0])
    for (const double y : k[1])
      for (std::size_t iz = 0; iz < layout_.modes_z; ++iz) {
        const double k2 = x * x + y * y + k[2][iz] * k[2][iz];
        if (k2 >= shell_high_) break;
        modes += k2 >= shell_low_;
      }
  return static_cast<double>(3 * modes * sizeof(Complex));
}

template <class T>
double Flow<T>::joined_bytes() const {
  std::size_t modes = 0;
  for (const double x : layout_.wavenumber[0])
    for (const double y : layout_.wavenumber[1]) modes += joins(x * x + y * y);
  return static_cast<double>(3 * modes * sizeof(Complex));
}

template double Flow<double>::shell_bytes() const;
template double Flow<float>::shell_bytes() const;
template double Flow<double>::joined_bytes() const;
template double Flow<float>::joined_bytes() const;
template void Flow<double>::set_forcing_coefficient();
template void Flow<float>::set_forcing_coefficient();
template double Flow<double>::forcing_coefficient(const Modes<double>&) const;
template double Flow<float>::forcing_coefficient(const Modes<float>&) const;
template double Flow<double>::forced_energy() const;
template double Flow<float>::forced_energy() const;
template EnergyBudget Flow<double>::measure_budget() const;
template EnergyBudget Flow<float>::measure_budget() const;
template EnergyBudget Flow<double>::tallied(const Modes<double>&) const;
template EnergyBudget Flow<float>::tallied(const Modes<float>&) const;
template void Flow<double>::measure_balance();
template void Flow<float>::measure_balance();
template void Flow<double>::join_conjugates();
template void Flow<float>::join_conjugates();

}  // namespace spume::spectral
