// SPDX-License-Identifier: MIT
#include "spume/methods/spectral/suspension.hpp"

#include <cstdio>

#include "spume/core/error.hpp"
#include "spume/methods/spectral/particle_options.hpp"
#include "spume/scene/refusal.hpp"

namespace spume::spectral {
namespace {

ParticleSystem system_for(const LoadedCase& loaded) {
  const PointParticleOptions options = particle_options(loaded);
  try {
    return {flow_grid(loaded), options};
  } catch (const InputError& error) {
    throw refusal(loaded.options, "particles", error);
  }
}

}  // namespace

template <class T>
Suspension<T>::Suspension(const LoadedCase& loaded, Flow<T>& flow)
    : loaded_(loaded), flow_(flow), grid_(flow_grid(loaded)), system_(system_for(loaded)) {
  const auto& layout = flow.layout();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t modes = axis == 2 ? layout.modes_z : layout.points[axis];
    for (std::size_t k = 0; k < modes; ++k)
      prefilter_[axis].push_back(
          static_cast<T>(b_spline_prefilter(system_.options().spline_order, static_cast<int>(k), grid_.points[axis])));
  }
  for (auto& field : field_) field.resize(grid_.storage());
  follows_exponents_ = loaded.options.get<ParticleCaseOptions>().lyapunov > 0;
  make_columns();
}

template <class T>
std::array<T*, 3> Suspension<T>::values_on_points() {
  return {field_[0].data(), field_[1].data(), field_[2].data()};
}

template <class T>
void Suspension<T>::spread_force(StageRun& run) {
  system_.template spread_force<T>(values_on_points(), run.dt);
}

template <class T>
void Suspension<T>::force_to_modes() {
  force_modes(flow_, {field_[0].data(), field_[1].data(), field_[2].data()}, grid_.z_stride, force_);
  if (!loaded_.options.get<ParticleCaseOptions>().mean_force_moves_fluid)
    for (auto& component : force_) component[0] = 0;
  flow_.set_force(view<T>(force_));
}

template <class T>
void Suspension<T>::velocity_to_points() {
  real_velocity(flow_, flow_.potential(), prefilter_, values_on_points(), grid_.z_stride);
}

template <class T>
void Suspension<T>::fill_records() {
  system_.template take_velocity<T>({field_[0].data(), field_[1].data(), field_[2].data()});
}

// Random places at volume fractions up to 45 % have no overlap left after fewer.
template <class T>
void Suspension<T>::separate_particles() {
  constexpr int sweeps = 300;
  system_.separate(sweeps);
}

template <class T>
void Suspension<T>::start_particles() {
  system_.start();
  if (follows_exponents_)
    tracker_ = LyapunovTracker(
        *system_.double_field(), static_cast<std::size_t>(loaded_.options.get<ParticleCaseOptions>().lyapunov),
        system_.options().motion.response_time, system_.particles().common_diameter, loaded_.scene.seed + 1);
}

template <class T>
void Suspension<T>::follow_exponents(StageRun& run) {
  run.particles = static_cast<double>(tracker_.size());
  tracker_.advance(system_.options().motion, *system_.double_field(), run.dt);
}

template <class T>
StepLimit Suspension<T>::limited(const StepLimit& flow) const {
  const double longest = system_.longest_step();
  return longest < flow.dt ? StepLimit{longest, "particle coupling"} : flow;
}

template <class T>
void Suspension<T>::require_possible(const StepLimit& flow) const {
  const double longest = system_.longest_step();
  constexpr double most_slowdown = 1000;  // no case is worth so many steps
  if (longest * most_slowdown > flow.dt) return;
  const MotionModel& motion = system_.options().motion;
  char text[400];
  std::snprintf(
      text, sizeof text,
      "particles.response_time = %.3g with a mass loading of %.3g (volume fraction %.3g, density ratio %.3g): "
      "the coupling with the flow is stable for steps up to %.3g, while the flow takes steps of %.3g; the ratio must "
      "be "
      "at least 1/%.0f; raise the response time, lower the volume fraction, or take "
      "particles.coupling = \"one-way\"",
      motion.response_time, system_.volume_fraction() * motion.density_ratio(), system_.volume_fraction(),
      motion.density_ratio(), longest, flow.dt, most_slowdown);
  throw refusal(loaded_.options,
                loaded_.options.get<ParticleCaseOptions>().stokes > 0 ? "particles.stokes" : "particles.response_time",
                text);
}

template <class T>
void Suspension<T>::add_arrays(std::vector<ArrayInfo>& list) const {
  for (const auto& array : system_.arrays())
    list.push_back({array.name, array.bytes, array.per_particle ? system_.size() : 0});
  double fields = 0;
  for (const auto& field : field_) fields += static_cast<double>(field.capacity() * sizeof(T));
  for (const auto& modes : force_) fields += static_cast<double>(modes.capacity() * sizeof(std::complex<T>));
  const ArrayInfo between{"fields between flow and particles", fields};
  list.push_back(between);
}

// Every array that a run goes on from.
template <class T>
std::vector<ParticleSystem::StateArray> Suspension<T>::state() const {
  std::vector<ParticleSystem::StateArray> out = system_.state();
  if (!follows_exponents_) return out;
  for (const auto& field : tracker_.particles().fields.fields())
    if (auto* f64 = std::get_if<Array<double>>(&field->values))
      out.push_back({"lyapunov_" + field->name, f64, nullptr});
  out.push_back({"lyapunov_growth", &tracker_.growth(), nullptr});
  return out;
}

template <class T>
typename Suspension<T>::StateCopy Suspension<T>::copy_state() const {
  StateCopy copy;
  for (const auto& array : state()) {
    if (array.f64 != nullptr) copy.f64.push_back(*array.f64);
    if (array.i64 != nullptr) copy.i64.push_back(*array.i64);
  }
  return copy;
}

// Of all arrays but the forces of the first step; the sort at the start and that of the first step give one order.
template <class T>
void Suspension<T>::take_back_first_step(const StateCopy& start) {
  auto f64 = start.f64.begin();
  auto i64 = start.i64.begin();
  for (const auto& array : state()) {
    if (array.i64 != nullptr) *array.i64 = *i64++;
    if (array.f64 == nullptr) continue;
    if (array.name != "particle_amounts") *array.f64 = *f64;
    ++f64;
  }
  velocity_to_points();
  fill_records();
  has_first_force_ = true;
}

template <class T>
void Suspension<T>::save(StateWriter& writer) const {
  for (const auto& array : state())
    if (array.f64 != nullptr)
      writer.f64(array.name, *array.f64);
    else
      writer.i64(array.name, *array.i64);
}

template <class T>
void Suspension<T>::load(StateReader& reader) {
  velocity_to_points();
  fill_records();
  start_particles();
  const auto read = [&](const std::string& name, auto& values, auto&& take) {
    const std::size_t wanted = values.size();
    take(name, values);
    if (values.size() != wanted)
      throw FileError("the checkpoint holds " + std::to_string(values.size()) + " values of " + name +
                      "; the case needs " + std::to_string(wanted));
  };
  for (const auto& array : state())
    if (array.f64 != nullptr)
      read(array.name, *array.f64, [&](const std::string& name, auto& values) { reader.f64(name, values); });
    else
      read(array.name, *array.i64, [&](const std::string& name, auto& values) { reader.i64(name, values); });
}

template class Suspension<double>;
template class Suspension<float>;

}  // namespace spume::spectral
