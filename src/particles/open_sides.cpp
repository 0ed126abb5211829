// SPDX-License-Identifier: MIT
#include "spume/particles/open_sides.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/periodic_grid.hpp"
#include "spume/core/vectors.hpp"
#include "spume/operators/moving_least_squares.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/near_particles.hpp"

namespace spume {
namespace {

constexpr int fit_order = 2;

// Below this share of a full kernel sum, of the liquid and its reflection in the side, a point has no liquid before it:
// that of wall points (particles/body_walls.cpp).
constexpr double wet_share = 0.5;

}  // namespace

// An opening, cut into cells of about a spacing across: the cross-sections of its columns.
struct OpenSides::Gate {
  struct Column {
    Vec3 foot{};
    double travelled = 0, next = 0;  // since the last of its points passed the side, less half a layer
    bool wet = true;  // below the level, where it is looked at
  };
  const Opening* opening = nullptr;
  double plane = 0, inwards = 1;
  std::array<int, 2> across{0, -1};  // axes on the side
  std::array<std::size_t, 2> cells{1, 1};
  std::array<double, 2> lower{}, size{1, 1};
  std::vector<std::int32_t> column_of;  // of a cell, -1: closed
  std::vector<Column> columns;
  double area = 0;   // of a column
  double layer = 0;  // distance of the points of a column
  int layers = 0;

  // Marks the columns below the level at time t, and counts them.
  std::size_t find_wet(int up, double t) {
    const double level = opening->level ? (*opening->level)(0, 0, 0, t) : std::numeric_limits<double>::infinity();
    std::size_t wet = 0;
    for (Column& column : columns) {
      column.wet = column.foot[up] < level;
      wet += column.wet ? 1 : 0;
    }
    return wet;
  }

