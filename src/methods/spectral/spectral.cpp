// SPDX-License-Identifier: MIT
#include "spume/methods/spectral/spectral.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/methods/spectral/flow_fields.hpp"
#include "spume/methods/spectral/flow_statistics.hpp"
#include "spume/methods/spectral/initial_state.hpp"
#include "spume/scene/refusal.hpp"

namespace spume::spectral {

template <class T>
void Spectral<T>::step(double dt, Ledger& ledger) {
  ensure_started();
  if (suspension_) suspension_->before_step(ledger);
  const auto points = static_cast<double>(particle_count());
  const auto before = flow_.stage_seconds();
  const double begin = omp_get_wtime();
  flow_.advance(dt);
  const double seconds = omp_get_wtime() - begin;
  const auto& after = flow_.stage_seconds();
  const char* const names[3] = {"x stage", "planes of the product", "x stage back, update"};
  double counted = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    ledger.count(names[i], 1, after[i] - before[i], points, 0);
    counted += after[i] - before[i];
  }
  ledger.count("rest of the step", 1, seconds - counted, points, 0);
  if (suspension_) suspension_->after_step(dt, ledger);
}

template <class T>
Spectral<T>::Spectral(const LoadedCase& loaded) : loaded_(loaded), flow_(loaded) {
  if (loaded.options.get<ParticleCaseOptions>().any()) suspension_ = std::make_unique<Suspension<T>>(loaded, flow_);
}

template <class T>
void Spectral<T>::start() {
  flow_.set_potential(initial_potential(loaded_, flow_));
  // The force is proportional to the velocity of its shell: from rounding alone it would raise rounding.
  const double noise = 1e4 * std::pow(std::numeric_limits<T>::epsilon(), 2);
  if (loaded_.options.get<ForcingOptions>().kind == ForcingKind::shell &&
      !(flow_.forced_energy() > noise * flow_.measure_budget().energy))
    throw refusal(loaded_.options, "forcing",
                  "the forced shell holds no energy at the start, so that no force could inject any; choose "
                  "[initial] or [forcing] so that the wavenumbers meet (they count in 2 pi / longest length)");
  flow_.evaluate_tendency();
  if (suspension_) {
    suspension_->require_possible(flow_.step_limit());
    suspension_->start();
  }
  started_ = true;
}

template <class T>
void Spectral<T>::ensure_started() {
  if (!started_) start();
}

template <class T>
std::size_t Spectral<T>::particle_count() const {
  const auto& points = flow_.layout().points;
  return points[0] * points[1] * points[2];
}

template <class T>
StepLimit Spectral<T>::step_limit() const {
  return suspension_ ? suspension_->limited(flow_.step_limit()) : flow_.step_limit();
}

template <class T>
std::vector<Stage> Spectral<T>::plan() const {
  const SpectralOptions& options = loaded_.options.get<SpectralOptions>();
  const ForcingKind forcing = loaded_.options.get<ForcingOptions>().kind;
  const bool padded = options.dealiasing == Dealiasing::padded;
  const char* const integrators[] = {"Adams-Bashforth 2", "Runge-Kutta 3, three tendencies a step",
                                     "Runge-Kutta 4, five tendencies a step"};
  std::vector<Stage> list;
  const auto add = [&list](std::string name, bool on, std::string reason) {
    list.push_back({.name = std::move(name), .reason = std::move(reason), .on = on});
  };
  add("x stage", true, "modes to planes of x, velocity and two gradients");
  add("planes of the product", true,
      padded ? "u x omega on 3N/2 points, plane by plane" : "u x omega on N points, plane by plane");
  add("two-thirds cut", options.dealiasing == Dealiasing::two_thirds,
      options.dealiasing == Dealiasing::two_thirds ? "modes above N/3 are held at zero" : "spectral.dealiasing");
  add("forcing", forcing != ForcingKind::none,
      forcing == ForcingKind::shell    ? "constant injection on a shell"
      : forcing == ForcingKind::linear ? "rate times velocity"
                                       : "forcing.kind = \"none\"");
  add("update", true, integrators[static_cast<int>(options.integrator)]);
  const bool viscous = flow_.viscosity() > 0;
  add("viscosity", viscous, viscous ? "exact, by an integrating factor" : "inviscid");
  if (suspension_) suspension_->add_stages(list);
  return list;
}

template <class T>
std::vector<ArrayInfo> Spectral<T>::arrays() const {
  std::vector<ArrayInfo> list = flow_.arrays();
  double drawn = static_cast<double>(total_pressure_.capacity() * sizeof(std::complex<T>));
  for (const auto& set : drawn_)
    for (const auto& field : set) drawn += static_cast<double>(field.capacity() * sizeof(float));
  if (suspension_) suspension_->add_arrays(list);
  if (drawn > 0) list.push_back({"snapshots and probes", drawn});
  return list;
}

