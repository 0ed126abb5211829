// SPDX-License-Identifier: MIT
// What a run reports of its particles: columns of the series, snapshot and distributions.
#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/methods/spectral/suspension.hpp"
#include "spume/physics/point_particles/clustering.hpp"

namespace spume::spectral {
namespace {

// Shortest and longest distance of the pair statistics, in grid spacings, and the range of the dimension.
constexpr double pair_range[2] = {0.05, 4};
constexpr double dimension_range[2] = {0.1, 1};
constexpr double contact_range = 4;  // of spheres that exclude each other: from contact to as many diameters at least
// Particles around which pairs are counted: the mean over so many is off by 0.7 % of a particle's own scatter. A row of
// the series takes a quarter of them.
constexpr std::size_t pair_centres = 20000;
constexpr int pair_bins = 32, dimension_bins = 16;  // per range, of equal ratio
constexpr double most_of_side = 0.45;               // of the box: pairs are counted once up to half of it
constexpr int overlap_bins = 20;

double smallest_spacing(const PeriodicGrid& grid) {
  return std::min({grid.spacing(0), grid.spacing(1), grid.spacing(2)});
}

}  // namespace

// One column is one entry: name, unit, and how it is read after measure().
template <class T>
void Suspension<T>::make_columns() {
  const auto add = [this](std::string name, std::string unit, std::function<double()> read) {
    columns_.push_back({{std::move(name), std::move(unit)}, std::move(read)});
  };
  const auto per_particle = [this](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(system_.size(), 1));
  };
  add("particle_rms_velocity", "speed", [this] { return std::sqrt(system_.motion().mean_square_velocity); });
  add("particle_rms_acceleration", "acceleration",
      [this] { return std::sqrt(system_.motion().mean_square_acceleration); });
  add("particle_rms_slip", "speed against the fluid", [this] { return std::sqrt(system_.motion().mean_square_slip); });
  add("correlation_dimension", "1", [this] { return measured_.dimension; });
  add("box_count_variance", "over that of random places", [this] { return measured_.box_variance; });
  if (loaded_.options.get<ParticleCaseOptions>().overlap_samples > 0) {
    add("overlap_ratio", "of the volume of the particles", [this] { return measured_.overlap.value; });
    add("overlap_ratio_error", "standard", [this] { return measured_.overlap.standard_error; });
  }
  if (system_.couples()) {
    add("particle_work", "power of the force on the flow, mean", [this] { return flow_.budget().work; });
    add("clipped_force", "of |f|, by the volume fraction", [this] {
      const DepositionReport& report = system_.deposition();
      return report.force > 0 ? report.clipped_force / report.force : 0;
    });
    add("max_volume_fraction", "at a point", [this] { return system_.deposition().most_volume_fraction; });
  }
  if (system_.collides()) {
    add("overlapping", "of the particles, before the collisions",
        [this, per_particle] { return per_particle(system_.exclusion().overlapping); });
    add("collisions", "pairs moved apart in the step, of the particles",
        [this, per_particle] { return per_particle(system_.exclusion().pairs); });
  }
  if (follows_exponents_) {
    for (std::size_t k = 0; k < 6; ++k)
      add("stretching_" + std::to_string(k + 1), "log of growth since the start",
          [this, k] { return measured_.stretching[k]; });
    add("kaplan_yorke_dimension", "since the start",
        [this] { return flow_.steps() > 0 ? kaplan_yorke_dimension(measured_.stretching) : 6; });
  }
}

// Of no set in space above 3: beyond that are the scatter of few pairs and, of spheres, the shells around one.
template <class T>
double Suspension<T>::dimension(double spacing) const {
  const auto x = system_.particles().positions();
  const auto statistics = [&](double from, double to) {
    return pair_statistics(grid_.lower, grid_.length, x, system_.size(), from, to, dimension_bins, pair_centres / 4);
  };
  const double from = dimension_range[0] * spacing, to = dimension_range[1] * spacing;
  const double contact = system_.collides() ? system_.largest_diameter() : 0;
  if (contact <= from) return std::min(correlation_dimension(statistics(pair_range[0] * spacing, to), from, to), 3.0);
  const double farthest = std::min(std::max(to, contact_range * contact),
                                   0.45 * *std::min_element(grid_.length.begin(), grid_.length.end()));
  if (!(farthest > contact)) return std::numeric_limits<double>::quiet_NaN();
  return std::min(dimension_beyond_contact(statistics(contact, farthest), contact, farthest), 3.0);
}

template <class T>
void Suspension<T>::measure() {
  const auto x = system_.particles().positions();
  const double spacing = smallest_spacing(grid_);
  measured_.dimension = dimension(spacing);
  const PeriodicCells boxes = PeriodicCells::with_side(grid_.lower, grid_.length, 4 * spacing * (1 - 1e-12), 1e18);
  measured_.box_variance = box_count_variance(boxes, x, system_.size());
  if (const auto samples = loaded_.options.get<ParticleCaseOptions>().overlap_samples; samples > 0)
    measured_.overlap =
        system_.measure_overlap(static_cast<std::size_t>(samples), static_cast<std::uint32_t>(flow_.steps()));
  if (follows_exponents_) measured_.stretching = tracker_.stretching();
}

