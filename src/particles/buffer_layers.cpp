// SPDX-License-Identifier: MIT
#include "spume/particles/buffer_layers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"

namespace spume {
namespace {

// Liquid that came back through a column, which is to be made up for; its own inverse.
constexpr std::int64_t returned(std::int64_t column) {
  return -2 - column;
}
constexpr std::int64_t liquid_of_domain = -1;

}  // namespace

// In the life of a list a layer comes forward by half the skin.
BufferLayers::BufferLayers(const Scene& scene, const Resolution& resolution, double skin, ParticleStore& particles)
    : scene_(scene),
      resolution_(resolution),
      particles_(particles),
      gates_(scene, particles.volume),
      reach_(resolution.support_radius + skin / 2),
      column_(&particles.fields.add<std::int64_t>("buffer_column", Lifetime::state)),
      entered_(scene.phases.size()),
      left_(scene.phases.size()) {
  for (std::size_t g = 0; g < gates_.list.size(); ++g) {
    const OpenGate& gate = gates_.list[g];
    first_.push_back(columns_.size());
    for (std::size_t cell = 0; cell < gate.columns.size(); ++cell)
      columns_.push_back({.gate = static_cast<std::int32_t>(g),
                          .cell = static_cast<std::int32_t>(cell),
                          .phase = gate.opening->phase});
  }
}

void BufferLayers::fill(Array<std::int64_t>& phase, std::vector<FloatVectorField> changes) {
  phase_ = &phase;
  changes_ = std::move(changes);
  column_->fill(liquid_of_domain);
  next_identifier_ = static_cast<std::int64_t>(particles_.size());
  set_velocities(0, 0);
  std::vector<Newcomer> newcomers;
  add_columns_of_inflows(newcomers);
  // Behind an outflow stands what mirrors the liquid before it.
  for (std::size_t g = 0; g < gates_.list.size(); ++g) {
    const OpenGate& gate = gates_.list[g];
    if (gate.opening->inflow) continue;
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      Newcomer one{.source = i,
                   .phase = phase[i],
                   .place = vector_at(particles_.position, particles_.dimensions, i),
                   .velocity = vector_at(particles_.velocity, particles_.dimensions, i)};
      const std::int32_t cell = gate.column_at(one.place);
      if (cell < 0 || -gate.depth_behind(one.place) > gate.whole_layers(reach_)) continue;
      one.column = static_cast<std::int64_t>(first_[g]) + cell;
      one.place[gate.opening->axis] = 2 * gate.plane - one.place[gate.opening->axis];
      newcomers.push_back(one);
    }
  }
  Array<std::int32_t> all;
  parallel_select(particles_.size(), all, [](std::size_t) { return true; });
  insert(all, newcomers);
}

const Array<std::int32_t>& BufferLayers::find_members() {
  parallel_select(particles_.size(), members_, [&](std::size_t i) { return holds(i); });
  return members_;
}

std::vector<Coming> BufferLayers::coming() {
  std::vector<Coming> list;
  for (const std::int32_t member : find_members()) {
    const auto i = static_cast<std::size_t>(member);
    if (!leads(i)) continue;
    const Column& column = column_of(i);
    const OpenGate& gate = gates_.list[static_cast<std::size_t>(column.gate)];
    const double depth = gate.depth_behind(vector_at(particles_.position, particles_.dimensions, i));
    list.push_back({.particle = i,
                    .foot = gate.columns[static_cast<std::size_t>(column.cell)].foot,
                    .depth = std::max(0.0, depth),
                    .speed = gate.inwards * column.velocity[gate.opening->axis]});
  }
  return list;
}