  // -1: none.
  std::int32_t column_at(const Vec3& place) const {
    std::array<std::size_t, 2> at{};
    for (std::size_t k = 0; k < 2; ++k) {
      if (across[k] < 0) continue;
      const double cell = (place[across[k]] - lower[k]) / size[k];
      if (!(cell >= 0 && cell < static_cast<double>(cells[k]))) return -1;
      at[k] = static_cast<std::size_t>(cell);
    }
    return column_of[at[1] * cells[0] + at[0]];
  }
};

// Stencils of a block of points.
struct OpenSides::Fits {
  std::vector<std::int32_t> source, entries, nearest;
  std::vector<double> coefficient;
};

OpenSides::OpenSides(const Scene& scene, const Resolution& resolution, double particle_volume)
    : scene_(scene), resolution_(resolution), particle_volume_(particle_volume) {
  const Domain& domain = scene.domain;
  const int d = domain.dimensions;
  for (const Opening& opening : scene.openings) {
    Gate gate;
    gate.opening = &opening;
    gate.plane = opening.side == 0 ? domain.lower[opening.axis] : domain.upper[opening.axis];
    gate.inwards = opening.side == 0 ? 1 : -1;
    gate.area = 1;
    std::size_t k = 0;
    for (int axis = 0; axis < d; ++axis) {
      if (axis == opening.axis) continue;
      const double length = opening.upper[axis] - opening.lower[axis];
      gate.across[k] = axis;
      gate.lower[k] = opening.lower[axis];
      gate.cells[k] = static_cast<std::size_t>(std::max(1.0, std::round(length / scene.spacing)));
      gate.size[k] = length / static_cast<double>(gate.cells[k]);
      gate.area *= gate.size[k++];
    }
    gate.layer = particle_volume / gate.area;
    gate.layers = static_cast<int>(std::ceil(resolution.support_radius / gate.layer)) + 1;
    gate.column_of.assign(gate.cells[0] * gate.cells[1], -1);
    for (std::size_t cell = 0; cell < gate.column_of.size(); ++cell) {
      Gate::Column column;
      column.foot[opening.axis] = gate.plane;
      const std::array<std::size_t, 2> at{cell % gate.cells[0], cell / gate.cells[0]};
      for (std::size_t a = 0; a < 2; ++a)
        if (gate.across[a] >= 0)
          column.foot[gate.across[a]] = gate.lower[a] + (static_cast<double>(at[a]) + 0.5) * gate.size[a];
      const Vec3& foot = column.foot;
      if (opening.where && !((*opening.where)(foot[0], foot[1], foot[2], 0) > 0)) continue;
      if (inside_solid(domain, foot)) continue;
      if (!scene.walls.empty() && !(scene.walls.distance(foot) > 0)) continue;
      gate.column_of[cell] = static_cast<std::int32_t>(gate.columns.size());
      gate.columns.push_back(column);
    }
    gates_.push_back(std::move(gate));
  }
  // Behind an outflow stands what mirrors the liquid before it.
  const InitialParticles& initial = scene.particles;
  next_identifier_ = static_cast<std::int64_t>(initial.size());
  for (std::size_t g = 0; g < gates_.size(); ++g) {
    const Gate& gate = gates_[g];
    if (gate.opening->inflow) continue;
    for (std::size_t i = 0; i < initial.size(); ++i) {
      Drifting one;
      one.gate = static_cast<std::int32_t>(g);
      for (int axis = 0; axis < d; ++axis) {
        one.place[axis] = initial.position[axis][i];
        one.velocity[axis] = initial.velocity[axis][i];
      }
      double& x = one.place[gate.opening->axis];
      if (gate.inwards * (x - gate.plane) > resolution.support_radius + gate.layer || gate.column_at(one.place) < 0)
        continue;
      x = 2 * gate.plane - x;
      one.next = one.place;
      drifting_.push_back(one);
    }
  }
}

OpenSides::~OpenSides() = default;

int OpenSides::opening_at(int axis, int side, const Vec3& place) const {
  for (std::size_t g = 0; g < gates_.size(); ++g) {
    const Opening& opening = *gates_[g].opening;
    if (opening.axis == axis && opening.side == side && gates_[g].column_at(place) >= 0) return static_cast<int>(g);
  }
  return -1;
}

bool OpenSides::outflow_at(int axis, int side, const Vec3& place) const {
  const int g = opening_at(axis, side, place);
  return g >= 0 && !gates_[static_cast<std::size_t>(g)].opening->inflow;
}

double OpenSides::depth_behind(const Gate& gate, const Vec3& place) const {
  return gate.inwards * (gate.plane - place[gate.opening->axis]);
}

namespace {

double value_at(const Expression& expression, const Vec3& r, double t) {
  return expression(r[0], r[1], r[2], t);
}

[[noreturn]] void refuse(const Opening& opening, const char* what, double value) {
  StepFailure::Details details;
  details.cause = std::string(what) + " is not a finite number";
  details.option = opening.name;
  details.value = value;
  throw StepFailure(details);
}

// What an inflow gives at a time.
struct Entering {
  Entering(const Opening& opening, double columns_area, std::size_t wet_columns, double t)
      : opening_(opening), t_(t) {
    if (!opening.flow_rate) return;
    const double rate = value_at(*opening.flow_rate, {}, t);
    if (!std::isfinite(rate)) refuse(opening, "the flow rate of an inflow", rate);
    speed_ = wet_columns > 0 ? rate / (static_cast<double>(wet_columns) * columns_area) : 0;
  }
  Vec3 velocity(const Vec3& foot) const {
    Vec3 u{};
    if (opening_.velocity)
      u = (*opening_.velocity)(foot, t_);
    else
      u[opening_.axis] = opening_.side == 0 ? speed_ : -speed_;
    if (!std::isfinite(u[0] + u[1] + u[2])) refuse(opening_, "the velocity of an inflow", length(u));
    return u;
  }