template <class T>
void Suspension<T>::add_columns(std::vector<SeriesColumn>& list) const {
  for (const Column& column : columns_) list.push_back(column.heading);
}

template <class T>
void Suspension<T>::values(std::span<double> row) {
  measure();
  for (std::size_t i = 0; i < columns_.size(); ++i) row[i] = columns_[i].read();
}

template <class T>
ParticleSnapshot Suspension<T>::snapshot() {
  const Particles& particles = system_.particles();
  const auto x = particles.positions(), v = particles.velocities();
  ParticleSnapshot snapshot;
  snapshot.name = "bubbles";
  snapshot.size = particles.size();
  snapshot.position = {x[0], x[1], x[2]};
  snapshot.fields.push_back({"velocity", {v[0], v[1], v[2]}, {}});
  snapshot.fields.push_back({"id", {}, {particles.identifier->data()}});
  if (particles.diameter != nullptr) snapshot.fields.push_back({"diameter", {particles.diameter->data()}, {}});
  return snapshot;
}

template <class T>
void Suspension<T>::add_tables(std::vector<RecordTable>& list) const {
  const auto add = [&list](const std::string& name, std::vector<SeriesColumn> columns) {
    columns.insert(columns.begin(), {"t", "time"});
    list.push_back({name, name, std::move(columns), RecordTable::When::spectrum});
  };
  add("particle_pairs", {{"distance", "length"},
                         {"radial_distribution", "pairs over those of random places"},
                         {"correlation", "particles within the distance of a particle"}});
  add("particle_boxes", {{"side", "length"},
                         {"mean_count", "particles in a box"},
                         {"variance", "of the count, over that of random places"}});
  add("particle_overlaps", {{"overlap", "of the touching distance"}, {"pairs", "probability density"}});
}

template <class T>
void Suspension<T>::table_rows(const std::string& name, std::vector<double>& rows) {
  const double t = flow_.time();
  const double spacing = std::min({grid_.spacing(0), grid_.spacing(1), grid_.spacing(2)});
  const auto positions = system_.particles().positions();
  if (name == "particle_pairs") {
    const double shortest = std::min({grid_.length[0], grid_.length[1], grid_.length[2]});
    const PairStatistics pairs =
        pair_statistics(grid_.lower, grid_.length, positions, system_.size(), pair_range[0] * spacing,
                        std::min(pair_range[1] * spacing, most_of_side * shortest), pair_bins, pair_centres);
    for (std::size_t b = 0; b + 1 < pairs.radius.size(); ++b)
      rows.insert(rows.end(), {t, std::sqrt(pairs.radius[b] * pairs.radius[b + 1]), pairs.radial_distribution[b],
                               pairs.correlation[b + 1]});
  } else if (name == "particle_boxes") {
    for (const BoxCount& box : box_counts(grid_.lower, grid_.length, positions, system_.size(), spacing))
      rows.insert(rows.end(), {t, box.side, box.mean, box.variance});
  } else if (name == "particle_overlaps") {
    const std::vector<double> overlaps = system_.overlap_histogram(overlap_bins);
    for (int b = 0; b < overlap_bins; ++b)
      rows.insert(rows.end(), {t, (b + 0.5) / overlap_bins, overlaps[static_cast<std::size_t>(b)]});
  }
}

template <class T>
std::vector<Invariant> Suspension<T>::invariants() const {
  std::vector<Invariant> list;
  const auto at_most = [&list](const char* column, double bound) {
    list.push_back({.quantity = column, .column = column, .bound = bound});
  };
  // De Wit et al. (2024), III A and IV: both stay below 1 % where collisions keep up with the clustering.
  if (system_.collides() && loaded_.options.get<ParticleCaseOptions>().overlap_samples > 0)
    at_most("overlap_ratio", 0.01);
  if (system_.couples()) at_most("clipped_force", 0.01);
  return list;
}

template std::vector<Invariant> Suspension<double>::invariants() const;
template std::vector<Invariant> Suspension<float>::invariants() const;
template double Suspension<double>::dimension(double) const;
template double Suspension<float>::dimension(double) const;
template void Suspension<double>::make_columns();
template void Suspension<float>::make_columns();
template void Suspension<double>::add_columns(std::vector<SeriesColumn>&) const;
template void Suspension<float>::add_columns(std::vector<SeriesColumn>&) const;
template void Suspension<double>::values(std::span<double>);
template void Suspension<float>::values(std::span<double>);
template ParticleSnapshot Suspension<double>::snapshot();
template ParticleSnapshot Suspension<float>::snapshot();
template void Suspension<double>::add_tables(std::vector<RecordTable>&) const;
template void Suspension<float>::add_tables(std::vector<RecordTable>&) const;
template void Suspension<double>::table_rows(const std::string&, std::vector<double>&);
template void Suspension<float>::table_rows(const std::string&, std::vector<double>&);

}  // namespace spume::spectral
