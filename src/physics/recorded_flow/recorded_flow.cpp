// SPDX-License-Identifier: MIT
#include "spume/physics/recorded_flow/recorded_flow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/scene/expression.hpp"
#include "spume/scene/option.hpp"

namespace spume {
namespace {

constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
// Of the stationary volumes: the largest change of one by a step of the chain, over the mean.
constexpr double stationary = 1e-14;
constexpr int most_steps_of_chain = 200000;
// Of the mean volume: a cell with less is left and not entered again.
constexpr double least_volume = 1e-6;

// Makes sum(weight * value) that amount: by a factor, which keeps the sign of values that have one sign, else by a sum,
// as parts of both signs may cancel. Values that are all the same stay so.
void match(std::vector<double>& values, const std::vector<double>& weights, double amount) {
  double held = 0, all = 0, least = 0, largest = 0;
  for (std::size_t a = 0; a < values.size(); ++a) {
    held += weights[a] * values[a];
    all += weights[a];
    least = std::min(least, values[a]);
    largest = std::max(largest, values[a]);
  }
  if (least < 0 && largest > 0)
    for (double& value : values) value += (amount - held) / all;
  else if (held != 0)
    for (double& value : values) value *= amount / held;
}

}  // namespace

double RecordedFlow::cells_along(double length, double longest_side) {
  return std::max(1.0, std::ceil(length / longest_side * (1 - 1e-9)));
}

RecordedFlow::RecordedFlow(ParticleStore& particles, const Scene& scene, const RecordedFlowOptions& options,
                           Scalars& scalars, oxygen::Oxygen* oxygen, biokinetics::Sludge* sludge)
    : particles_(particles),
      scene_(scene),
      start_(*options.from),
      end_(*options.until),
      lag_(*options.lag),
      scalars_(scalars),
      oxygen_(oxygen),
      sludge_(sludge),
      dimensions_(scene.domain.dimensions),
      values_(scalars.size()) {
  std::size_t cells = 1;
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions_); ++a) {
    const double length = scene.domain.upper[a] - scene.domain.lower[a];
    count_[a] = static_cast<std::size_t>(cells_along(length, *options.cell));
    side_[a] = length / static_cast<double>(count_[a]);
    cells *= count_[a];
  }
  counts_ = Array<double>(cells * cells, 0.0);
  conductance_ = Array<double>(cells, 0.0);
  capacity_ = Array<double>(cells, 0.0);
  marked_ = &particles.fields.add<std::int64_t>("recorded_cell", Lifetime::state);
  marked_->fill(0);
  if (oxygen_ != nullptr) oxygen_->keep_surface_conductance();
}

double RecordedFlow::step(double t, double dt) const {
  if (complete_) return std::numeric_limits<double>::max();
  const double next = next_mark_ < 0 ? start_ : next_mark_, left = next - t;
  if (left <= slack * lag_ || left >= 2 * dt) return dt;
  return left <= dt ? left : left / 2;
}

std::size_t RecordedFlow::cell_at(const Vec3& place) const {
  std::size_t cell = 0;
  for (int axis = dimensions_ - 1; axis >= 0; --axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double lower = scene_.domain.lower[a];
    const double x = scene_.domain.inside(axis, place[a]);
    const auto last = static_cast<double>(count_[a] - 1);
    cell = cell * count_[a] + static_cast<std::size_t>(std::clamp(std::floor((x - lower) / side_[a]), 0.0, last));
  }
  return cell;
}

std::size_t RecordedFlow::cell_of(std::size_t i) const {
  return cell_at(vector_at(particles_.position, dimensions_, i));
}

Vec3 RecordedFlow::centre(std::size_t cell) const {
  Vec3 r{};
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions_); ++a) {
    r[a] = scene_.domain.lower[a] + (static_cast<double>(cell % count_[a]) + 0.5) * side_[a];
    cell /= count_[a];
  }
  return r;
}

// Around periodic sides too.
double RecordedFlow::distance_between(const Vec3& a, const Vec3& b) const {
  Vec3 way = subtract(a, b);
  for (int axis = 0; axis < dimensions_; ++axis) {
    const double period = scene_.domain.upper[axis] - scene_.domain.lower[axis];
    if (scene_.domain.periodic(axis)) way[axis] -= period * std::round(way[axis] / period);
  }
  return length(way);
}

void RecordedFlow::mark() {
  parallel_for(particles_.size(), [&](std::size_t i) { (*marked_)[i] = static_cast<std::int64_t>(cell_of(i)); });
}

