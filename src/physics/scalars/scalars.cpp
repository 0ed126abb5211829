// SPDX-License-Identifier: MIT
#include "spume/physics/scalars/scalars.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/operators/scalar_transport.hpp"

namespace spume {
namespace {

// dt sum_j w_ij above which explicit diffusion overshoots half of the differences from the neighbours.
constexpr double largest_exchange = 0.5;

// Of the lattice: below it a surface cuts the kernel, and what is missing there exchanges nothing.
constexpr double least_divergence_of_position = 0.95;

void set_values(const ParticleStore& particles, const Domain& domain, const Expression& expression, double t,
                Array<double>& values, const std::function<bool(std::size_t)>& wanted) {
  parallel_blocks(particles.size(), default_block, [&](std::size_t, std::size_t first, std::size_t last) {
    const std::unique_ptr<Expression> own = expression.clone();
    for (std::size_t i = first; i < last; ++i) {
      if (!wanted(i)) continue;
      const Vec3 r = domain.inside(vector_at(particles.position, particles.dimensions, i));
      values[i] = (*own)(r[0], r[1], r[2], t);
    }
  });
}

// The value that is better than all others, in eight lanes: a comparison waits for the one before.
template <class T, class Better>
double extreme(const T* values, std::size_t n, Better better) {
  constexpr std::size_t lanes = 8;
  const auto choose = [better](T a, T b) { return better(b, a) ? b : a; };
  return parallel_reduce(
      n, values[0],
      [&](std::size_t first, std::size_t last) {
        std::array<T, lanes> best;
        best.fill(values[first]);
        std::size_t i = first;
        for (; i + lanes <= last; i += lanes)
          for (std::size_t l = 0; l < lanes; ++l) best[l] = choose(best[l], values[i + l]);
        for (; i < last; ++i) best[0] = choose(best[0], values[i]);
        for (std::size_t l = 1; l < lanes; ++l) best[0] = choose(best[0], best[l]);
        return best[0];
      },
      choose);
}

double least(const Array<double>& values, std::size_t n) {
  return extreme(values.data(), n, std::less<>());
}

}  // namespace

Scalars::Scalars(ParticleStore& particles, const Resolution& resolution, const Domain& domain,
                 const ScalarOptions& options, const ScalarWalls& walls)
    : particles_(particles),
      domain_(domain),
      options_(options),
      bulk_(resolution.lattice.divergence_of_position),
      rate_(options.scalars.size()),
      change_(options.scalars.size()),
      added_(options.scalars.size()),
      walls_(walls),
      wall_profile_(walls.walls.empty() ? nullptr : std::make_unique<const WallProfile>(resolution)),
      wall_change_(walls.walls.size()),
      nearest_to_wall_(resolution.spacing / 4),
      from_walls_(options.scalars.size()) {
  const std::size_t count = options.scalars.size();
  packed_ = {std::vector<const double*>(count), std::vector<double>(count), std::vector<float>(count),
             std::vector<float>(count),         std::vector<float*>(count), std::vector<float*>(count)};
  for (const ScalarOption& scalar : options.scalars) {
    fields_.push_back(&particles.fields.add<double>("scalar_" + scalar.name, Lifetime::state));
    fields_.back()->fill(0);
  }
  set_initial();
}

void Scalars::set_initial() {
  for (std::size_t s = 0; s < size(); ++s)
    if (option(s).initial != nullptr)
      set_values(particles_, domain_, *option(s).initial, 0, *fields_[s], [](std::size_t) { return true; });
}

Vec3 Scalars::place_of(std::size_t i) const {
  return domain_.inside(vector_at(particles_.position, particles_.dimensions, i));
}

void Scalars::enter(std::int64_t first, std::int64_t last, double t) {
  if (first == last) return;
  for (std::size_t s = 0; s < size(); ++s)
    if (option(s).inflow != nullptr)
      set_values(particles_, domain_, *option(s).inflow, t, *fields_[s], [&](std::size_t i) {
        const std::int64_t id = (*particles_.identifier)[i];
        return id >= first && id < last;
      });
}

void Scalars::lead(const std::vector<Coming>& coming, double t, double end, double support_radius) {
  const double most = std::max(0.0, end - t);
  for (std::size_t s = 0; s < size(); ++s) {
    if (option(s).inflow == nullptr) continue;
    const double diffusivity = option(s).diffusivity;
    parallel_blocks(coming.size(), default_block, [&](std::size_t, std::size_t first, std::size_t last) {
      const std::unique_ptr<Expression> brought = option(s).inflow->clone();
      for (std::size_t k = first; k < last; ++k) {
        const Coming& one = coming[k];
        const auto value = [&](double later) { return (*brought)(one.foot[0], one.foot[1], one.foot[2], t + later); };
        double later = one.speed > 0 ? one.depth / one.speed : 0;
        if (one.speed * support_radius < diffusivity)
          later = std::min(later, one.depth * one.depth / (2 * diffusivity));
        if (diffusivity == 0) later = std::min(later, most);
        double& given = (*fields_[s])[one.particle];
        given = value(later);
        if (!std::isfinite(given)) given = value(std::min(later, most));  // it need not exist after the end
      }
    });
  }
}

bool Scalars::follows() const {
  return std::any_of(options_.scalars.begin(), options_.scalars.end(),
                     [](const ScalarOption& one) { return one.inflow == nullptr; });
}

void Scalars::follow(std::size_t i, std::size_t like) {
  for (std::size_t s = 0; s < size(); ++s)
    if (option(s).inflow == nullptr) (*fields_[s])[i] = (*fields_[s])[like];
}

std::vector<double> Scalars::amounts() const {
  std::vector<double> found(size());
  for (std::size_t s = 0; s < size(); ++s) found[s] = amount(s);
  return found;
}

void Scalars::count_openings(const std::vector<double>& before) {
  for (std::size_t s = 0; s < size(); ++s) from_openings_[s] += amount(s) - before[s];
}

void Scalars::add_sources(double t, double dt) {
  for (std::size_t s = 0; s < size(); ++s) {
    if (option(s).source == nullptr) continue;
    double* values = fields_[s]->data();
    // A sink takes no more of a substance than is there.
    const double least = option(s).not_negative ? 0 : -std::numeric_limits<double>::infinity();
    added_[s] += particles_.volume * parallel_reduce(
                                         particles_.size(), 0.0,
                                         [&](std::size_t first, std::size_t last) {
                                           const std::unique_ptr<Expression> own = option(s).source->clone();
                                           double sum = 0;
                                           for (std::size_t i = first; i < last; ++i) {
                                             if (!counts(i)) continue;
                                             const Vec3 r = place_of(i);
                                             const double given = dt * (*own)(r[0], r[1], r[2], t + dt / 2);
                                             const double by = std::max(given, std::min(0.0, least - values[i]));
                                             values[i] += by;
                                             sum += by;
                                           }
                                           return sum;
                                         },
                                         [](double a, double b) { return a + b; });
  }
}

// Of particle i beside a wall with a value: what it takes of the difference per time. Nearer than a quarter of a
// spacing it is that at a quarter.
double Scalars::wall_rate(const ScalarWall& wall, const Carrier& carrier, std::size_t i) const {
  const double distance = distance_from(wall, carrier, i), share = (*wall_profile_)(distance);
  if (!(share > 0)) return 0;
  const ScalarOption& scalar = option(wall.scalar);
  const double eddy = carrier.eddy_viscosity == nullptr ? 0 : (*carrier.eddy_viscosity)[i];
  return share * (scalar.diffusivity + eddy / scalar.turbulent_schmidt) / std::max(distance, nearest_to_wall_);
}

double Scalars::distance_from(const ScalarWall& wall, const Carrier& carrier, std::size_t i) const {
  const auto axis = static_cast<std::size_t>(wall.axis);
  return std::abs((*carrier.places[axis])[i] - carrier.walls[axis][static_cast<std::size_t>(wall.end)]);
}

// From the values before diffusion: together they balance where both do.
void Scalars::find_wall_changes(double t, double dt, const Carrier& carrier) {
  for (std::size_t k = 0; k < walls_.walls.size(); ++k) {
    const ScalarWall& wall = walls_.walls[k];
    const double* values = fields_[wall.scalar]->data();
    wall_change_[k].resize(particles_.size());
    double* change = wall_change_[k].data();
    const Expression& given = wall.flux != nullptr ? *wall.flux : *wall.value;
    parallel_blocks(particles_.size(), default_block, [&](std::size_t, std::size_t first, std::size_t last) {
      const std::unique_ptr<Expression> own = given.clone();
      for (std::size_t i = first; i < last; ++i) {
        const double share = (*wall_profile_)(distance_from(wall, carrier, i));
        change[i] = 0;
        if (!(share > 0) || !counts(i)) continue;
        const Vec3 r = domain_.inside(vector_at(carrier.places, particles_.dimensions, i));
        const double here = (*own)(r[0], r[1], r[2], t + dt / 2);
        change[i] = wall.flux != nullptr ? dt * share * here : dt * wall_rate(wall, carrier, i) * (here - values[i]);
      }
    });
  }
}

void Scalars::apply_wall_changes() {
  for (std::size_t k = 0; k < walls_.walls.size(); ++k) {
    double* values = fields_[walls_.walls[k].scalar]->data();
    const double* change = wall_change_[k].data();
    parallel_for(particles_.size(), [=](std::size_t i) { values[i] += change[i]; });
    from_walls_[walls_.walls[k].scalar] +=
        particles_.volume * parallel_sum(particles_.size(), [=](std::size_t i) { return change[i]; });
  }
}

void Scalars::add(std::size_t scalar, const Array<float>& change, double amount) {
  struct Sums {
    double net = 0, moved = 0;
  };
  const std::size_t n = particles_.size();
  const Sums sums = parallel_reduce(
      n, Sums{},
      [&](std::size_t first, std::size_t last) {
        Sums part;
        for (std::size_t i = first; i < last; ++i) {
          part.net += change[i];
          part.moved += std::abs(double{change[i]});
        }
        return part;
      },
      [](const Sums& a, const Sums& b) {
        return Sums{a.net + b.net, a.moved + b.moved};
      });
  const double excess = sums.moved > 0 ? (sums.net - amount / particles_.volume) / sums.moved : 0;
  double* values = fields_[scalar]->data();
  parallel_for(n, [&](std::size_t i) { values[i] += double{change[i]} - excess * std::abs(double{change[i]}); });
}

double Scalars::amount(std::size_t scalar) const {
  if (left_out_ == nullptr)
    return particles_.volume *
           parallel_sum(particles_.size(), [value = values(scalar).data()](std::size_t i) { return value[i]; });
  return particles_.volume *
         parallel_sum(particles_.size(), [&](std::size_t i) { return counts(i) ? values(scalar)[i] : 0.0; });
}

double Scalars::liquid_volume() const {
  if (left_out_ == nullptr) return particles_.volume * static_cast<double>(particles_.size());
  return particles_.volume * parallel_sum(particles_.size(), [&](std::size_t i) { return counts(i) ? 1.0 : 0.0; });
}

void Scalars::lease(std::size_t scalars) {
  for (auto* arrays : {&rate_, &change_})
    for (std::size_t s = 0; s < scalars; ++s) particles_.scratch().lease((*arrays)[s], particles_.size());
}

void Scalars::release() {
  for (auto* arrays : {&rate_, &change_})
    for (Array<float>& array : *arrays) particles_.scratch().release(array);
  for (Array<float>* array : {&exchange_, &normalisation_}) particles_.scratch().release(*array);
}

// dt sum_j w_ij is at most D dt times the largest sum_j 2 g and a.
bool Scalars::ride_pays(double dt, const Carriage& carriage) const {
  if (particles_.size() == 0 || wall_has_value()) return false;
  if (carriage.shift[0] == nullptr && !diffuse()) return false;
  double diffusivity = 0;
  for (const ScalarOption& scalar : options_.scalars) diffusivity = std::max(diffusivity, scalar.diffusivity);
  return dt * diffusivity * particles_.dimensions / (least_divergence_of_position * bulk_) *
             extreme(carriage.laplacian_diagonal.data(), particles_.size(), std::greater<>()) <=
         largest_exchange;
}

RidingScalars Scalars::ride(double dt, const Carriage& carriage) {
  ridden_ = 0;
  if (!ride_pays(dt, carriage)) return {};
  ridden_ = std::min(size(), most_riding_scalars);
  ridden_shift_ = carriage.shift[0] != nullptr;
  lease(ridden_);
  find_packed(0, ridden_);
  const auto ridden = [this](const auto& values) { return std::span(values).first(ridden_); };
  return {.values = ridden(packed_.values),
          .reference = ridden(packed_.reference),
          .diffusivity = ridden(packed_.diffusivity),
          .viscosity = carriage.viscosity,
          .shift = ridden_shift_ ? read(carriage.shift) : std::array<const float*, 3>{},
          .correction = carriage.correction,
          .rate = ridden(packed_.rate),
          .change = ridden(packed_.change)};
}

// Of each the value, its rate and its change by the shift; sum_j 2 g, the shift and the symmetric L.
double Scalars::ridden_bytes() const {
  if (ridden_ == 0) return 0;
  const double d = particles_.dimensions, of_all = 4 + (ridden_shift_ ? 4 * (d + d * (d + 1) / 2) : 0);
  const double of_each = 8 + 4 + (ridden_shift_ ? 4 : 0);
  return static_cast<double>(particles_.size()) * (of_all + of_each * static_cast<double>(ridden_));
}

void Scalars::find_normalisation(const Carrier& carrier) {
  if (!normalisation_.empty()) return;
  particles_.scratch().lease(normalisation_, particles_.size());
  const float* div_r = carrier.divergence_of_position;
  parallel_for(particles_.size(), [&](std::size_t i) {
    normalisation_[i] =
        static_cast<float>(particles_.dimensions / std::max<double>(div_r[i], least_divergence_of_position * bulk_));
  });
}

// What sweeps read of the scalars in [first, last).
void Scalars::find_packed(std::size_t first, std::size_t last) {
  for (std::size_t s = first; s < last; ++s) {
    packed_.values[s] = fields_[s]->data();
    packed_.reference[s] = least(*fields_[s], particles_.size());
    packed_.diffusivity[s] = static_cast<float>(option(s).diffusivity);
    packed_.inverse_schmidt[s] = static_cast<float>(1 / option(s).turbulent_schmidt);
    packed_.rate[s] = rate_[s].data();
    packed_.change[s] = change_[s].data();
  }
}

// Of the scalars from `first` on. Where some rode the exchange is known to be small.
std::int64_t Scalars::sweep(std::size_t first, const Carrier& carrier, bool shifted) {
  if (first == size()) return 0;
  find_normalisation(carrier);
  if (first == 0) particles_.scratch().lease(exchange_, particles_.size());
  find_packed(first, size());
  const auto behind = [first](const auto& values) { return std::span(values).subspan(first); };
  return scalar_transport_sweep(
      carrier.arrangement.context, carrier.arrangement.packed,
      {.values = behind(packed_.values),
       .reference = behind(packed_.reference),
       .diffusivity = behind(packed_.diffusivity),
       .normalisation = normalisation_.data(),
       .eddy_viscosity = carrier.eddy_viscosity == nullptr ? nullptr : carrier.eddy_viscosity->data(),
       .inverse_schmidt = behind(packed_.inverse_schmidt),
       .shift = shifted ? read(carrier.shift) : std::array<const float*, 3>{},
       .correction = carrier.correction},
      {.rate = behind(packed_.rate),
       .change = behind(packed_.change),
       .exchange = first == 0 ? exchange_.data() : nullptr});
}

bool Scalars::wall_has_value() const {
  return std::any_of(walls_.walls.begin(), walls_.walls.end(),
                     [](const ScalarWall& wall) { return wall.value != nullptr; });
}

double Scalars::largest_exchange_of(const Carrier& carrier) const {
  if (!wall_has_value()) return extreme(exchange_.data(), particles_.size(), std::greater<>());
  return parallel_max(particles_.size(), 0.0, [&](std::size_t i) {
    double most = 0;
    for (const ScalarWall& wall : walls_.walls)
      if (wall.value != nullptr) most = std::max(most, wall_rate(wall, carrier, i));
    return exchange_[i] + most;
  });
}

Scalars::Sums Scalars::sums_of(std::size_t scalar, const float* interior, bool shifted) const {
  const float *rate = rate_[scalar].data(), *change = change_[scalar].data();
  return parallel_reduce(
      particles_.size(), Sums{},
      [=](std::size_t first, std::size_t last) {
        Sums part;
        for (std::size_t i = first; i < last; ++i) {
          part.net += rate[i];
          part.moved += std::abs(double{rate[i]});
        }
        if (shifted)
          for (std::size_t i = first; i < last; ++i) {
            const double by = interior == nullptr ? double{change[i]} : double{interior[i]} * change[i];
            part.gains += std::max(by, 0.0);
            part.losses += std::max(-by, 0.0);
          }
        return part;
      },
      [](const Sums& a, const Sums& b) {
        return Sums{a.net + b.net, a.moved + b.moved, a.gains + b.gains, a.losses + b.losses};
      });
}

void Scalars::apply(double dt, const float* interior, bool shifted) {
  for (std::size_t s = 0; s < size(); ++s) {
    const float *rate = rate_[s].data(), *change = change_[s].data();
    const Sums sums = sums_of(s, interior, shifted);
    const double excess = sums.moved > 0 ? sums.net / sums.moved : 0;
    const double both = std::min(sums.gains, sums.losses);
    const double gain = both > 0 ? both / sums.gains : 0, loss = both > 0 ? both / sums.losses : 0;
    double* values = fields_[s]->data();
    const auto change_those = [&](auto&& wanted) {
      parallel_blocks(particles_.size(), default_block, [=](std::size_t, std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
          if (wanted(i)) values[i] += dt * (double{rate[i]} - excess * std::abs(double{rate[i]}));
        if (both > 0)
          for (std::size_t i = first; i < last; ++i) {
            if (!wanted(i)) continue;
            const double by = interior == nullptr ? double{change[i]} : double{interior[i]} * change[i];
            values[i] += by * (by > 0 ? gain : loss);
          }
      });
    };
    if (left_out_ == nullptr)
      change_those([](std::size_t) { return true; });
    else
      change_those([column = left_out_->data()](std::size_t i) { return column[i] < 0; });
  }
}

bool Scalars::diffuse() const {
  return !walls_.walls.empty() || std::any_of(options_.scalars.begin(), options_.scalars.end(),
                                              [](const ScalarOption& one) { return one.diffusivity > 0; });
}

std::int64_t Scalars::transport(double dt, const Carrier& carrier) {
  const std::size_t ridden = std::exchange(ridden_, 0);
  substeps_ = 0;
  const bool shifted = carrier.shift[0] != nullptr;
  if (particles_.size() == 0 || !(shifted || carrier.eddy_viscosity != nullptr || diffuse())) return 0;
  lease(size());
  std::int64_t sweeps = sweep(ridden, carrier, shifted);
  substeps_ = 1;
  if (ridden == 0)
    substeps_ = std::max<std::int64_t>(
        1, static_cast<std::int64_t>(std::ceil(dt * largest_exchange_of(carrier) / largest_exchange)));
  const double part = dt / static_cast<double>(substeps_);
  for (std::int64_t k = 0; k < substeps_; ++k) {
    if (k > 0) sweeps += sweep(0, carrier, false);
    find_wall_changes(carrier.time + static_cast<double>(k) * part, part, carrier);
    const std::vector<double> before = left_out_ == nullptr ? std::vector<double>() : amounts();
    apply(part, carrier.interior, k == 0 && shifted);
    if (left_out_ != nullptr) count_openings(before);
    apply_wall_changes();
  }
  release();
  return sweeps;
}

void Scalars::add_columns(SeriesTable& series) const {
  for (std::size_t s = 0; s < size(); ++s) {
    const std::string volume = particles_.dimensions == 3 ? "length^3" : "length^2";
    const std::string& unit = option(s).unit;
    series.add("amount_of_" + option(s).name, unit.empty() ? volume : unit + " times " + volume,
               [this, s] { return amount(s); });
  }
  for (std::size_t s = 0; s < size(); ++s)
    if (option(s).source != nullptr)
      series.add("source_of_" + option(s).name, "amount, added since the start", [this, s] { return added_[s]; });
  for (std::size_t s = 0; s < size(); ++s)
    if (std::any_of(walls_.walls.begin(), walls_.walls.end(), [s](const ScalarWall& w) { return w.scalar == s; }))
      series.add("walls_gave_" + option(s).name, "amount, since the start", [this, s] { return from_walls_[s]; });
  for (std::size_t s = 0; s < from_openings_.size(); ++s)
    series.add("openings_gave_" + option(s).name, "amount, less what they took, since the start",
               [this, s] { return from_openings_[s]; });
  series.add("scalar_substeps", "1, into which diffusion divided the last step",
             [this] { return static_cast<double>(substeps_); });
}

void Scalars::add_fields(SnapshotTable& snapshot) const {
  for (std::size_t s = 0; s < size(); ++s) snapshot.add(option(s).name, true, *fields_[s]);
}

void Scalars::save(StateWriter& writer) const {
  writer.f64("scalar_sources", added_);
  writer.f64("scalar_walls", from_walls_);
  if (!from_openings_.empty()) writer.f64("scalar_openings", from_openings_);
  writer.i64("scalar_substeps", {&substeps_, 1});
}

void Scalars::load(StateReader& reader) {
  ridden_ = 0;
  Array<double> saved;
  for (auto [name, values] :
       {std::pair{"scalar_sources", &added_}, {"scalar_walls", &from_walls_}, {"scalar_openings", &from_openings_}}) {
    if (values->empty()) continue;
    reader.f64(name, saved);
    if (saved.size() != values->size()) throw FileError("the checkpoint holds other scalars than the case");
    std::copy(saved.begin(), saved.end(), values->begin());
  }
  Array<std::int64_t> substeps;
  reader.i64("scalar_substeps", substeps);
  if (substeps.size() == 1) substeps_ = substeps[0];
}

void add_scalar_fields(const ScalarOptions& options, std::vector<OutputFieldInfo>& infos) {
  for (const ScalarOption& scalar : options.scalars) infos.push_back({scalar.name});
}

}  // namespace spume