std::vector<std::int32_t> BufferLayers::nearest_liquid(const std::vector<Coming>& coming) {
  const int d = particles_.dimensions;
  const double reach = resolution_.support_radius;
  const auto before = [&](const OpenGate& gate, const Vec3& place) {
    return gate.opening->inflow && -gate.depth_behind(place) < reach;
  };
  parallel_select(particles_.size(), before_, [&](std::size_t i) {
    if (holds(i)) return false;
    const Vec3 place = vector_at(particles_.position, d, i);
    return std::any_of(gates_.list.begin(), gates_.list.end(),
                       [&](const OpenGate& gate) { return before(gate, place); });
  });
  std::vector<std::int32_t> nearest(columns_.size(), -1);
  std::vector<double> distance(columns_.size(), reach);
  for (const std::int32_t i : before_) {
    const Vec3 place = vector_at(particles_.position, d, static_cast<std::size_t>(i));
    for (std::size_t g = 0; g < gates_.list.size(); ++g) {
      const OpenGate& gate = gates_.list[g];
      const std::int32_t cell = before(gate, place) ? gate.column_at(place) : -1;
      if (cell < 0) continue;
      const std::size_t c = first_[g] + static_cast<std::size_t>(cell);
      if (-gate.depth_behind(place) >= distance[c]) continue;
      distance[c] = -gate.depth_behind(place);
      nearest[c] = i;
    }
  }
  // Far from all liquid the columns of an opening have one answer: every question goes over all particles.
  std::vector<std::optional<std::int32_t>> nearest_of_gate(gates_.list.size());
  for (const Coming& one : coming) {
    const auto c = static_cast<std::size_t>((*column_)[one.particle]);
    if (nearest[c] >= 0) continue;
    std::optional<std::int32_t>& like = nearest_of_gate[static_cast<std::size_t>(columns_[c].gate)];
    if (!like) like = nearest_of_all(one.foot);
    nearest[c] = *like;
  }
  return nearest;
}

// Of equally near ones the first.
std::int32_t BufferLayers::nearest_of_all(const Vec3& place) const {
  struct Nearest {
    double distance2 = std::numeric_limits<double>::infinity();
    std::int32_t particle = -1;
  };
  return parallel_reduce(
             particles_.size(), Nearest{},
             [&](std::size_t first, std::size_t last) {
               Nearest nearest;
               for (std::size_t i = first; i < last; ++i) {
                 if (holds(i)) continue;
                 const Vec3 way =
                     scene_.domain.shortest(subtract(vector_at(particles_.position, particles_.dimensions, i), place));
                 if (dot(way, way) < nearest.distance2) nearest = {dot(way, way), static_cast<std::int32_t>(i)};
               }
               return nearest;
             },
             [](const Nearest& a, const Nearest& b) { return b.distance2 < a.distance2 ? b : a; })
      .particle;
}

// The velocity of a step is its integral by Simpson's rule, as for moving walls.
void BufferLayers::set_velocities(double t, double dt) {
  const int d = particles_.dimensions;
  for (std::size_t g = 0; g < gates_.list.size(); ++g) {
    OpenGate& gate = gates_.list[g];
    const Opening& opening = *gate.opening;
    if (!opening.inflow) continue;
    const double wet = gate.find_wet(d - 1, t + dt);
    const Entering before(opening, wet, t), middle(opening, wet, t + dt / 2), after(opening, wet, t + dt);
    for (std::size_t cell = 0; cell < gate.columns.size(); ++cell) {
      Column& column = columns_[first_[g] + cell];
      const Vec3& foot = gate.columns[cell].foot;
      const Vec3 first = before.velocity(foot), last = after.velocity(foot);
      column.velocity = multiply(1.0 / 6, add(add(first, multiply(4, middle.velocity(foot))), last));
      double& normal = column.velocity[opening.axis];
      normal = gate.inwards * std::max(0.0, gate.inwards * normal);
      column.acceleration = dt > 0 ? (last[opening.axis] - first[opening.axis]) / dt : 0;
    }
  }
  find_members();
  std::vector<std::int32_t> count(columns_.size());
  for (const std::int32_t i : members_) {
    const std::int64_t c = (*column_)[i];
    ++count[static_cast<std::size_t>(c)];
    if (!gate_of(c).opening->inflow) continue;
    for (int axis = 0; axis < d; ++axis)
      (*particles_.velocity[axis])[i] = columns_[static_cast<std::size_t>(c)].velocity[axis];
  }
  stale_ = parallel_max(particles_.size(), 0.0,
                        [&](std::size_t i) { return (*column_)[i] < liquid_of_domain ? 1.0 : 0.0; }) > 0;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const OpenGate& gate = gates_.list[static_cast<std::size_t>(columns_[c].gate)];
    const bool wet = gate.columns[static_cast<std::size_t>(columns_[c].cell)].wet;
    stale_ = stale_ || (gate.opening->inflow && wet != (count[c] > 0));
  }
}