// Once a lag: not worth threads.
void RecordedFlow::count() {
  const std::size_t cells = conductance_.size();
  for (std::size_t i = 0; i < particles_.size(); ++i)
    counts_[static_cast<std::size_t>((*marked_)[i]) * cells + cell_of(i)] += 1;
  ++windows_;
}

void RecordedFlow::record_supply(double dt, const oxygen::Supply* bubbles) {
  if (oxygen_ == nullptr) return;
  elapsed_ += dt;
  if (bubbles != nullptr)
    bubbles->each([&](const Vec3& place, double conductance, double capacity) {
      const std::size_t cell = cell_at(place);
      conductance_[cell] += conductance * dt;
      capacity_[cell] += capacity * dt;
    });
  const Array<float>& surface = oxygen_->surface_conductance();
  if (surface.empty()) return;
  const double saturation = oxygen_->gas().saturation_below_air();
  const auto add = [&](std::vector<double> sums, const std::vector<double>& part) {
    for (std::size_t cell = 0; cell < sums.size(); ++cell) sums[cell] += part[cell];
    return sums;
  };
  const std::size_t cells = conductance_.size();
  const std::vector<double> sums = parallel_reduce(
      particles_.size(), std::vector<double>(cells, 0.0),
      [&](std::size_t first, std::size_t last) {
        std::vector<double> part(cells, 0.0);
        for (std::size_t i = first; i < last; ++i)
          if (const double conductance = surface[i]; conductance > 0) part[cell_of(i)] += conductance;
        return part;
      },
      add);
  for (std::size_t cell = 0; cell < cells; ++cell) {
    conductance_[cell] += sums[cell] * dt;
    capacity_[cell] += sums[cell] * saturation * dt;
  }
}

void RecordedFlow::record(double t, double dt, const oxygen::Supply* bubbles) {
  if (!records(t)) return;
  if (next_mark_ < 0) {
    mark();
    next_mark_ = start_ + lag_;
    return;
  }
  record_supply(dt, bubbles);
  if (t < next_mark_ - slack * lag_) return;
  count();
  mark();
  next_mark_ += lag_;
  if (t < end_ - slack * lag_) return;
  complete();
  read_particles();
}

// Those with liquid at the start and at the end of some lag, whose liquid may come back: others are left out, with what
// goes there.
std::vector<std::size_t> RecordedFlow::cells_that_last() const {
  const std::size_t cells = conductance_.size();
  std::vector<bool> lasts(cells, true);
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t a = 0; a < cells; ++a) {
      if (!lasts[a]) continue;
      double out = 0, in = 0;
      for (std::size_t b = 0; b < cells; ++b) {
        if (!lasts[b]) continue;
        out += counts_[a * cells + b];
        in += counts_[b * cells + a];
      }
      if (out > 0 && in > 0) continue;
      lasts[a] = false;
      changed = true;
    }
  }
  std::vector<std::size_t> kept;
  for (std::size_t a = 0; a < cells; ++a)
    if (lasts[a]) kept.push_back(a);
  return kept;
}

// The stationary volumes of the chain between these cells, over their mean.
void RecordedFlow::find_volumes(const std::vector<std::size_t>& kept) {
  const std::size_t cells = conductance_.size(), n = kept.size();
  first_.assign(1, 0);
  from_.clear();
  share_.clear();
  std::vector<double> out(n, 0.0);
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b) out[a] += counts_[kept[a] * cells + kept[b]];
  for (std::size_t b = 0; b < n; ++b) {
    for (std::size_t a = 0; a < n; ++a)
      if (const double moved = counts_[kept[a] * cells + kept[b]]; moved > 0) {
        from_.push_back(a);
        share_.push_back(moved / out[a]);
      }
    first_.push_back(from_.size());
  }
  // Begun with the liquid that each cell held on average.
  const double all = static_cast<double>(n) / std::max(1.0, std::accumulate(out.begin(), out.end(), 0.0));
  volume_.assign(n, 0.0);
  for (std::size_t a = 0; a < n; ++a) volume_[a] = out[a] * all;
  next_.assign(n, 0.0);
  for (int step = 0; step < most_steps_of_chain; ++step) {
    double change = 0, sum = 0;
    for (std::size_t b = 0; b < n; ++b) {
      double in = 0;
      for (std::size_t k = first_[b]; k < first_[b + 1]; ++k) in += share_[k] * volume_[from_[k]];
      next_[b] = in;
      sum += in;
    }
    for (std::size_t b = 0; b < n; ++b) {
      next_[b] *= static_cast<double>(n) / sum;
      change = std::max(change, std::abs(next_[b] - volume_[b]));
    }
    volume_.swap(next_);
    if (change < stationary) break;
  }
}