 private:
  const Opening& opening_;
  double t_, speed_ = 0;
};

}  // namespace

void OpenSides::advance(double t, double dt) {
  step_ = dt;
  for (Gate& gate : gates_) {
    const Opening& opening = *gate.opening;
    if (!opening.inflow) continue;
    const std::size_t wet = gate.find_wet(scene_.domain.dimensions - 1, t + dt);
    // Simpson's rule in time, as for moving walls.
    const Entering before(opening, gate.area, wet, t), middle(opening, gate.area, wet, t + dt / 2),
        after(opening, gate.area, wet, t + dt);
    for (Gate::Column& column : gate.columns) {
      column.next = column.travelled;
      if (!column.wet) continue;
      const auto speed = [&](const Entering& at) { return gate.inwards * at.velocity(column.foot)[opening.axis]; };
      column.next += std::max(0.0, (speed(before) + 4 * speed(middle) + speed(after)) / 6) * dt;
    }
  }
  const Domain& domain = scene_.domain;
  for (Drifting& one : drifting_) {
    const Gate& gate = gates_[static_cast<std::size_t>(one.gate)];
    one.next = add(one.place, multiply(dt, one.velocity));
    for (int axis = 0; axis < domain.dimensions; ++axis) {
      if (axis == gate.opening->axis) continue;
      double& x = one.next[axis];
      const double lower = domain.lower[axis], upper = domain.upper[axis];
      if (domain.periodic(axis))
        x = wrap_periodic(x, lower, upper - lower);
      else if (x < lower && domain.sides[axis][0].kind != BoundaryKind::open)
        x = 2 * lower - x;
      else if (x > upper && domain.sides[axis][1].kind != BoundaryKind::open)
        x = 2 * upper - x;
    }
  }
}

void OpenSides::accept() {
  for (Gate& gate : gates_)
    for (Gate::Column& column : gate.columns) column.travelled = column.next;
  for (Drifting& one : drifting_) one.place = one.next;
}

bool OpenSides::exchange(ParticleStore& particles, double t) {
  const int d = particles.dimensions;
  const std::size_t n = particles.size();
  // Particles beyond an outflow.
  Array<std::int32_t> gone;
  const auto gate_of = [&](std::size_t i) {
    const Vec3 r = vector_at(particles.position, d, i);
    for (std::size_t g = 0; g < gates_.size(); ++g)
      if (!gates_[g].opening->inflow && depth_behind(gates_[g], r) > 0 && gates_[g].column_at(r) >= 0)
        return static_cast<std::int32_t>(g);
    return -1;
  };
  parallel_select(n, gone, [&](std::size_t i) { return gate_of(i) >= 0; });
  struct Newcomer {
    Vec3 place, velocity;
  };
  std::vector<Newcomer> newcomers;
  for (Gate& gate : gates_) {
    const Opening& opening = *gate.opening;
    if (!opening.inflow) continue;
    const std::size_t wet = gate.find_wet(d - 1, t);
    std::unique_ptr<Entering> entering;
    for (Gate::Column& column : gate.columns)
      for (; column.travelled > 0.5 * gate.layer; column.travelled -= gate.layer) {
        if (entering == nullptr) entering = std::make_unique<Entering>(opening, gate.area, wet, t);
        Newcomer one{column.foot, entering->velocity(column.foot)};
        one.place[opening.axis] += gate.inwards * (column.travelled - 0.5 * gate.layer);
        newcomers.push_back(one);
        ++entered_;
      }
  }
  const std::size_t drifting = drifting_.size();
  std::size_t kept = 0;
  std::vector<Drifting> behind;
  for (std::size_t k = 0; k < drifting; ++k) {
    Drifting one = drifting_[k];
    const Gate& gate = gates_[static_cast<std::size_t>(one.gate)];
    const double depth = depth_behind(gate, one.place), reach = resolution_.support_radius + gate.layer;
    if (depth > reach || gate.column_at(one.place) < 0) continue;
    if (depth < 0) {
      newcomers.push_back({one.place, one.velocity});
      --left_;
      one.place[gate.opening->axis] -= gate.inwards * std::ceil(reach / gate.layer) * gate.layer;
      behind.push_back(one);
      continue;
    }
    drifting_[kept++] = one;
  }
  drifting_.resize(kept);
  drifting_.insert(drifting_.end(), behind.begin(), behind.end());
  for (const std::int32_t i : gone) {
    const auto k = static_cast<std::size_t>(i);
    Drifting one;
    one.gate = gate_of(k);
    one.place = vector_at(particles.position, d, k);
    one.velocity = vector_at(particles.velocity, d, k);
    one.next = one.place;
    drifting_.push_back(one);
    ++left_;
  }
  if (gone.empty() && newcomers.empty()) return false;
  // Of each newcomer the nearest of the particles that stay.
  Array<std::int32_t> order;
  parallel_select(n, order, [&](std::size_t i) { return gate_of(i) < 0; });
  const std::size_t staying = order.size();
  if (staying == 0) return false;
  order.resize(staying + newcomers.size());
  const auto r = read(particles.position);
  parallel_blocks_dynamic(newcomers.size(), 1, [&](std::size_t k, std::size_t, std::size_t) {
    double nearest2 = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < staying; ++i) {
      double distance2 = 0;
      for (int axis = 0; axis < d; ++axis) {
        const double x = r[axis][order[i]] - newcomers[k].place[axis];
        distance2 += x * x;
      }
      if (distance2 >= nearest2) continue;
      nearest2 = distance2;
      order[staying + k] = order[i];
    }
  });
  particles.fields.permute(order);
  for (std::size_t k = 0; k < newcomers.size(); ++k) {
    for (int axis = 0; axis < d; ++axis) {
      (*particles.position[axis])[staying + k] = newcomers[k].place[axis];
      (*particles.velocity[axis])[staying + k] = newcomers[k].velocity[axis];
    }
    (*particles.identifier)[staying + k] = next_identifier_++;
  }
  return true;
}

