// SPDX-License-Identifier: MIT
// What a run of the spectral method reports: series, snapshots, probes, spectra and distributions.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "spume/core/parallel.hpp"
#include "spume/methods/spectral/flow_fields.hpp"
#include "spume/methods/spectral/flow_statistics.hpp"
#include "spume/methods/spectral/spectral.hpp"

namespace spume::spectral {
namespace {

// What a row of the series is read from.
struct Row {
  EnergyBudget budget;
  Scales scales;
  GradientMoments gradient;
  double mass = 0, balance_residual = 0, max_speed = 0;
};

struct Column {
  const char *name, *unit;
  double (*read)(const Row&);
};

// What energy changed by beside gain = put in - dissipated, relative to the larger of the energy put in and dissipated.
// Where next to nothing is exchanged, as in a uniform stream, rounding of the energy is all that is left of both: it is
// compared with the root of a rounding of it.
double balance_residual(double energy, double change, double gain, double dissipated) {
  const double least = std::sqrt(std::numeric_limits<double>::epsilon()) * energy;
  const double exchanged = std::max({dissipated, std::abs(gain + dissipated), least});
  return exchanged > 0 ? (change - gain) / exchanged : 0;
}

constexpr Column columns[] = {
    {"kinetic_energy", "rho u^2 / 2, integral", [](const Row& r) { return r.mass * r.budget.energy; }},
    {"dissipation", "rho nu |S|^2, integral", [](const Row& r) { return r.mass * r.budget.dissipation; }},
    {"mean_energy", "u^2 / 2, mean", [](const Row& r) { return r.budget.energy; }},
    {"mean_dissipation", "mean", [](const Row& r) { return r.budget.dissipation; }},
    {"mean_injection", "by the force, mean", [](const Row& r) { return r.budget.injection; }},
    {"mean_enstrophy", "omega^2 / 2, mean", [](const Row& r) { return r.scales.enstrophy; }},
    {"balance_residual", "of dE/dt since the last row, relative to the energy exchanged",
     [](const Row& r) { return r.balance_residual; }},
    {"max_speed", "speed, on the grid", [](const Row& r) { return r.max_speed; }},
    {"rms_velocity", "u', speed", [](const Row& r) { return r.scales.rms_velocity; }},
    {"integral_scale", "length", [](const Row& r) { return r.scales.integral_scale; }},
    {"taylor_scale", "length", [](const Row& r) { return r.scales.taylor_scale; }},
    {"kolmogorov_scale", "length", [](const Row& r) { return r.scales.kolmogorov_scale; }},
    {"reynolds_lambda", "1", [](const Row& r) { return r.scales.reynolds_lambda; }},
    {"kmax_eta", "1", [](const Row& r) { return r.scales.kmax_eta; }},
    {"gradient_skewness", "of du/dx", [](const Row& r) { return r.gradient.skewness; }},
    {"gradient_flatness", "of du/dx", [](const Row& r) { return r.gradient.flatness; }}};

}  // namespace

template <class T>
std::vector<SeriesColumn> Spectral<T>::series_columns() const {
  std::vector<SeriesColumn> list;
  for (const Column& column : columns) list.push_back({column.name, column.unit});
  if (suspension_) suspension_->add_columns(list);
  return list;
}

template <class T>
void Spectral<T>::series_values(std::span<double> values) {
  ensure_started();
  const auto& lengths = flow_.layout().lengths;
  const double lost = flow_.integrated_dissipation() - row_[2];
  Row row{.budget = flow_.budget(),
          .scales = flow_scales(flow_, shell_spectrum(flow_)),
          .gradient = gradient_moments(flow_),
          .mass = loaded_.scene.fluid.density * lengths[0] * lengths[1] * lengths[2],
          .max_speed = largest_speed(flow_)};
  if (row_[3] > 0)
    row.balance_residual =
        balance_residual(row.budget.energy, row.budget.energy - row_[0], flow_.integrated_gain() - row_[1], lost);
  row_ = {row.budget.energy, flow_.integrated_gain(), flow_.integrated_dissipation(), 1};
  auto value = values.begin();
  for (const Column& column : columns) *value++ = column.read(row);
  if (suspension_) suspension_->values(std::span<double>(value, values.end()));
  if (row.scales.kmax_eta < 1 && !warned_) {
    warned_ = true;
    char text[200];
    std::snprintf(text, sizeof text,
                  "the smallest scales are not resolved: k_max eta = %.2f at t = %.4g, which should be 1.5 or more; "
                  "raise resolution.grid or the viscosity",
                  row.scales.kmax_eta, flow_.time());
    remarks_.push_back({text});
  }
}

template <class T>
std::span<const typename Spectral<T>::OutputField> Spectral<T>::output_fields() {
  static constexpr OutputField fields[] = {{"velocity", 3, true, &Spectral::compute_velocity},
                                           {"vorticity", 3, false, &Spectral::compute_vorticity},
                                           {"pressure", 1, false, &Spectral::compute_pressure}};
  return fields;
}

template <class T>
bool Spectral<T>::wants(const OutputField& field) const {
  const auto& fields = loaded_.options.output.fields;
  return fields.empty() ? field.standard : std::find(fields.begin(), fields.end(), field.name) != fields.end();
}

template <class T>
std::vector<ParticleSnapshot> Spectral<T>::snapshot() {
  ensure_started();
  return suspension_ ? std::vector<ParticleSnapshot>{suspension_->snapshot()} : std::vector<ParticleSnapshot>{};
}

template <class T>
std::vector<GridSnapshot> Spectral<T>::grid_snapshot() {
  ensure_started();
  const ModeLayout& layout = flow_.layout();
  GridSnapshot family;
  family.name = "fluid";
  family.points = layout.points;
  family.origin = loaded_.scene.domain.lower;
  for (std::size_t axis = 0; axis < 3; ++axis)
    family.spacing[axis] = layout.lengths[axis] / static_cast<double>(layout.points[axis]);
  drawn_.clear();
  for (const OutputField& field : output_fields()) {
    if (!wants(field)) continue;
    GridSnapshot::Field entry{field.name, {}};
    for (const Array<float>& component : draw(field)) entry.components.push_back(component.data());
    family.fields.push_back(std::move(entry));
  }
  return {family};
}

// Every field as it is written, and the one that is being computed. The pressure is that of the modes less the square
// of the velocity, which is drawn for it.
template <class T>
double Spectral<T>::snapshot_bytes() const {
  const std::span<const OutputField> fields = output_fields();
  const bool pressure = wants(fields[2]);
  std::size_t drawn = 0, computed = 0;
  for (const OutputField& field : fields) {
    const bool needed = wants(field) || (pressure && &field == &fields[0]);
    if (!needed || drawn_.contains(field.name)) continue;
    drawn += field.components * sizeof(float);
    computed = std::max(computed, field.components * sizeof(T));
  }
  const std::size_t modes = pressure && total_pressure_.capacity() == 0 ? flow_.layout().size() : 0;
  return static_cast<double>((drawn + computed) * particle_count() + modes * sizeof(std::complex<T>));
}

template <class T>
const std::vector<Array<float>>& Spectral<T>::draw(const OutputField& field) {
  std::vector<Array<float>>& drawn = drawn_[field.name];
  if (!drawn.empty()) return drawn;
  Array<T> values;
  (this->*field.compute)(values);
  const std::size_t size = particle_count();
  drawn.resize(values.size() / size);
  for (std::size_t c = 0; c < drawn.size(); ++c) {
    drawn[c].resize(size);
    parallel_for(size, [&](std::size_t i) { drawn[c][i] = static_cast<float>(values[c * size + i]); });
  }
  return drawn;
}

// Room for the three components of a vector, one behind the other.
template <class T>
std::array<T*, 3> Spectral<T>::components_of(Array<T>& values) const {
  const std::size_t size = particle_count();
  values.resize(3 * size);
  return {&values[0], &values[size], &values[2 * size]};
}

template <class T>
void Spectral<T>::compute_velocity(Array<T>& values) {
  real_velocity(flow_, flow_.potential(), {}, components_of(values), flow_.layout().points[2]);
}

template <class T>
void Spectral<T>::compute_vorticity(Array<T>& values) {
  real_vorticity(flow_, flow_.potential(), {}, components_of(values), flow_.layout().points[2]);
}

template <class T>
void Spectral<T>::compute_pressure(Array<T>& values) {
  const std::vector<Array<float>>& velocity = draw(output_fields()[0]);
  const ModeLayout& layout = flow_.layout();
  const std::size_t size = particle_count();
  values.resize(size);
  flow_.total_pressure(total_pressure_);
  total_pressure_step_ = flow_.steps();
  flow_.box().inverse(
      [&](std::size_t ix, std::size_t iy, std::size_t first, std::complex<T>* block) {
        std::copy_n(&total_pressure_[ix * layout.plane + iy * layout.row + first], lanes<T>, block);
      },
      values.data(), layout.points[2]);
  const auto square = [&](std::size_t i) {
    double sum = 0;
    for (const auto& u : velocity) sum += double{u[i]} * double{u[i]};
    return sum / 2;
  };
  const double mean = parallel_sum(size, square) / static_cast<double>(size);
  const double density = loaded_.scene.fluid.density;
  parallel_for(size,
               [&](std::size_t i) { values[i] = static_cast<T>(density * (double{values[i]} - square(i) + mean)); });
}

template <class T>
const Array<std::complex<T>>& Spectral<T>::total_pressure() {
  ensure_started();
  if (total_pressure_step_ != flow_.steps()) {
    flow_.total_pressure(total_pressure_);
    total_pressure_step_ = flow_.steps();
  }
  return total_pressure_;
}

template <class T>
PointSample Spectral<T>::sample(const Vec3& position) {
  const auto& pressure = total_pressure();
  Vec3 from_lower{};
  for (std::size_t axis = 0; axis < 3; ++axis) from_lower[axis] = position[axis] - loaded_.scene.domain.lower[axis];
  PointSample sample = sample_flow(flow_, pressure, from_lower);
  double& p = sample.scalars[0];
  p = loaded_.scene.fluid.density * (p + flow_.budget().energy);  // mean pressure 0
  return sample;
}

template <class T>
PlaneSample Spectral<T>::plane_average(int axis, double position) {
  const auto& pressure = total_pressure();
  const auto a = static_cast<std::size_t>(axis);
  PlaneSample sample = sample_plane(flow_, pressure, a, position - loaded_.scene.domain.lower[a]);
  double& p = sample.scalars[0];
  p = loaded_.scene.fluid.density * (p + flow_.budget().energy);
  return sample;
}

template <class T>
std::vector<RecordTable> Spectral<T>::tables() const {
  std::vector<RecordTable> list{spectrum_table(),
                                {"gradient_pdf",
                                 "gradient_pdf",
                                 {{"t", "time"},
                                  {"gradient", "standard deviations"},
                                  {"longitudinal", "probability density"},
                                  {"transverse", "probability density"}},
                                 RecordTable::When::spectrum}};
  if (suspension_) suspension_->add_tables(list);
  return list;
}

template <class T>
void Spectral<T>::table_rows(const std::string& name, std::vector<double>& rows) {
  ensure_started();
  if (name == "spectrum") {
    const ShellSpectrum spectrum = shell_spectrum(flow_);
    add_spectrum(flow_.time(), spectrum.wavenumber, spectrum.energy, rows);
  } else if (name == "gradient_pdf") {
    const GradientDistribution pdf = gradient_distribution(flow_);
    for (std::size_t i = 0; i < pdf.value.size(); ++i)
      rows.insert(rows.end(), {flow_.time(), pdf.value[i], pdf.longitudinal[i], pdf.transverse[i]});
  } else if (suspension_) {
    suspension_->table_rows(name, rows);
  }
}

template std::vector<SeriesColumn> Spectral<double>::series_columns() const;
template std::vector<SeriesColumn> Spectral<float>::series_columns() const;
template void Spectral<double>::series_values(std::span<double>);
template void Spectral<float>::series_values(std::span<double>);
template std::span<const Spectral<double>::OutputField> Spectral<double>::output_fields();
template std::span<const Spectral<float>::OutputField> Spectral<float>::output_fields();
template std::vector<ParticleSnapshot> Spectral<double>::snapshot();
template std::vector<ParticleSnapshot> Spectral<float>::snapshot();
template std::vector<GridSnapshot> Spectral<double>::grid_snapshot();
template std::vector<GridSnapshot> Spectral<float>::grid_snapshot();
template double Spectral<double>::snapshot_bytes() const;
template double Spectral<float>::snapshot_bytes() const;
template PointSample Spectral<double>::sample(const Vec3&);
template PointSample Spectral<float>::sample(const Vec3&);
template PlaneSample Spectral<double>::plane_average(int, double);
template PlaneSample Spectral<float>::plane_average(int, double);
template std::vector<RecordTable> Spectral<double>::tables() const;
template std::vector<RecordTable> Spectral<float>::tables() const;
template void Spectral<double>::table_rows(const std::string&, std::vector<double>&);
template void Spectral<float>::table_rows(const std::string&, std::vector<double>&);

}  // namespace spume::spectral