void RecordedFlow::complete() {
  std::vector<std::size_t> kept = cells_that_last();
  for (bool transient = true; transient && !kept.empty();) {
    find_volumes(kept);
    std::vector<std::size_t> full;
    for (std::size_t a = 0; a < kept.size(); ++a)
      if (volume_[a] > least_volume) full.push_back(kept[a]);
    transient = full.size() < kept.size();
    kept.swap(full);
  }
  if (kept.empty()) throw FileError("the record of the flow holds no cell to which liquid comes back");
  const std::size_t n = kept.size();
  const double each = scalars_.liquid_volume() / static_cast<double>(n);
  for (double& v : volume_) v *= each;
  for (std::size_t b = 0; b < n; ++b) {
    // Shares of what is in the cell: their sum, one to the rounding of the volumes, is made one.
    double sum = 0;
    for (std::size_t k = first_[b]; k < first_[b + 1]; ++k) sum += share_[k] *= volume_[from_[k]] / volume_[b];
    for (std::size_t k = first_[b]; k < first_[b + 1]; ++k) share_[k] /= sum;
  }
  k_.assign(n, 0.0);
  g_.assign(n, 0.0);
  std::vector<std::size_t> number(conductance_.size(), none);
  for (std::size_t a = 0; a < n; ++a) number[kept[a]] = a;
  // Cells that are left out hand on what they have to the nearest that is not.
  for (std::size_t cell = 0; cell < number.size(); ++cell) {
    if (number[cell] == none) {
      double least = std::numeric_limits<double>::infinity();
      const Vec3 here = centre(cell);
      for (std::size_t a = 0; a < n; ++a)
        if (const double way = distance_between(centre(kept[a]), here); way < least) {
          least = way;
          number[cell] = a;
        }
    }
    k_[number[cell]] += conductance_[cell] / std::max(elapsed_, 1e-300) / volume_[number[cell]];
    g_[number[cell]] += capacity_[cell] / std::max(elapsed_, 1e-300) / volume_[number[cell]];
  }
  place_.resize(particles_.size());
  particles_in_.assign(n, 0.0);
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    place_[i] = number[cell_of(i)];
    particles_in_[place_[i]] += 1;
  }
  next_.assign(n, 0.0);
  complete_ = true;
}

// Means of the particles in each cell, of the amount that the particles have.
void RecordedFlow::read_particles() {
  for (std::size_t s = 0; s < scalars_.size(); ++s) {
    const double amount = scalars_.amount(s);
    std::vector<double>& values = values_[s];
    values.assign(cells(), 0.0);
    for (std::size_t i = 0; i < place_.size(); ++i) values[place_[i]] += scalars_.values(s)[i];
    for (std::size_t a = 0; a < cells(); ++a)
      values[a] = particles_in_[a] > 0 ? values[a] / particles_in_[a] : amount / scalars_.liquid_volume();
    match(values, volume_, amount);
  }
}

double RecordedFlow::amount(std::size_t scalar) const {
  return std::inner_product(volume_.begin(), volume_.end(), values_[scalar].begin(), 0.0);
}

// Those of their cells, of the amount that the cells have.
void RecordedFlow::write_particles() {
  for (std::size_t s = 0; s < scalars_.size(); ++s) {
    std::vector<double> values = values_[s];
    match(values, particles_in_, amount(s) / particles_.volume);
    double* out = scalars_.values(s).data();
    parallel_for(place_.size(), [&](std::size_t i) { out[i] = values[place_[i]]; });
  }
}

// Each cell gains the mean source of the places of its particles, or that of the mean of all.
void RecordedFlow::add_sources(double t) {
  for (std::size_t s = 0; s < scalars_.size(); ++s) {
    const ScalarOption& option = scalars_.option(s);
    if (option.source == nullptr) continue;
    std::fill(next_.begin(), next_.end(), 0.0);
    double all = 0;
    for (std::size_t i = 0; i < place_.size(); ++i) {
      const Vec3 r = vector_at(particles_.position, dimensions_, i);
      const double rate = (*option.source)(r[0], r[1], r[2], t + lag_ / 2);
      next_[place_[i]] += rate;
      all += rate;
    }
    double amount = 0;
    for (std::size_t a = 0; a < cells(); ++a) {
      const double mean = particles_in_[a] > 0 ? next_[a] / particles_in_[a] : all / static_cast<double>(place_.size());
      const double least = option.not_negative ? -values_[s][a] : -std::numeric_limits<double>::infinity();
      const double by = std::max(lag_ * mean, std::min(0.0, least));
      values_[s][a] += by;
      amount += by * volume_[a];
    }
    scalars_.count_source(s, amount);
  }
}