void OpenSides::list_points(double t) {
  points_.clear();
  const auto add_point = [&](std::size_t g, const Vec3& place, const Vec3& velocity, std::int32_t number) {
    const Gate& gate = gates_[g];
    Point point{place, place, place, static_cast<std::int32_t>(g), number, velocity, {}};
    point.foot[gate.opening->axis] = gate.plane;
    point.mirror[gate.opening->axis] = gate.plane + gate.inwards * std::abs(depth_behind(gate, place));
    points_.push_back(point);
  };
  for (std::size_t g = 0; g < gates_.size(); ++g) {
    Gate& gate = gates_[g];
    if (!gate.opening->inflow) continue;
    const std::size_t wet = gate.find_wet(scene_.domain.dimensions - 1, t);
    const Entering entering(*gate.opening, gate.area, wet, t), last(*gate.opening, gate.area, wet, t - step_);
    for (const Gate::Column& column : gate.columns) {
      if (!column.wet) continue;
      const Vec3 velocity = entering.velocity(column.foot);
      Vec3 acceleration{};
      if (step_ > 0) acceleration = multiply(1 / step_, subtract(velocity, last.velocity(column.foot)));
      for (int layer = 0; layer < gate.layers; ++layer) {
        Vec3 place = column.foot;
        place[gate.opening->axis] -= gate.inwards * ((layer + 0.5) * gate.layer - column.next);
        add_point(g, place, velocity, -1);
        points_.back().acceleration = acceleration;
      }
    }
  }
  for (std::size_t k = 0; k < drifting_.size(); ++k)
    add_point(static_cast<std::size_t>(drifting_[k].gate), drifting_[k].next, drifting_[k].velocity,
              static_cast<std::int32_t>(k));
}

template <int dimensions>
void OpenSides::fit(const Arrangement& arrangement, const VectorField& at, std::size_t first, std::size_t last,
                    Fits& fits) const {
  const auto r = read(at);
  const double h = resolution_.smoothing_length, reach = fit_reach * resolution_.support_radius;
  MovingLeastSquares<dimensions> fit;
  struct Near {
    std::int32_t particle;
    Vec3 offset;
    double r2;
  };
  std::vector<Near> near;
  for (std::size_t k = first; k < last; ++k) {
    const Point& point = points_[k];
    const Gate& gate = gates_[static_cast<std::size_t>(point.gate)];
    const double above = gate.inwards * (point.mirror[gate.opening->axis] - gate.plane);
    near.clear();
    double kernel_sum = 0, nearest2 = std::numeric_limits<double>::infinity();
    std::int32_t nearest = 0;
    with_plain_kernel(dimensions, resolution_.kernel, [&]<int d, class Kernel>() {
      const double scale = particle_volume_ * Kernel::normalisation(d) / std::pow(h, d);
      visit_near(scene_.domain, arrangement.grid, arrangement.table, point.mirror, reach,
                 [&](std::int32_t j, const Vec3& shift) {
                   Vec3 offset{};
                   double r2 = 0;
                   for (int axis = 0; axis < d; ++axis) {
                     offset[axis] = r[axis][j] + shift[axis] - point.mirror[axis];
                     r2 += offset[axis] * offset[axis];
                   }
                   if (r2 < nearest2) {
                     nearest2 = r2;
                     nearest = j;
                   }
                   if (r2 >= reach * reach) return;
                   const double height = gate.inwards * offset[gate.opening->axis] + above;
                   const double mirrored2 = r2 + 4 * std::max(0.0, height) * above;
                   kernel_sum += scale * (Kernel::w(std::sqrt(r2) / h) + Kernel::w(std::sqrt(mirrored2) / h));
                   near.push_back({j, offset, r2});
                 });
    });
    fit.resize(near.size());
    for (std::size_t j = 0; j < near.size(); ++j) {
      for (int axis = 0; axis < dimensions; ++axis) fit.offset(axis)[j] = near[j].offset[axis] / h;
      fit.weight()[j] = WendlandC2::w(WendlandC2::support * std::sqrt(near[j].r2) / reach);
    }
    const bool wet = kernel_sum >= wet_share && fit.fit(fit_order) >= 0;
    fits.nearest.push_back(nearest);
    fits.entries.push_back(wet ? static_cast<std::int32_t>(near.size()) : 0);
    if (!wet) continue;
    const auto coefficient = fit.value();
    double sum = 0;
    for (const double c : coefficient) sum += c;
    for (std::size_t j = 0; j < near.size(); ++j) {
      fits.source.push_back(near[j].particle);
      fits.coefficient.push_back(coefficient[j] / sum);
    }
  }
}