template <class T>
std::vector<SeriesColumn> Spectral<T>::series_columns() const {
  std::vector<SeriesColumn> columns{{"kinetic_energy", "rho u^2 / 2, integral"},
                                    {"dissipation", "rho nu |S|^2, integral"},
                                    {"mean_energy", "u^2 / 2, mean"},
                                    {"mean_dissipation", "mean"},
                                    {"mean_injection", "by the force, mean"},
                                    {"mean_enstrophy", "omega^2 / 2, mean"},
                                    {"balance_residual", "of dE/dt since the last row, relative to dissipation"},
                                    {"max_speed", "speed at the start of the step"},
                                    {"rms_velocity", "u', speed"},
                                    {"integral_scale", "length"},
                                    {"taylor_scale", "length"},
                                    {"kolmogorov_scale", "length"},
                                    {"reynolds_lambda", "1"},
                                    {"kmax_eta", "1"},
                                    {"gradient_skewness", "of du/dx"},
                                    {"gradient_flatness", "of du/dx"}};
  if (suspension_) suspension_->add_columns(columns);
  return columns;
}

template <class T>
std::vector<Invariant> Spectral<T>::invariants() const {
  const Case& options = loaded_.options;
  if (options.get<ForcingOptions>().kind != ForcingKind::none || loaded_.scene.body_force) return {};
  const ParticleCoupling coupling = options.get<ParticleCaseOptions>().coupling;
  if (suspension_ && (coupling == ParticleCoupling::two_way || coupling == ParticleCoupling::four_way)) return {};
  return {{.quantity = "energy_growth",
           .kind = Invariant::Kind::growth,
           .column = "mean_energy",
           .bound = 0.01,
           .scale_column = "mean_energy"}};
}

template <class T>
void Spectral<T>::series_values(std::span<double> values) {
  ensure_started();
  const EnergyBudget& budget = flow_.budget();
  const Scales scales = flow_scales(flow_, shell_spectrum(flow_));
  const GradientMoments moments = gradient_moments(flow_);
  const auto& lengths = flow_.layout().lengths;
  const double mass = loaded_.scene.fluid.density * lengths[0] * lengths[1] * lengths[2];
  const double lost = flow_.integrated_dissipation() - row_[2];
  const double residual =
      row_[3] > 0 && lost > 0 ? (budget.energy - row_[0] - (flow_.integrated_gain() - row_[1])) / lost : 0;
  row_ = {budget.energy, flow_.integrated_gain(), flow_.integrated_dissipation(), 1};
  std::vector<double> row = {mass * budget.energy,
                             mass * budget.dissipation,
                             budget.energy,
                             budget.dissipation,
                             budget.injection,
                             scales.enstrophy,
                             residual,
                             flow_.peak().speed,
                             scales.rms_velocity,
                             scales.integral_scale,
                             scales.taylor_scale,
                             scales.kolmogorov_scale,
                             scales.reynolds_lambda,
                             scales.kmax_eta,
                             moments.skewness,
                             moments.flatness};
  if (suspension_) suspension_->values(row);
  std::copy(row.begin(), row.end(), values.begin());
  if (scales.kmax_eta < 1 && !warned_) {
    warned_ = true;
    char text[200];
    std::snprintf(text, sizeof text,
                  "the smallest scales are not resolved: k_max eta = %.2f at t = %.4g, which should be 1.5 or more; "
                  "raise resolution.grid or the viscosity",
                  scales.kmax_eta, flow_.time());
    remarks_.push_back(text);
  }
}

template <class T>
std::vector<std::string> Spectral<T>::take_remarks() {
  return std::exchange(remarks_, {});
}

template <class T>
bool Spectral<T>::wants(const std::string& field) const {
  const auto& fields = loaded_.options.output.fields;
  return fields.empty() ? field == "velocity" : std::find(fields.begin(), fields.end(), field) != fields.end();
}

template <class T>
std::vector<ParticleSnapshot> Spectral<T>::snapshot() {
  ensure_started();
  return suspension_ ? std::vector<ParticleSnapshot>{suspension_->family()} : std::vector<ParticleSnapshot>{};
}