// Amounts are kept by the stationary volumes, to what their iteration leaves: of tanks that exchange little that may be
// more than rounding.
void RecordedFlow::mix() {
  for (std::size_t s = 0; s < values_.size(); ++s) {
    std::vector<double>& values = values_[s];
    const double before = amount(s);
    for (std::size_t b = 0; b < cells(); ++b) {
      double sum = 0;
      for (std::size_t k = first_[b]; k < first_[b + 1]; ++k) sum += share_[k] * values[from_[k]];
      next_[b] = sum;
    }
    values.swap(next_);
    match(values, volume_, before);
  }
}

// dc/dt = g - k c in closed form.
void RecordedFlow::transfer(double dt) {
  std::vector<double>& values = values_[oxygen_->scalar()];
  for (std::size_t a = 0; a < cells(); ++a) {
    if (!(k_[a] > 0)) continue;
    const double gained = (values[a] - g_[a] / k_[a]) * std::expm1(-k_[a] * dt);
    values[a] += gained;
    given_ += volume_[a] * gained;
  }
}

void RecordedFlow::one_lag(double t) {
  add_sources(t);
  mix();
  if (oxygen_ != nullptr) transfer(lag_ / 2);
  if (sludge_ != nullptr) sludge_->react_in_cells(lag_, values_, volume_);
  if (oxygen_ != nullptr) transfer(lag_ / 2);
}

void RecordedFlow::advance(double t, double dt) {
  double from = t - pending_;
  pending_ += dt;
  bool moved = false;
  for (; pending_ >= (1 - slack) * lag_; pending_ -= lag_, from += lag_) {
    one_lag(from);
    moved = true;
  }
  if (moved) write_particles();
}

std::string RecordedFlow::in_words() const {
  return "t = " + brief(start_) + " to " + brief(end_) + " by lags of " + brief(lag_) + " between cells of " +
         brief(side_[0]);
}

void RecordedFlow::add_columns(SeriesTable& series) const {
  series.add("recorded_cells", "1, that hold liquid; 0 until the record carries",
             [this] { return complete_ ? static_cast<double>(cells()) : 0.0; });
  if (oxygen_ != nullptr)
    series.add("oxygen_from_record", "g, given by the recorded sources since the start", [this] { return given_; });
}

double RecordedFlow::bytes() const {
  return counts_.bytes() + 8.0 * static_cast<double>(from_.size() + share_.size() + place_.size());
}

void RecordedFlow::save(StateWriter& writer) const {
  const double numbers[] = {complete_ ? 1.0 : 0.0,        next_mark_, elapsed_, pending_, given_,
                            static_cast<double>(windows_)};
  writer.f64("recorded_flow", numbers);
  writer.f64("recorded_counts", {counts_.data(), counts_.size()});
  writer.f64("recorded_conductance", {conductance_.data(), conductance_.size()});
  writer.f64("recorded_capacity", {capacity_.data(), capacity_.size()});
  std::vector<double> all;
  for (const std::vector<double>& values : values_) all.insert(all.end(), values.begin(), values.end());
  writer.f64("recorded_values", all);
}

void RecordedFlow::load(StateReader& reader) {
  Array<double> numbers, all;
  const std::size_t cells_before = conductance_.size();
  reader.f64("recorded_flow", numbers);
  reader.f64("recorded_counts", counts_);
  reader.f64("recorded_conductance", conductance_);
  reader.f64("recorded_capacity", capacity_);
  reader.f64("recorded_values", all);
  if (numbers.size() != 6 || conductance_.size() != cells_before || counts_.size() != cells_before * cells_before)
    throw FileError("the checkpoint holds another record of the flow than the case");
  next_mark_ = numbers[1];
  elapsed_ = numbers[2];
  pending_ = numbers[3];
  given_ = numbers[4];
  windows_ = static_cast<std::int64_t>(numbers[5]);
  if (numbers[0] == 0) return;
  complete();
  if (all.size() != scalars_.size() * cells())
    throw FileError("the checkpoint holds another record of the flow than the case");
  for (std::size_t s = 0; s < scalars_.size(); ++s)
    values_[s].assign(all.begin() + static_cast<std::ptrdiff_t>(s * cells()),
                      all.begin() + static_cast<std::ptrdiff_t>((s + 1) * cells()));
}

}  // namespace spume