void BufferLayers::add_columns_of_inflows(std::vector<Newcomer>& newcomers) const {
  constexpr double none = -1;
  std::vector<double> deepest(columns_.size(), none);
  for (const std::int32_t member : members_) {
    const auto i = static_cast<std::size_t>(member), c = static_cast<std::size_t>((*column_)[i]);
    const double depth = gate_of((*column_)[i]).depth_behind(vector_at(particles_.position, particles_.dimensions, i));
    deepest[c] = std::max(deepest[c], depth);
  }
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const Column& column = columns_[c];
    const OpenGate& gate = gates_.list[static_cast<std::size_t>(column.gate)];
    const OpenGate::Column& cell = gate.columns[static_cast<std::size_t>(column.cell)];
    if (!gate.opening->inflow || !cell.wet) continue;
    double depth = deepest[c] == none ? -cell.layer / 2 : deepest[c];
    while (depth + cell.layer / 2 < reach_) {
      depth += cell.layer;
      Newcomer one{.column = static_cast<std::int64_t>(c),
                   .phase = static_cast<std::int64_t>(column.phase),
                   .place = cell.foot,
                   .velocity = column.velocity};
      one.place[gate.opening->axis] -= gate.inwards * depth;
      newcomers.push_back(one);
    }
  }
}

void BufferLayers::renew() {
  find_members();
  std::vector<Newcomer> newcomers;
  add_columns_of_inflows(newcomers);
  Array<std::int32_t> staying;
  const int d = particles_.dimensions;
  const auto stays = [&](std::size_t i) {
    if (!holds(i)) return true;
    const std::int64_t c = (*column_)[i];
    const OpenGate& gate = gate_of(c);
    if (gate.opening->inflow)
      return gate.columns[static_cast<std::size_t>(columns_[static_cast<std::size_t>(c)].cell)].wet;
    const Vec3 place = vector_at(particles_.position, d, i);
    return gate.depth_behind(place) <= gate.whole_layers(reach_) + gate.layer && gate.column_at(place) >= 0;
  };
  parallel_select(particles_.size(), staying, stays);
  parallel_select(particles_.size(), passed_, [&](std::size_t i) { return (*column_)[i] < liquid_of_domain; });
  for (const std::int32_t back : passed_) {
    const auto i = static_cast<std::size_t>(back);
    std::int64_t& c = (*column_)[i];
    c = returned(c);
    const OpenGate& gate = gate_of(c);
    Newcomer one{.source = i,
                 .column = c,
                 .phase = (*phase_)[i],
                 .place = vector_at(particles_.position, d, i),
                 .velocity = vector_at(particles_.velocity, d, i)};
    one.place[gate.opening->axis] -= gate.inwards * gate.whole_layers(reach_);
    newcomers.push_back(one);
    c = liquid_of_domain;
  }
  if (newcomers.empty() && staying.size() == particles_.size()) return;
  insert(staying, newcomers);
}

void BufferLayers::insert(const Array<std::int32_t>& staying, const std::vector<Newcomer>& newcomers) {
  const std::size_t before = particles_.size(), first = staying.size();
  Array<std::int32_t> order;
  order.resize(first + newcomers.size());
  std::copy_n(staying.data(), first, order.data());
  for (std::size_t k = 0; k < newcomers.size(); ++k) order[first + k] = static_cast<std::int32_t>(newcomers[k].source);
  if (before > 0)
    particles_.fields.permute(order);
  else
    particles_.fields.resize(order.size());
  // A newcomer has nothing else of the particle that it is a copy of.
  const auto carried = [&](const void* values) {
    return std::any_of(carried_.begin(), carried_.end(), [values](const auto* one) { return one == values; });
  };
  for (const auto& field : particles_.fields.fields())
    if (field->lifetime == Lifetime::state)
      std::visit(
          [&](auto& values) {
            if (!carried(&values)) std::fill(values.data() + first, values.data() + order.size(), 0);
          },
          field->values);
  for (std::size_t k = 0; k < newcomers.size(); ++k) {
    const Newcomer& one = newcomers[k];
    for (int axis = 0; axis < particles_.dimensions; ++axis) {
      (*particles_.position[axis])[first + k] = one.place[axis];
      (*particles_.velocity[axis])[first + k] = one.velocity[axis];
    }
    (*particles_.identifier)[first + k] = next_identifier_++;
    (*column_)[first + k] = one.column;
    (*phase_)[first + k] = one.phase;
  }
}