void OpenSides::find_stencils(const Arrangement& arrangement, const VectorField& at, double t, WallStencils& stencils,
                              std::array<Array<double>, 3>& position) {
  list_points(t);
  constexpr std::size_t size = 128;
  const int d = scene_.domain.dimensions;
  const std::size_t n = points_.size();
  std::vector<Fits> blocks(block_count(n, size));
  parallel_blocks_dynamic(n, size, [&](std::size_t b, std::size_t first, std::size_t last) {
    if (d == 3)
      fit<3>(arrangement, at, first, last, blocks[b]);
    else
      fit<2>(arrangement, at, first, last, blocks[b]);
  });
  first_point_ = stencils.size();
  const std::size_t before = first_point_, all = before + n;
  std::vector<std::size_t> entry(blocks.size() + 1, stencils.source.size());
  for (std::size_t b = 0; b < blocks.size(); ++b) entry[b + 1] = entry[b] + blocks[b].source.size();
  stencils.first.resize(all + 1);
  stencils.nearest.resize(all);
  stencils.no_slip.resize(all);
  stencils.kind.resize(all);
  stencils.pressure_sign.resize(all);
  stencils.given_pressure.resize(all);
  for (std::size_t g = 0; g < before; ++g) {
    stencils.kind[g] = PointKind::wall;
    stencils.pressure_sign[g] = 1;
    stencils.given_pressure[g] = 0;
  }
  for (int axis = 0; axis < d; ++axis) {
    position[axis].resize(all);
    stencils.normal[axis].resize(all);
    stencils.wall_velocity[axis].resize(all);
    stencils.predicted[axis].resize(all);
  }
  stencils.source.resize(entry.back());
  stencils.coefficient.resize(entry.back());
  stencils.first[all] = static_cast<std::int64_t>(entry.back());
  parallel_blocks(blocks.size(), 1, [&](std::size_t b, std::size_t, std::size_t) {
    const Fits& fits = blocks[b];
    auto next = static_cast<std::int64_t>(entry[b]);
    std::copy(fits.source.begin(), fits.source.end(), stencils.source.data() + next);
    std::copy(fits.coefficient.begin(), fits.coefficient.end(), stencils.coefficient.data() + next);
    for (std::size_t k = 0; k < fits.nearest.size(); ++k) {
      const std::size_t p = b * size + k, g = before + p;
      const Point& point = points_[p];
      const Gate& gate = gates_[static_cast<std::size_t>(point.gate)];
      const bool inflow = gate.opening->inflow, wet = fits.entries[k] > 0;
      stencils.first[g] = next;
      next += fits.entries[k];
      stencils.nearest[g] = fits.nearest[k];
      stencils.no_slip[g] = 0;
      // What has left without liquid behind it keeps its velocity.
      stencils.kind[g] = inflow || !wet ? PointKind::inflow : PointKind::outflow;
      stencils.pressure_sign[g] = !wet ? 0.0F : inflow ? 1.0F : -1.0F;
      stencils.given_pressure[g] = 0;
      for (int axis = 0; axis < d; ++axis) {
        position[axis][g] = point.place[axis];
        stencils.normal[axis][g] = axis == gate.opening->axis ? static_cast<float>(gate.inwards) : 0.0F;
        stencils.wall_velocity[axis][g] = static_cast<float>(point.velocity[axis]);
      }
    }
  });
  double speed2 = 0;
  for (const Point& point : points_) speed2 = std::max(speed2, dot(point.velocity, point.velocity));
  largest_speed_ = std::sqrt(speed2);
}

