// SPDX-License-Identifier: MIT
#include "spume/methods/spectral/flow.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/scene/refusal.hpp"

namespace spume::spectral {
namespace {

std::array<double, 3> box_lengths(const Domain& domain) {
  return {domain.upper[0] - domain.lower[0], domain.upper[1] - domain.lower[1], domain.upper[2] - domain.lower[2]};
}

std::string gigabytes(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g GB", bytes / 1e9);
  return text;
}

const LoadedCase& require_memory(const LoadedCase& loaded) {
  const double needed = flow_bytes(loaded.scene.grid, loaded.options.get<SpectralOptions>());
  const double machine = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  if (needed > machine)
    throw refusal(loaded.options, "resolution.grid",
                  "the flow needs " + gigabytes(needed) + " and this machine has " + gigabytes(machine) +
                      "; lower resolution.grid or set spectral.precision = \"single\"");
  return loaded;
}

Planning planning_of(const SpectralOptions& options) {
  return options.plans == PlanEffort::measured ? Planning::measure : Planning::estimate;
}

template <class T>
double mode_bytes(const std::array<std::size_t, 3>& grid) {
  return sizeof(std::complex<T>) * static_cast<double>(make_mode_layout<T>(grid, {1, 1, 1}).size());
}

// Of CrossProduct: five fields of half the planes, in rows a block longer, and of every thread half a plane of six
// fields and a plane of three.
template <class T>
double product_bytes(const std::array<std::size_t, 3>& grid) {
  const std::size_t plane = grid[1] * (make_mode_layout<T>(grid, {1, 1, 1}).row + lanes<T>);
  return sizeof(std::complex<T>) * static_cast<double>(plane) *
         (2.5 * static_cast<double>(grid[0]) + 6.0 * thread_count());
}

}  // namespace

double mode_bytes(const std::array<std::size_t, 3>& grid, FieldPrecision precision) {
  return precision == FieldPrecision::f64 ? mode_bytes<double>(grid) : mode_bytes<float>(grid);
}

double flow_bytes(const std::array<std::size_t, 3>& grid, const SpectralOptions& options) {
  const double fields = options.integrator == Integrator::ab2 ? 9 : 12;
  const double product =
      options.precision == FieldPrecision::f64 ? product_bytes<double>(grid) : product_bytes<float>(grid);
  // One component in double precision passes on its way to and from a checkpoint.
  const double passing = 8 * static_cast<double>(grid[0]) * static_cast<double>(grid[1]) * static_cast<double>(grid[2]);
  return fields * mode_bytes(grid, options.precision) + product + passing;
}

template <class T>
Flow<T>::Flow(const LoadedCase& loaded)
    : layout_(make_mode_layout<T>(require_memory(loaded).scene.grid, box_lengths(loaded.scene.domain))),
      options_(loaded.options.get<SpectralOptions>()),
      forcing_(loaded.options.get<ForcingOptions>()),
      limits_(loaded.options.time),
      viscosity_(loaded.scene.fluid.kinematic_viscosity),
      product_(layout_, options_.dealiasing == Dealiasing::padded, planning_of(options_)),
      box_(layout_, planning_of(options_), product_.spare()),
      tallies_(layout_.points[1]) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double k : layout_.wavenumber[axis]) wavenumber_[axis].push_back(static_cast<T>(k));
    const bool all = options_.dealiasing != Dealiasing::two_thirds;
    // Half a mode's slack, so that rounding does not decide about the mode at N/3.
    cut_[axis] = all ? std::numeric_limits<double>::max()
                     : layout_.unit(axis) * (std::ceil(static_cast<double>(layout_.points[axis]) / 3) - 0.5);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double last = std::min(layout_.largest_wavenumber(axis), cut_[axis] - layout_.unit(axis) / 2);
    kept_grid_wavenumber_ =
        std::max(kept_grid_wavenumber_, last * layout_.lengths[axis] / static_cast<double>(layout_.points[axis]));
  }
  lane_wavenumber_.resize(layout_.row);
  lane_weight_.resize(layout_.row);
  for (std::size_t iz = 0; iz < layout_.row; ++iz) {
    lane_wavenumber_[iz] = {wavenumber_[2][iz], wavenumber_[2][iz]};
    const T weight = static_cast<T>(ModeLayout::weight(iz));
    lane_weight_[iz] = {weight, weight};
  }
  const double unit = 2 * std::numbers::pi / *std::max_element(layout_.lengths.begin(), layout_.lengths.end());
  shell_low_ = std::pow(forcing_.wavenumber * unit, 2);
  shell_high_ = std::pow((forcing_.wavenumber + forcing_.width) * unit, 2);
  if (forcing_.kind == ForcingKind::shell)
    for (std::size_t ix = 0; ix < layout_.points[0]; ++ix)
      for (std::size_t iy = 0; iy < layout_.points[1]; ++iy)
        for (std::size_t iz = 0; iz < layout_.modes_z && keeps(ix, iy, iz); ++iz) {
          const double k2 = std::pow(layout_.wavenumber[0][ix], 2) + std::pow(layout_.wavenumber[1][iy], 2) +
                            std::pow(layout_.wavenumber[2][iz], 2);
          if (k2 >= shell_high_) break;
          if (k2 >= shell_low_) forced_decay_ = std::max(forced_decay_, viscosity_ * k2);
        }
  for (auto* set : {&potential_, &tendency_, &earlier_})
    for (auto& field : *set) field.resize(layout_.size());
  if (options_.integrator != Integrator::ab2)
    for (auto& field : start_) field.resize(layout_.size());
  for (auto* decay : {&decay_, &earlier_decay_}) set_decay(*decay, 0);  // what they stay without viscosity
  if (forcing_.kind == ForcingKind::linear) forcing_coefficient_ = forcing_.rate;
}

