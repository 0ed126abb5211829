// SPDX-License-Identifier: MIT
#include "spume/methods/spectral/flow.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "flow_evaluate.hpp"
#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/scene/refusal.hpp"

namespace spume::spectral {
namespace {

// Of the velocity by the force in a step: 0.1 costs the multistep scheme an error of 0.4 % in that growth.
constexpr double most_growth = 0.1;

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

// Logarithm of the factor by which AB2 amplifies an oscillation in a step, phase = omega dt: that of the larger root of
// rho^2 - (1 + 3/2 i phase) rho + i phase/2 = 0; phase^4 / 4 for small phases.
double ab2_growth(double phase) {
  const std::complex<double> sum(1, 1.5 * phase);
  const std::complex<double> root = std::sqrt(sum * sum - std::complex<double>(0, 2 * phase));
  return std::log(std::max(std::abs(sum + root), std::abs(sum - root)) / 2);
}

// Advection by |u| <= U gives a mode of frequency omega, normalised, |omega| = |u . grad mode| <= U |grad mode|:
// viscosity damps it by nu (omega / U)^2 dt at least. That must outweigh ab2_growth for every frequency up to the
// largest of the modes kept, Omega; growth / phase^2 rises up to a phase of 1.08 and falls from there. Returns the
// largest Omega dt for damping = nu Omega / U^2.
double stable_ab2_phase(double damping) {
  constexpr double turning = 1.08;
  const double worst = ab2_growth(turning);
  if (damping * turning >= worst) return damping * turning * turning / worst;
  // Below phases of 0.01 rounding begins to show in the root, and phase^4 / 4 is 2e-4 short at most.
  double low = 0, high = std::min(turning, std::cbrt(4 * damping));  // growth >= phase^4 / 4 up to there
  if (high < 0.01) return high * (1 - 1e-4);
  for (int halving = 0; halving < 50; ++halving) {
    const double middle = (low + high) / 2;
    (ab2_growth(middle) <= damping * middle ? low : high) = middle;
  }
  return low;
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
    kept_support_radius_ =
        std::max(kept_support_radius_, last * layout_.lengths[axis] / static_cast<double>(layout_.points[axis]));
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
  for (auto* set : {&potential_, &tendency_, &earlier_})
    for (auto& field : *set) field.resize(layout_.size());
  if (options_.integrator != Integrator::ab2)
    for (auto& field : start_) field.resize(layout_.size());
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
  tendency_ready_ = has_history_ = has_previous_ = false;
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
const Modes<T>* Flow<T>::previous() const {
  if (!has_previous_) return nullptr;
  return options_.integrator == Integrator::ab2 ? &tendency_ : &start_;
}

template <class T>
void Flow<T>::evaluate_tendency() {
  if (tendency_ready_) return;
  peak_ = evaluate(potential_, tendency_,
                   [&](std::size_t, std::size_t, std::size_t at, std::size_t, const auto&, const auto k[3]) {
                     for (std::size_t c = 0; c < 3; ++c) fourier::store<T>(&tendency_[c][at], k[c]);
                   });
  tendency_ready_ = options_.integrator == Integrator::ab2;
  if (options_.integrator == Integrator::ab2) has_previous_ = false;
}

// Modes (kx, ky, 0) and (-kx, -ky, 0) are both stored. What keeps them from being each other's conjugates is in no
// velocity, so that nothing but viscosity acts on it; a force in proportion to the modes makes its rounding grow at the
// rate of the energy that it puts in, until after some hundred units of time it holds all of the energy.
template <class T>
void Flow<T>::join_conjugates() {
  if (forcing_.kind == ForcingKind::none) return;
  const auto [nx, ny, nz] = layout_.points;
  const auto& k = layout_.wavenumber;
  const auto forced = [&](double k2) { return forcing_.kind == ForcingKind::linear || k2 < shell_high_; };
  parallel_blocks(nx / 2 + 1, 1, [&, nx = nx, ny = ny](std::size_t, std::size_t ix, std::size_t) {
    const std::size_t other_x = (nx - ix) % nx;
    for (std::size_t iy = 0; iy < ny; ++iy) {
      const std::size_t other_y = (ny - iy) % ny;
      if (!forced(k[0][ix] * k[0][ix] + k[1][iy] * k[1][iy]) || (ix == other_x && iy > other_y)) continue;
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

template <class T>
void Flow<T>::total_pressure(Array<Complex>& modes) {
  modes.resize(layout_.size());
  // K alone does not hold the divergence of the product, so the product is formed again, into storage that is free
  // between the steps.
  Modes<T>& sum = tendency_;
  tendency_ready_ = false;
  if (options_.integrator == Integrator::ab2) has_previous_ = false;
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
StepLimit Flow<T>::limit_for(const VelocityPeak& peak) const {
  StepLimit limit{std::numeric_limits<double>::max(), "nothing"};
  const auto bound = [&](double dt, const char* name) {
    if (dt < limit.dt) limit = {dt, name};
  };
  if (limits_.max_step > 0) bound(limits_.max_step, "max_step");
  if (peak.rate > 0) {
    bound(limits_.courant / peak.rate, "courant");
    // Largest frequency of advection: sum |u_i| k_max,i = pi rate.
    const double frequency = std::numbers::pi * peak.rate;
    switch (options_.integrator) {
      case Integrator::ab2: {
        const double kept = kept_support_radius_ * peak.rate;
        bound(stable_ab2_phase(viscosity_ * kept / (peak.speed * peak.speed)) / kept, "ab2 stability");
        break;
      }
      case Integrator::rk3:
        bound(1.73 / frequency, "rk3 stability");  // its reach along the imaginary axis
        break;
      case Integrator::rk4:
        bound(3.34 / frequency, "rk4 stability");
        break;
    }
  } else if (limits_.max_step == 0) {
    // Nothing moves yet: the first steps follow the time scale of the run.
    bound(limits_.end / 1000, "end of run");
  }
  return limit;
}

template <class T>
StepLimit Flow<T>::step_limit() const {
  const StepLimit limit = limit_for(peak_);
  const double growth = forcing_coefficient(potential_);
  return growth * limit.dt > most_growth ? StepLimit{most_growth / growth, "forcing"} : limit;
}

template <class T>
double Flow<T>::forced_energy() const {
  const double growth = forcing_coefficient(potential_);
  return forcing_.kind == ForcingKind::shell && growth > 0 ? forcing_.injection / (2 * growth) : 0;
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

template <class T>
void Flow<T>::save(StateWriter& writer) const {
  const double scalars[] = {
      time_,          earlier_dt_,         peak_.speed,       peak_.rate,  integrated_gain_, integrated_dissipation_,
      budget_.energy, budget_.dissipation, budget_.injection, budget_.work};
  const std::int64_t counters[] = {steps_, has_history_ ? 1 : 0, static_cast<std::int64_t>(layout_.points[0]),
                                   static_cast<std::int64_t>(layout_.points[1]),
                                   static_cast<std::int64_t>(layout_.points[2])};
  writer.f64("scalars", scalars);
  writer.i64("counters", counters);
  writer.f64("lengths", layout_.lengths);
  const char* const axes[3] = {"x", "y", "z"};
  const auto put = [&](const std::string& name, const Modes<T>& set) {
    // Without the padding of rows and planes: the file does not depend on the precision or the vector width.
    Array<double> values(2 * layout_.points[0] * layout_.points[1] * layout_.modes_z);
    for (std::size_t c = 0; c < 3; ++c) {
      parallel_for(layout_.points[0] * layout_.points[1], [&](std::size_t line) {
        const Complex* from =
            &set[c][line / layout_.points[1] * layout_.plane + line % layout_.points[1] * layout_.row];
        double* to = &values[2 * line * layout_.modes_z];
        for (std::size_t iz = 0; iz < layout_.modes_z; ++iz) {
          to[2 * iz] = static_cast<double>(from[iz].real());
          to[2 * iz + 1] = static_cast<double>(from[iz].imag());
        }
      });
      writer.f64(name + "_" + axes[c], values);
    }
  };
  put("potential", potential_);
  if (has_history_) put("tendency", earlier_);
}

template <class T>
void Flow<T>::load(StateReader& reader) {
  Array<double> scalars, lengths;
  Array<std::int64_t> counters;
  reader.f64("scalars", scalars);
  reader.i64("counters", counters);
  reader.f64("lengths", lengths);
  const bool fits = scalars.size() == 10 && counters.size() == 5 && lengths.size() == 3 &&
                    counters[2] == static_cast<std::int64_t>(layout_.points[0]) &&
                    counters[3] == static_cast<std::int64_t>(layout_.points[1]) &&
                    counters[4] == static_cast<std::int64_t>(layout_.points[2]);
  if (!fits) throw FileError("the checkpoint was written on another grid or by another version of the method");
  const char* const axes[3] = {"x", "y", "z"};
  const auto get = [&](const std::string& name, Modes<T>& set) {
    Array<double> values;
    for (std::size_t c = 0; c < 3; ++c) {
      reader.f64(name + "_" + axes[c], values);
      if (values.size() != 2 * layout_.points[0] * layout_.points[1] * layout_.modes_z)
        throw FileError("the checkpoint's array '" + name + "' does not have one value per mode");
      parallel_for(layout_.points[0] * layout_.points[1], [&](std::size_t line) {
        Complex* to = &set[c][line / layout_.points[1] * layout_.plane + line % layout_.points[1] * layout_.row];
        const double* from = &values[2 * line * layout_.modes_z];
        for (std::size_t iz = 0; iz < layout_.modes_z; ++iz)
          to[iz] = {static_cast<T>(from[2 * iz]), static_cast<T>(from[2 * iz + 1])};
      });
    }
  };
  get("potential", potential_);
  has_history_ = counters[1] != 0;
  if (has_history_) get("tendency", earlier_);
  time_ = scalars[0];
  earlier_dt_ = scalars[1];
  peak_ = {scalars[2], scalars[3]};
  integrated_gain_ = scalars[4];
  integrated_dissipation_ = scalars[5];
  budget_ = {scalars[6], scalars[7], scalars[8], scalars[9]};
  steps_ = counters[0];
  tendency_ready_ = has_previous_ = false;
}

template class Flow<double>;
template class Flow<float>;

}  // namespace spume::spectral