template <class T>
std::vector<GridSnapshot> Spectral<T>::grid_snapshot() {
  ensure_started();
  const ModeLayout& layout = flow_.layout();
  const std::size_t size = particle_count(), nz = layout.points[2];
  GridSnapshot family;
  family.name = "fluid";
  family.points = layout.points;
  family.origin = loaded_.scene.domain.lower;
  for (std::size_t axis = 0; axis < 3; ++axis)
    family.spacing[axis] = layout.lengths[axis] / static_cast<double>(layout.points[axis]);
  Array<T> values;
  const auto draw = [&](std::size_t set, const char* name, auto&& fill) {
    const std::size_t components = set < 2 ? 3 : 1;
    drawn_[set].resize(components);
    GridSnapshot::Field field{name, {}};
    values.resize(components * size);
    fill();
    for (std::size_t c = 0; c < components; ++c) {
      drawn_[set][c].resize(size);
      parallel_for(size, [&](std::size_t i) { drawn_[set][c][i] = static_cast<float>(values[c * size + i]); });
      field.components.push_back(drawn_[set][c].data());
    }
    family.fields.push_back(std::move(field));
  };
  const auto parts = [&] { return std::array<T*, 3>{&values[0], &values[size], &values[2 * size]}; };
  if (wants("velocity") || wants("pressure")) {
    draw(0, "velocity", [&] { real_velocity(flow_, flow_.potential(), {}, parts(), nz); });
    if (!wants("velocity")) family.fields.clear();
  }
  if (wants("vorticity")) draw(1, "vorticity", [&] { real_vorticity(flow_, flow_.potential(), {}, parts(), nz); });
  if (wants("pressure"))
    draw(2, "pressure", [&] {
      flow_.total_pressure(total_pressure_);
      total_pressure_step_ = flow_.steps();
      flow_.box().inverse(
          [&](std::size_t ix, std::size_t iy, std::size_t first, std::complex<T>* block) {
            std::copy_n(&total_pressure_[ix * layout.plane + iy * layout.row + first], lanes<T>, block);
          },
          values.data(), nz);
      double mean = 0;
      const auto square = [&](std::size_t i) {
        double sum = 0;
        for (const auto& u : drawn_[0]) sum += double{u[i]} * double{u[i]};
        return sum / 2;
      };
      mean = parallel_sum(size, square) / static_cast<double>(size);
      const double density = loaded_.scene.fluid.density;
      parallel_for(
          size, [&](std::size_t i) { values[i] = static_cast<T>(density * (double{values[i]} - square(i) + mean)); });
    });
  return {family};
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
  sample.pressure = loaded_.scene.fluid.density * (sample.pressure + flow_.budget().energy);  // mean pressure 0
  return sample;
}

template <class T>
double Spectral<T>::elevation(const Vec3&) {
  return std::nan("");
}

template <class T>
double Spectral<T>::wetted_length(const Vec3&) {
  return std::nan("");
}

template <class T>
double Spectral<T>::front(int, double) {
  return std::nan("");
}

template <class T>
PlaneSample Spectral<T>::plane_average(int axis, double position) {
  const auto& pressure = total_pressure();
  const auto a = static_cast<std::size_t>(axis);
  PlaneSample sample = sample_plane(flow_, pressure, a, position - loaded_.scene.domain.lower[a]);
  sample.pressure = loaded_.scene.fluid.density * (sample.pressure + flow_.budget().energy);
  return sample;
}

template <class T>
bool Spectral<T>::spectrum(std::vector<double>& wavenumber, std::vector<double>& energy) {
  ensure_started();
  ShellSpectrum spectrum = shell_spectrum(flow_);
  wavenumber = std::move(spectrum.wavenumber);
  energy = std::move(spectrum.energy);
  return true;
}

template <class T>
std::vector<Distribution> Spectral<T>::distribution_headings() const {
  std::vector<Distribution> tables{{"gradient_pdf",
                                    {{"gradient", "standard deviations"},
                                     {"longitudinal", "probability density"},
                                     {"transverse", "probability density"}},
                                    {}}};
  if (suspension_) suspension_->add_headings(tables);
  return tables;
}

template <class T>
std::vector<Distribution> Spectral<T>::distributions() {
  ensure_started();
  const GradientDistribution pdf = gradient_distribution(flow_);
  std::vector<Distribution> tables = distribution_headings();
  tables.resize(1);
  if (suspension_) suspension_->add_distributions(tables);
  for (std::size_t i = 0; i < pdf.value.size(); ++i)
    tables[0].values.insert(tables[0].values.end(), {pdf.value[i], pdf.longitudinal[i], pdf.transverse[i]});
  return tables;
}

template <class T>
void Spectral<T>::save(StateWriter& writer) const {
  flow_.save(writer);
  writer.f64("balance", row_);
  if (suspension_) suspension_->save(writer);
}

template <class T>
void Spectral<T>::load(StateReader& reader) {
  flow_.load(reader);
  Array<double> row;
  reader.f64("balance", row);
  if (row.size() != row_.size()) throw FileError("the checkpoint was written by another version of the method");
  std::copy(row.begin(), row.end(), row_.begin());
  if (suspension_) suspension_->load(reader);
  started_ = true;
  total_pressure_step_ = -1;
}

template class Spectral<double>;
template class Spectral<float>;

}  // namespace spume::spectral