void OpenSides::give_gradients(const std::array<const double*, 3>& before, const std::array<const double*, 3>& after,
                               double dt, WallStencils& stencils) const {
  const int d = scene_.domain.dimensions;
  parallel_for(points_.size(), [&](std::size_t p) {
    const Point& point = points_[p];
    const Gate& gate = gates_[static_cast<std::size_t>(point.gate)];
    const std::size_t g = first_point_ + p;
    for (int axis = 0; axis < d; ++axis) stencils.predicted[axis][g] = 0;
    if (!gate.opening->inflow || stencils.pressure_sign[g] == 0) return;
    const auto axis = static_cast<std::size_t>(gate.opening->axis);
    const double change =
        stencils.mirrored(g, after[axis]) - (before[axis] == nullptr ? 0.0 : stencils.mirrored(g, before[axis]));
    const double gradient = change / dt - point.acceleration[axis];
    stencils.predicted[axis][g] = static_cast<float>(dt * gradient);
    stencils.given_pressure[g] = (point.place[axis] - point.mirror[axis]) * gradient;
  });
}

void OpenSides::give_pressures(const std::function<double(const Vec3&)>& potential, double t,
                               WallStencils& stencils) const {
  const Fluid& fluid = scene_.fluid;
  const int up = scene_.domain.dimensions - 1;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const Point& point = points_[p];
    const Opening& opening = *gates_[static_cast<std::size_t>(point.gate)].opening;
    const std::size_t g = first_point_ + p;
    const bool wet = stencils.pressure_sign[g] != 0;
    if (wet && opening.inflow) continue;
    double pressure = 0;
    if (opening.pressure) pressure = value_at(*opening.pressure, point.foot, t);
    if (opening.level && !opening.inflow)
      pressure += fluid.density * -fluid.gravity[up] * std::max(0.0, value_at(*opening.level, {}, t) - point.foot[up]);
    if (!std::isfinite(pressure)) refuse(opening, "the pressure of an outflow", pressure);
    const double q = pressure / fluid.density + potential(wet ? point.foot : point.place);
    stencils.given_pressure[g] = wet ? 2 * q : q;
  }
}

void OpenSides::follow(const WallStencils& stencils, const std::array<const double*, 3>& velocity) {
  const int d = scene_.domain.dimensions;
  parallel_for(points_.size(), [&](std::size_t p) {
    const std::int32_t k = points_[p].drifting;
    const std::size_t g = first_point_ + p;
    if (k < 0 || stencils.kind[g] != PointKind::outflow) return;
    for (int axis = 0; axis < d; ++axis)
      drifting_[static_cast<std::size_t>(k)].velocity[axis] = stencils.mirrored(g, velocity[axis]);
  });
}

void OpenSides::save(StateWriter& writer) const {
  std::vector<double> travelled, place;
  std::vector<std::int64_t> gate{entered_, left_, next_identifier_};
  for (const Gate& one : gates_)
    for (const Gate::Column& column : one.columns) travelled.push_back(column.travelled);
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
  for (const Gate& one : gates_) columns += one.columns.size();
  if (travelled.size() != columns || place.size() % 6 != 0 || gate.size() != 3 + place.size() / 6)
    throw FileError("the checkpoint is of a scene with other openings");
  entered_ = gate[0];
  left_ = gate[1];
  next_identifier_ = gate[2];
  std::size_t k = 0;
  for (Gate& one : gates_)
    for (Gate::Column& column : one.columns) column.travelled = column.next = travelled[k++];
  drifting_.resize(place.size() / 6);
  for (std::size_t p = 0; p < drifting_.size(); ++p) {
    Drifting& one = drifting_[p];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      one.place[axis] = one.next[axis] = place[6 * p + axis];
      one.velocity[axis] = place[6 * p + 3 + axis];
    }
    one.gate = static_cast<std::int32_t>(gate[3 + p]);
  }
}

double OpenSides::bytes() const {
  double sum = static_cast<double>(drifting_.capacity() * sizeof(Drifting) + points_.capacity() * sizeof(Point));
  for (const Gate& gate : gates_)
    sum += static_cast<double>(gate.columns.capacity() * sizeof(Gate::Column) + 4 * gate.column_of.capacity());
  return sum;
}

}  // namespace spume
