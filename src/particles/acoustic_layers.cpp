// SPDX-License-Identifier: MIT
#include "spume/particles/acoustic_layers.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"

namespace spume {
namespace {

// K L / c: Poinsot and Lele (1992), after D. H. Rudy and J. C. Strikwerda, J. Comput. Phys. 36 (1980), who have 0.27.
constexpr double relaxation = 0.25;

}  // namespace

AcousticLayers::AcousticLayers(const Scene& scene, const Resolution& resolution, const std::vector<PhaseLaw>& laws,
                               ParticleStore& particles, const Array<std::int64_t>& phase, BufferLayers& layers)
    : scene_(scene),
      resolution_(resolution),
      laws_(laws),
      particles_(particles),
      phase_(phase),
      layers_(layers),
      means_(layers.columns()) {}

AcousticLayers::Seen AcousticLayers::look(const Liquid& liquid, const Array<float>& pressure, std::size_t i) const {
  const NeighbourList& list = liquid.arrangement.list;
  const Images& images = liquid.arrangement.images;
  const OpenGate& gate = gate_of(i);
  const int d = particles_.dimensions, normal = gate.opening->axis;
  const bool inflow = gate.opening->inflow;
  const auto n = static_cast<std::int32_t>(list.particles());
  const std::int32_t* wall_point = images.wall_point();
  Vec3 pull = liquid.gravity;
  if (inflow) pull[normal] -= layers_.column_of(i).acceleration;
  Seen all;
  std::array<Seen, 2> sums;  // of the other phases, of its own
  for (const std::int32_t point : list.of(i)) {
    const std::size_t j = liquid.arrangement.particle_of(point), k = static_cast<std::size_t>(std::max(0, point - n));
    if (layers_.holds(j)) continue;
    if (point >= n) {
      if (wall_point != nullptr && wall_point[k] >= 0) continue;
      if (images.paths()[liquid.images.path(k)].side[normal] >= 0) continue;
    }
    double distance2 = 0, head = 0;
    for (int axis = 0; axis < d; ++axis) {
      const float* x = list.coordinate(axis);
      const double way = double{x[point]} - double{x[i]};
      distance2 += way * way;
      head += pull[axis] * (double{x[i]} - double{x[j]});
    }
    const double weight = WendlandC2::w(std::sqrt(distance2) / resolution_.smoothing_length);
    const bool same = phase_[j] == phase_[i];
    const double density = laws_[static_cast<std::size_t>(phase_[i])].density;
    Seen& sum = sums[same ? 1 : 0];
    sum.weight += weight;
    sum.pressure += weight * (double{pressure[j]} - liquid.background + density * head);
    const PhaseLaw& law = laws_[static_cast<std::size_t>(phase_[j])];
    all.all += weight;
    all.outwards -= weight * gate.inwards * liquid.velocity(normal, j);
    all.compliance += weight / (law.density * law.sound_speed);
    if (weight > 0) all.heaviest = std::max(all.heaviest, law.density);
    for (int axis = 0; axis < d; ++axis) {
      const double u = liquid.velocity(axis, j);
      sum.velocity[axis] += weight * (point < n ? u : liquid.images.velocity(k, axis, u));
    }
  }
  const bool own = sums[1].weight > 0;
  Seen seen = sums[own ? 1 : 0];
  seen.own = own;
  seen.heaviest = all.heaviest;
  seen.all = all.all;
  seen.outwards = all.outwards;
  seen.compliance = all.compliance;
  if (seen.weight > 0) {
    seen.pressure /= seen.weight;
    seen.velocity = multiply(1 / seen.weight, seen.velocity);
  }
  return seen;
}

void AcousticLayers::find_pressures(const Liquid& liquid, Array<double>& excess, Array<float>& pressure,
                                    Array<float>& volume) {
  members_ = &layers_.find_members();
  const std::size_t n = members_->size();
  seen_.resize(n);
  parallel_for(n, [&](std::size_t k) { seen_[k] = look(liquid, pressure, static_cast<std::size_t>((*members_)[k])); });
  // Expressions are not for several threads at a time.
  double heaviest = 0;
  for (const PhaseLaw& law : laws_) heaviest = std::max(heaviest, law.density);
  for (std::size_t k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>((*members_)[k]);
    const OpenGate& gate = gate_of(i);
    const PhaseLaw& law = laws_[static_cast<std::size_t>(phase_[i])];
    const Seen& seen = seen_[k];
    double p = seen.pressure;
    if (!gate.opening->inflow) {
      const auto axis = static_cast<std::size_t>(gate.opening->axis);
      Vec3 foot{};
      for (int a = 0; a < particles_.dimensions; ++a)
        foot[a] = liquid.arrangement.list.coordinate(a)[i] + liquid.arrangement.origin[a];
      foot = gate.wrapped(foot);
      foot[axis] = gate.plane;
      p = pressure_outside(scene_, *gate.opening, foot, {heaviest}, liquid.time);
      const double inwards = gate.inwards * seen.velocity[axis];
      if (inwards > 0 && law.density <= seen.heaviest) p -= law.density / 2 * inwards * inwards;
      // Fluids side by side have one pressure, so that their velocities add up as 1 / (rho c): the impedance of water
      // alone would shoot air back that is with it.
      const Mean& mean = mean_of(i);
      if (mean.known && seen.all > 0) p += (seen.outwards - seen.all * mean.outwards) / seen.compliance;
    }
    excess[i] = law.excess(p);
    pressure[i] = static_cast<float>(p + liquid.background);
    volume[i] = static_cast<float>(1 / (1 + excess[i]));
  }
}

double AcousticLayers::share_of_step(int axis, double sound_speed, double dt) const {
  const double length = scene_.domain.upper[axis] - scene_.domain.lower[axis];
  return -std::expm1(-relaxation * dt * sound_speed / length);
}

void AcousticLayers::follow(double dt) {
  const int d = particles_.dimensions;
  struct Sum {
    double all = 0, outwards = 0, share = 0;
  };
  std::vector<Sum> sums(means_.size());
  // Of the phases of each column: of the own phase, and of whatever is seen.
  std::vector<std::array<Sum, 2>> before(means_.size() * laws_.size());
  const auto before_phase = [&](std::size_t i) -> std::array<Sum, 2>& {
    return before[static_cast<std::size_t>(layers_.column()[i]) * laws_.size() + static_cast<std::size_t>(phase_[i])];
  };
  for (std::size_t k = 0; members_ != nullptr && k < members_->size(); ++k) {
    const auto i = static_cast<std::size_t>((*members_)[k]);
    const OpenGate& gate = gate_of(i);
    const Opening& opening = *gate.opening;
    const Seen& seen = seen_[k];
    if (opening.inflow || !(seen.weight > 0)) continue;
    const double share = share_of_step(opening.axis, laws_[static_cast<std::size_t>(phase_[i])].sound_speed, dt);
    Sum& sum = sums[static_cast<std::size_t>(layers_.column()[i])];
    sum.all += seen.all;
    sum.outwards += seen.outwards;
    sum.share += seen.all * share;
    if (seen.own || laws_[static_cast<std::size_t>(phase_[i])].density <= seen.heaviest) {
      Sum& of_phase = before_phase(i)[seen.own ? 0 : 1];
      of_phase.all += seen.weight;
      of_phase.outwards -= seen.weight * gate.inwards * seen.velocity[opening.axis];
    }
    for (int axis = 0; axis < d; ++axis) {
      if (axis == opening.axis) continue;
      double& u = (*particles_.velocity[axis])[i];
      u += share * (seen.velocity[axis] - u);
    }
  }
  // Into the domain and out of it a column goes as the liquid before it, at any depth: what lags when it comes back
  // leaves a void, and what follows inwards alone is pumped in by sound.
  for (std::size_t k = 0; members_ != nullptr && k < members_->size(); ++k) {
    const auto i = static_cast<std::size_t>((*members_)[k]);
    const OpenGate& gate = gate_of(i);
    if (gate.opening->inflow) continue;
    const std::array<Sum, 2>& seen = before_phase(i);
    const Sum& sum = seen[seen[0].all > 0 ? 0 : 1];
    if (sum.all > 0) (*particles_.velocity[gate.opening->axis])[i] = -gate.inwards * sum.outwards / sum.all;
  }
  for (std::size_t c = 0; c < means_.size() && !scene_.free_surface; ++c) {
    const Sum& sum = sums[c];
    if (!(sum.all > 0)) continue;
    Mean& mean = means_[c];
    const double now = sum.outwards / sum.all;
    mean.outwards = mean.known ? mean.outwards + sum.share / sum.all * (now - mean.outwards) : now;
    mean.known = true;
  }
}
AcousticLayers::Fastest AcousticLayers::fastest_inflow(double end) const {
  constexpr int times = 32;
  Fastest fastest;
  std::vector<OpenGate> gates = layers_.gates().list;
  for (OpenGate& gate : gates) {
    const Opening& opening = *gate.opening;
    for (int n = 0; n <= times && opening.inflow; ++n) {
      const double t = end * n / times;
      const Entering entering(opening, gate.find_wet(particles_.dimensions - 1, t), t);
      for (const OpenGate::Column& column : gate.columns)
        if (const double mach = length(entering.velocity(column.foot)) / laws_[opening.phase].sound_speed;
            column.wet && mach > fastest.mach)
          fastest = {mach, opening.name};
    }
  }
  return fastest;
}

void AcousticLayers::save(StateWriter& writer) const {
  std::vector<double> means;
  for (const Mean& one : means_) means.insert(means.end(), {one.outwards, one.known ? 1.0 : 0.0});
  writer.f64("open_means", means);
}

void AcousticLayers::load(StateReader& reader) {
  Array<double> means;
  reader.f64("open_means", means);
  if (means.size() != 2 * means_.size()) throw FileError("the checkpoint is of a scene with other openings");
  for (std::size_t c = 0; c < means_.size(); ++c) means_[c] = {means[2 * c], means[2 * c + 1] != 0};
}

double AcousticLayers::bytes() const {
  return static_cast<double>(means_.capacity() * sizeof(Mean) + seen_.capacity() * sizeof(Seen));
}

}  // namespace spume
