// SPDX-License-Identifier: MIT
// With the pair weights g of operators/sph_operators.hpp, kernel K and particle volume V,
//   T_i^{n+1} = T_i^n + dt kappa' sum_j 2 g_ij (T_j^n - T_i^n),   kappa' = kappa d / div r,
// where div r of the lattice makes the sum exact for quadratic T. g_ij = g_ji: heat V sum_i T_i is conserved. Images
// have the temperature of their sources: walls are insulated.
#include "toy_method/heat_conduction.hpp"

#include <cmath>

#include "spume/operators/image_values.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/output_fields.hpp"
#include "spume/particles/point_sampler.hpp"
#include "spume/scene/expression.hpp"
#include "spume/scene/refusal.hpp"

namespace spume::test {
namespace {

struct HeatOptions {
  std::string temperature;
};

class HeatConduction final : public Method, public FieldProbes {
 public:
  explicit HeatConduction(const LoadedCase& loaded)
      : options_(loaded.options),
        resolution_(loaded.scene.domain.dimensions, loaded.scene.spacing, options_.resolution.kernel,
                    options_.resolution.smoothing_ratio),
        diffusivity_(loaded.scene.fluid.kinematic_viscosity * resolution_.dimensions /
                     resolution_.lattice.divergence_of_position),
        particles_(resolution_.dimensions, loaded.scene.particles),
        temperature_(particles_.fields.add<double>("temperature", Lifetime::state)),
        boundary_(loaded.scene.domain, loaded.scene.spacing),
        arrangement_(loaded.scene.domain, resolution_, particles_.volume, particles_.size()) {
    set_temperature();
    plan_.add({.name = "neighbours",
               .reason = "once: the particles are at rest",
               .work = [this](StageRun&) { find_neighbours(); },
               .due = [this] { return !arranged_; }});
    const auto work = [this](StageRun& run) { conduct(run); };
    plan_.add({"conduction", "explicit step of the temperature", true, work, {temperature_}, {temperature_}});
    series_.add("heat", "temperature times volume", [this] {
      return particles_.volume * parallel_sum(particles_.size(), [&](std::size_t i) { return temperature_[i]; });
    });
    saved_.add(time_).add(steps_);
  }

  static std::vector<OutputField<HeatConduction>> output_fields() {
    return {{"temperature", always, [](const HeatConduction& heat) { return &heat.temperature_; }}};
  }
  const std::vector<Stage>& plan() const override { return plan_.stages(); }
  std::vector<ArrayInfo> arrays() const override { return particle_arrays(particles_, arrangement_); }
  std::size_t particle_count() const override { return particles_.size(); }
  double time() const override { return time_; }
  std::int64_t step_count() const override { return steps_; }

  // Up to a courant number of 1 the new temperature is an average of old ones, hence stable.
  StepLimit step_limit() const override {
    const double most = std::pow(resolution_.spacing, 2) / (diffusivity_ * resolution_.lattice.laplacian_diagonal);
    return {options_.time.courant * most, "diffusive"};
  }

  void step(double dt, Ledger& ledger) override {
    plan_.run_step(dt, static_cast<double>(particles_.size()), ledger);
    time_ += dt;
    ++steps_;
  }

  std::vector<SeriesColumn> series_columns() const override { return series_.columns(); }
  void series_values(std::span<double> values) override { series_.values(values); }
  std::vector<ParticleSnapshot> snapshot() override {
    return {snapshot_.take("fluid", particles_.size(), particles_.position, options_.output.fields)};
  }
  FieldProbes* field_probes() override { return this; }
  PointSample sample(const Vec3& position) override { return sampler().sample(position); }
  PlaneSample plane_average(int axis, double at) override { return sampler().plane_average(axis, at); }

  void save(StateWriter& writer) const override {
    saved_.save(writer);
    save_fields(particles_.fields, writer);
  }
  void load(StateReader& reader) override {
    saved_.load(reader);
    load_fields(particles_.fields, particles_.size(), "particle", reader);
    arranged_ = false;
  }

 private:
  void set_temperature() try {
    const auto initial =
        ExpressionScope(particles_.dimensions).compile(options_.get<HeatOptions>().temperature, Arguments::place);
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      const Vec3 r = vector_at(particles_.position, particles_.dimensions, i);
      temperature_[i] = (*initial)(r[0], r[1], r[2], 0);
    }
  } catch (const ExpressionError& error) {
    throw refusal(options_, "heat.temperature", std::string("heat.temperature: ") + error.what());
  }

  void find_neighbours() {
    arrangement_.sort(particles_, particles_.position);
    boundary_.make_images(arrangement_, particles_, particles_.position, 1, {time_, time_, time_});
    arrangement_.find_neighbours(particles_, particles_.position, ParticleSizes{});
    arranged_ = true;
  }

  void conduct(StageRun& run) {
    const SweepContext& context = arrangement_.context;
    with_plain_kernel(particles_.dimensions, resolution_.kernel, [&]<int dimensions, class Kernel>() {
      float* records = arrangement_.packed.prepare(context, 1);
      constexpr int width = record_width(dimensions, 1);
      pack_scalar(context, records, width, 0, temperature_.data());
      const KernelScale<dimensions, Kernel> scale(context);
      sweep(particles_.size(), [&](std::size_t i) {
        const auto own = simd::splat<simd::f32n>(records[i * width + dimensions]);
        simd::f32n sum{};
        for_each_batch<dimensions, 1>(arrangement_.list, records, i, scale.inverse_h, [&](const auto& batch) {
          sum = sum + (-2.0F * scale.gradient) * Kernel::f(batch.q) * (batch.payload[0] - own);
        });
        temperature_[i] += run.dt * diffusivity_ * simd::sum(sum);
      });
    });
    run.pairs = arrangement_.pair_count();
    run.bytes = arrangement_.packed.take_traffic();
  }

  const PointSampler& sampler() {
    return sampler_.update({&arrangement_, &boundary_, &particles_, &resolution_, {{&temperature_}}});
  }

  const Case& options_;
  const Resolution resolution_;
  const double diffusivity_;  // kappa'; Prandtl number 1: kappa is the viscosity
  ParticleStore particles_;
  Array<double>& temperature_;
  Boundary boundary_;
  Arrangement arrangement_;
  double time_ = 0;
  std::int64_t steps_ = 0;
  bool arranged_ = false;
  Plan plan_;
  SeriesTable series_;
  SnapshotTable snapshot_ = snapshot_table(output_fields(), options_, *this);
  SavedNumbers saved_{"numbers"};
  PointSampler sampler_;
};

}  // namespace

Registration heat_conduction() {
  Registration method;
  method.name = "heat";
  method.description = "heat conduction on particles at rest";
  method.fills_regions = true;
  method.sections = {section<HeatOptions>("heat")
                         .option("temperature", &HeatOptions::temperature, "at the start: an expression of x, y, z")
                         .required()};
  method.bytes_per_particle = [](const Draft& draft) { return 8.0 * (2 * draft.dimensions + 2); };
  method.default_courant = [](const Case&, const Scene&) { return 0.5; };
  method.default_courant_in_words = "0.5";
  method.output_fields = [](const Case& options) { return field_infos(HeatConduction::output_fields(), options); };
  method.probe_scalars = [](const Case&) { return std::vector<ProbeScalar>{{"temperature", "temperature"}}; };
  method.make = [](const LoadedCase& loaded) { return std::make_unique<HeatConduction>(loaded); };
  return method;
}

}  // namespace spume::test