void BufferLayers::apply_walls(const Boundary& boundary, std::size_t i, Vec3& r, Vec3* u, const Vec3* from) const {
  if (!holds(i)) {
    boundary.hold_liquid(boundary.walls, r, u, from);
    return;
  }
  const OpenGate& gate = gate_of((*column_)[i]);
  const int axis = gate.opening->axis;
  const double along = r[axis];
  if (gate.opening->inflow) {
    r = vector_at(particles_.position, particles_.dimensions, i);
  } else {
    r[axis] = gate.plane + gate.inwards * scene_.spacing / 2;
    boundary.hold_liquid(boundary.walls, r, u);
  }
  r[axis] = along;
}

void BufferLayers::accept() {
  const int d = particles_.dimensions;
  parallel_select(particles_.size(), passed_, [&](std::size_t i) {
    const Vec3 place = vector_at(particles_.position, d, i);
    return holds(i) ? gate_of((*column_)[i]).depth_behind(place) < 0 : gates_.outflow_behind(place) >= 0;
  });
  for (const std::int32_t i : passed_) {
    std::int64_t& column = (*column_)[i];
    const auto phase = static_cast<std::size_t>((*phase_)[i]);
    if (column >= 0) {
      const bool enters = gate_of(column).opening->inflow;
      if (enters)
        ++entered_[phase];
      else
        --left_[phase];
      column = enters ? liquid_of_domain : returned(column);
      continue;
    }
    ++left_[phase];
    const Vec3 place = vector_at(particles_.position, d, static_cast<std::size_t>(i));
    const auto g = static_cast<std::size_t>(gates_.outflow_behind(place));
    // One that came back and leaves again needs no other in its place.
    column = static_cast<std::int64_t>(first_[g]) + gates_.list[g].column_at(place);
    for (const FloatVectorField& change : changes_)
      for (int axis = 0; axis < d; ++axis)
        if (change[axis] != nullptr) (*change[axis])[i] = 0;
  }
}

double BufferLayers::volume_inside(std::size_t phase) const {
  return particles_.volume * parallel_sum(particles_.size(), [&](std::size_t i) {
           return !holds(i) && static_cast<std::size_t>((*phase_)[i]) == phase ? 1.0 : 0.0;
         });
}

double BufferLayers::net_outflow(std::size_t phase) const {
  return particles_.volume * static_cast<double>(left_[phase] - entered_[phase]);
}

void BufferLayers::add_columns(SeriesTable& series) const {
  const std::string unit = particles_.dimensions == 3 ? "length^3" : "length^2";
  for (std::size_t n = 0; n < entered_.size(); ++n) {
    const std::string& name = scene_.phases[n].name;
    const std::string of = entered_.size() > 1 ? "_" + name : "";  // one liquid has the columns of other methods
    series.add("volume_" + name, unit + ", of its particles in the domain", [this, n] { return volume_inside(n); });
    series.add("volume_in" + of, unit + ", since the start",
               [this, n] { return particles_.volume * static_cast<double>(entered_[n]); });
    series.add("volume_out" + of, unit + ", since the start",
               [this, n] { return particles_.volume * static_cast<double>(left_[n]); });
  }
}

void BufferLayers::save(StateWriter& writer) const {
  std::vector<std::int64_t> counts{next_identifier_};
  counts.insert(counts.end(), entered_.begin(), entered_.end());
  counts.insert(counts.end(), left_.begin(), left_.end());
  writer.i64("open_counts", counts);
}

void BufferLayers::load(StateReader& reader) {
  Array<std::int64_t> counts;
  reader.i64("open_counts", counts);
  if (counts.size() != 1 + 2 * entered_.size()) throw FileError("the checkpoint is of a scene with other openings");
  next_identifier_ = counts[0];
  std::copy_n(counts.data() + 1, entered_.size(), entered_.begin());
  std::copy_n(counts.data() + 1 + entered_.size(), left_.size(), left_.begin());
}

double BufferLayers::bytes() const {
  double sum =
      static_cast<double>(columns_.capacity() * sizeof(Column)) + members_.bytes() + passed_.bytes() + before_.bytes();
  for (const OpenGate& gate : gates_.list)
    sum += static_cast<double>(gate.columns.capacity() * sizeof(OpenGate::Column) + 4 * gate.column_of.capacity());
  return sum;
}

}  // namespace spume