template <class T>
Modes<T> Flow<T>::take_potential() {
  Modes<T> potential;
  potential.swap(potential_);
  for (auto& field : potential) {
    field.resize(layout_.size());
    parallel_for(field.size(), [&](std::size_t i) { field[i] = 0; });
  }
  return potential;
}

template <class T>
void Flow<T>::set_potential(Modes<T>&& potential) {
  potential_ = std::move(potential);
  const auto [nx, ny, nz] = layout_.points;
  if (options_.dealiasing == Dealiasing::two_thirds)
    parallel_for(nx, [&, ny = ny](std::size_t ix) {
      for (std::size_t iy = 0; iy < ny; ++iy)
        for (std::size_t iz = 0; iz < layout_.modes_z; ++iz)
          if (!keeps(ix, iy, iz))
            for (auto& field : potential_) field[ix * layout_.plane + iy * layout_.row + iz] = 0;
    });
  has_history_ = false;
  budget_ = measure_budget();
}

template <class T>
bool Flow<T>::keeps(std::size_t ix, std::size_t iy, std::size_t iz) const {
  return std::abs(layout_.wavenumber[0][ix]) < cut_[0] && std::abs(layout_.wavenumber[1][iy]) < cut_[1] &&
         layout_.wavenumber[2][iz] < cut_[2];
}

template <class T>
double Flow<T>::largest_wavenumber() const {
  double least = std::numeric_limits<double>::max();
  for (std::size_t axis = 0; axis < 3; ++axis)
    least =
        std::min({least, layout_.largest_wavenumber(axis) + layout_.unit(axis), cut_[axis] + layout_.unit(axis) / 2});
  return least;
}

template <class T>
void Flow<T>::total_pressure(Array<Complex>& modes) {
  modes.resize(layout_.size());
  // K alone does not hold the divergence of the product, so the product is formed again, into storage that is free
  // between the steps.
  Modes<T>& sum = tendency_;
  const auto finish = [&](std::size_t ix, std::size_t iy, std::size_t first, const Complex* const product[3]) {
    const double kx = layout_.wavenumber[0][ix], ky = layout_.wavenumber[1][iy];
    for (std::size_t l = 0; l < lanes<T>; ++l) {
      const double kz = layout_.wavenumber[2][first + l], k2 = kx * kx + ky * ky + kz * kz;
      const std::size_t at = ix * layout_.plane + iy * layout_.row + first + l;
      std::complex<double> n[3];
      for (std::size_t c = 0; c < 3; ++c) {
        n[c] = std::complex<double>(product[c][l]);
        if (force_[0] != nullptr) n[c] += std::complex<double>(force_[c][at]);
      }
      const std::complex<double> along = kx * n[0] + ky * n[1] + kz * n[2];
      modes[at] = k2 > 0 ? static_cast<Complex>(std::complex<double>(0, -1) * along / k2) : Complex{};
    }
  };
  product_.evaluate(view<T>(potential_), {sum[0].data(), sum[1].data(), sum[2].data()}, finish);
}

template <class T>
std::vector<ArrayInfo> Flow<T>::arrays() const {
  const auto bytes = [](const Modes<T>& set) {
    double sum = 0;
    for (const auto& field : set) sum += static_cast<double>(field.capacity() * sizeof(Complex));
    return sum;
  };
  std::vector<ArrayInfo> list{{"vector potential", bytes(potential_)}, {"tendency", bytes(tendency_)}};
  if (options_.integrator == Integrator::ab2) {
    list.push_back({"earlier tendency", bytes(earlier_)});
  } else {
    list.push_back({"Runge-Kutta register", bytes(earlier_)});
    list.push_back({"start of the step", bytes(start_)});
  }
  list.push_back({"planes of the product", product_.bytes()});
  return list;
}

template class Flow<double>;
template class Flow<float>;

}  // namespace spume::spectral
