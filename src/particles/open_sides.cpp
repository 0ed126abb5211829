// SPDX-License-Identifier: MIT
// Openings over time: how their points move, and what becomes of them.
#include <cmath>
#include <limits>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/boundary.hpp"

namespace spume {
OpenSides::OpenSides(const Scene& scene, const Resolution& resolution, double particle_volume)
    : scene_(scene),
      resolution_(resolution),
      particle_volume_(particle_volume),
      open_gates_(scene, particle_volume),
      gates_(open_gates_.list) {
  const int d = scene.domain.dimensions;
  // Behind an outflow stands what mirrors the liquid before it.
  const InitialParticles& initial = scene.particles;
  next_identifier_ = static_cast<std::int64_t>(initial.size());
  for (std::size_t g = 0; g < gates_.size(); ++g) {
    const OpenGate& gate = gates_[g];
    if (gate.opening->inflow) continue;
    for (std::size_t i = 0; i < initial.size(); ++i) {
      Drifting one;
      one.gate = static_cast<int>(g);
      for (int axis = 0; axis < d; ++axis) {
        one.place[axis] = initial.position[axis][i];
        one.velocity[axis] = initial.velocity[axis][i];
      }
      double& x = one.place[gate.opening->axis];
      if (gate.inwards * (x - gate.plane) > gate.whole_layers(resolution.support_radius + gate.layer) ||
          gate.column_at(one.place) < 0)
        continue;
      x = 2 * gate.plane - x;
      one.next = one.place;
      drifting_.push_back(one);
    }
  }
  list_points(0);  // for largest_speed()
}

OpenSides::~OpenSides() = default;

void OpenSides::advance(double t, double dt) {
  step_ = dt;
  for (OpenGate& gate : gates_) {
    const Opening& opening = *gate.opening;
    if (!opening.inflow) continue;
    const double wet = gate.find_wet(scene_.domain.dimensions - 1, t + dt);
    // Simpson's rule in time, as for moving walls.
    const Entering before(opening, wet, t), middle(opening, wet, t + dt / 2), after(opening, wet, t + dt);
    for (OpenGate::Column& column : gate.columns) {
      column.next = column.travelled;
      if (!column.wet) continue;
      const auto speed = [&](const Entering& at) { return gate.inwards * at.velocity(column.foot)[opening.axis]; };
      column.next += std::max(0.0, (speed(before) + 4 * speed(middle) + speed(after)) / 6) * dt;
    }
  }
  const Domain& domain = scene_.domain;
  for (Drifting& one : drifting_) {
    const OpenGate& gate = gates_[static_cast<std::size_t>(one.gate)];
    one.next = gate.wrapped(add(one.place, multiply(dt, one.velocity)));
    for (int axis = 0; axis < domain.dimensions; ++axis) {
      if (axis == gate.opening->axis || domain.periodic(axis)) continue;
      double& x = one.next[axis];
      const double lower = domain.lower[axis], upper = domain.upper[axis];
      if (x < lower && domain.sides[axis][0].kind != BoundaryKind::open)
        x = 2 * lower - x;
      else if (x > upper && domain.sides[axis][1].kind != BoundaryKind::open)
        x = 2 * upper - x;
    }
  }
}

void OpenSides::accept() {
  for (OpenGate& gate : gates_)
    for (OpenGate::Column& column : gate.columns) column.travelled = column.next;
  for (Drifting& one : drifting_) one.place = one.next;
}

void OpenSides::take_entering(int up, double t, std::vector<Newcomer>& newcomers) {
  for (OpenGate& gate : gates_) {
    const Opening& opening = *gate.opening;
    if (!opening.inflow) continue;
    const double wet = gate.find_wet(up, t);
    std::unique_ptr<Entering> entering;
    for (OpenGate::Column& column : gate.columns)
      for (; column.travelled > 0.5 * column.layer; column.travelled -= column.layer) {
        if (entering == nullptr) entering = std::make_unique<Entering>(opening, wet, t);
        Newcomer one{column.foot, entering->velocity(column.foot)};
        one.place[opening.axis] += gate.inwards * (column.travelled - 0.5 * column.layer);
        newcomers.push_back(one);
        ++entered_;
      }
  }
}

void OpenSides::take_returning(std::vector<Newcomer>& newcomers) {
  std::vector<Drifting> kept, behind;
  for (Drifting one : drifting_) {
    const OpenGate& gate = gates_[static_cast<std::size_t>(one.gate)];
    // Whole layers: what takes the place of one that comes back stands within them.
    const double depth = gate.depth_behind(one.place),
                 reach = gate.whole_layers(resolution_.support_radius + gate.layer);
    if (depth > reach || gate.column_at(one.place) < 0) continue;
    if (depth >= 0) {
      kept.push_back(one);
      continue;
    }
    newcomers.push_back({one.place, one.velocity});
    --left_;
    one.place[gate.opening->axis] -= gate.inwards * reach;
    behind.push_back(one);
  }
  drifting_.swap(kept);
  drifting_.insert(drifting_.end(), behind.begin(), behind.end());
}

bool OpenSides::exchange(ParticleStore& particles, double t) {
  const int d = particles.dimensions;
  const std::size_t n = particles.size();
  Array<std::int32_t> gone, order;
  const auto place_of = [&](std::size_t i) { return vector_at(particles.position, d, i); };
  parallel_select(n, gone, [&](std::size_t i) { return open_gates_.outflow_behind(place_of(i)) >= 0; });
  std::vector<Newcomer> newcomers;
  take_entering(d - 1, t, newcomers);
  take_returning(newcomers);
  for (const std::int32_t i : gone) {
    const auto k = static_cast<std::size_t>(i);
    const Vec3 place = place_of(k);
    drifting_.push_back({place, place, vector_at(particles.velocity, d, k), open_gates_.outflow_behind(place)});
    ++left_;
  }
  if (gone.empty() && newcomers.empty()) return false;
  parallel_select(n, order, [&](std::size_t i) { return open_gates_.outflow_behind(place_of(i)) < 0; });
  add_copies_of_nearest(particles, newcomers, order);
  const std::size_t staying = order.size() - newcomers.size();
  if (n > 0) {
    particles.fields.permute(order);
  } else {
    particles.fields.resize(order.size());
    for (const auto& field : particles.fields.fields()) std::visit([](auto& values) { values.fill(0); }, field->values);
  }
  for (std::size_t k = 0; k < newcomers.size(); ++k) {
    for (int axis = 0; axis < d; ++axis) {
      (*particles.position[axis])[staying + k] = newcomers[k].place[axis];
      (*particles.velocity[axis])[staying + k] = newcomers[k].velocity[axis];
    }
    (*particles.identifier)[staying + k] = next_identifier_++;
  }
  return true;
}

// Of each newcomer the nearest of the particles that stay, and of those that leave where none stays.
void OpenSides::add_copies_of_nearest(const ParticleStore& particles, const std::vector<Newcomer>& newcomers,
                                      Array<std::int32_t>& order) const {
  const int d = particles.dimensions;
  const std::size_t staying = order.size();
  // Newcomers stand at the openings: what lies farther from all of them than two support radii is asked only where
  // nothing is nearer.
  std::vector<std::int32_t> candidates;
  for (std::size_t k = 0; k < staying; ++k) {
    const Vec3 place = vector_at(particles.position, d, static_cast<std::size_t>(order[k]));
    for (const OpenGate& gate : gates_)
      if (gate.depth_behind(place) > -2 * resolution_.support_radius) {
        candidates.push_back(order[k]);
        break;
      }
  }
  if (candidates.empty()) candidates.assign(order.begin(), order.end());
  if (candidates.empty())
    for (std::size_t i = 0; i < particles.size(); ++i) candidates.push_back(static_cast<std::int32_t>(i));
  order.resize(staying + newcomers.size());
  const auto r = read(particles.position);
  parallel_blocks(newcomers.size(), 1, [&](std::size_t k, std::size_t, std::size_t) {
    double nearest2 = std::numeric_limits<double>::infinity();
    order[staying + k] = 0;
    for (const std::int32_t i : candidates) {
      double distance2 = 0;
      for (int axis = 0; axis < d; ++axis) {
        const double x = r[axis][i] - newcomers[k].place[axis];
        distance2 += x * x;
      }
      if (distance2 >= nearest2) continue;
      nearest2 = distance2;
      order[staying + k] = i;
    }
  });
}

void OpenSides::follow(const WallStencils& stencils, const std::array<const double*, 3>& velocity) {
  const int d = scene_.domain.dimensions;
  parallel_for(points_.size(), [&](std::size_t p) {
    const std::int32_t k = points_[p].number;
    const std::size_t g = first_point_ + p;
    if (k < 0 || stencils.kind[g] != PointKind::outflow) return;
    for (int axis = 0; axis < d; ++axis)
      drifting_[static_cast<std::size_t>(k)].velocity[axis] = stencils.mirrored(g, velocity[axis]);
  });
}

void OpenSides::save(StateWriter& writer) const {
  std::vector<double> travelled, place;
  std::vector<std::int64_t> gate{entered_, left_, next_identifier_};
  for (const OpenGate& one : gates_)
    for (const OpenGate::Column& column : one.columns) travelled.push_back(column.travelled);
  for (const Drifting& one : drifting_) {
    place.insert(place.end(), one.place.begin(), one.place.end());
    place.insert(place.end(), one.velocity.begin(), one.velocity.end());
    gate.push_back(one.gate);
  }
  writer.f64("open_columns", travelled);
  writer.f64("open_points", place);
  writer.i64("open_counts", gate);
}

void OpenSides::load(StateReader& reader) {
  Array<double> travelled, place;
  Array<std::int64_t> gate;
  reader.f64("open_columns", travelled);
  reader.f64("open_points", place);
  reader.i64("open_counts", gate);
  std::size_t columns = 0;
  for (const OpenGate& one : gates_) columns += one.columns.size();
  if (travelled.size() != columns || place.size() % 6 != 0 || gate.size() != 3 + place.size() / 6)
    throw FileError("the checkpoint is of a scene with other openings");
  entered_ = gate[0];
  left_ = gate[1];
  next_identifier_ = gate[2];
  std::size_t k = 0;
  for (OpenGate& one : gates_)
    for (OpenGate::Column& column : one.columns) column.travelled = column.next = travelled[k++];
  drifting_.resize(place.size() / 6);
  for (std::size_t p = 0; p < drifting_.size(); ++p) {
    Drifting& one = drifting_[p];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      one.place[axis] = one.next[axis] = place[6 * p + axis];
      one.velocity[axis] = place[6 * p + 3 + axis];
    }
    one.gate = static_cast<int>(gate[3 + p]);
  }
}

double OpenSides::bytes() const {
  double sum = static_cast<double>(drifting_.capacity() * sizeof(Drifting) + points_.capacity() * sizeof(OpeningPoint));
  for (const OpenGate& gate : gates_)
    sum += static_cast<double>(gate.columns.capacity() * sizeof(OpenGate::Column) + 4 * gate.column_of.capacity());
  return sum;
}

}  // namespace spume
