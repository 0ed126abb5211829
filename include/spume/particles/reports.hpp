// SPDX-License-Identifier: MIT
// What a particle method reports, as tables with one entry per quantity: columns of series.csv, fields of a snapshot,
// numbers of a checkpoint. Each is declared once, with the way to read it.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "spume/core/array_info.hpp"
#include "spume/core/field_set.hpp"
#include "spume/core/saved_state.hpp"
#include "spume/io/series.hpp"
#include "spume/io/snapshot.hpp"
#include "spume/particles/arrangement.hpp"

namespace spume {

class Boundary;

// Columns of series.csv.
class SeriesTable {
 public:
  void add(std::string name, std::string unit, std::function<double()> value);
  // Runs before the values of a row are read: sums that several columns share.
  std::function<void()> prepare;

  std::vector<SeriesColumn> columns() const;
  void values(std::span<double> row) const;  // one per column

 private:
  struct Entry {
    SeriesColumn column;
    std::function<double()> value;
  };
  std::vector<Entry> entries_;
};

// Where the sides stand that move along their normals, as "wall_left"; the boundary outlives the table.
void add_wall_columns(SeriesTable& series, const Boundary& boundary);

// Fields of a snapshot of particles. A standard one is written unless the case lists others.
class SnapshotTable {
 public:
  // A field of the state.
  void add(std::string name, bool standard, const VectorField& vector);
  void add(std::string name, bool standard, const FloatVectorField& vector);
  void add(std::string name, bool standard, const Array<double>& values);
  void add(std::string name, bool standard, const Array<std::int64_t>& values);  // empty: zeros
  // One that is computed for every snapshot.
  void add(std::string name, bool standard, std::function<double(std::size_t)> value);
  // Particles are shown inside along periodic axes of the domain, which outlives the table, wherever they are.
  void go_round(const Domain& domain) { domain_ = &domain; }
  // Particles with 0 or more are not in the snapshots.
  void leave_out(const Array<std::int64_t>& left_out) { left_out_ = &left_out; }

  // The snapshot with the wanted fields (none wanted: the standard ones); its arrays live until the next one. Fields
  // that are computed for it are not filled yet.
  ParticleSnapshot take(std::string name, std::size_t size, const VectorField& position,
                        const std::vector<std::string>& wanted);

 private:
  struct Entry {
    std::string name;
    bool standard = false;
    std::vector<const Array<double>*> f64 = {};
    std::vector<const Array<float>*> f32 = {};  // written as doubles
    const Array<std::int64_t>* i64 = nullptr;
    std::function<double(std::size_t)> value = {};
  };
  std::vector<Entry> entries_;
  void gather(ParticleSnapshot& snapshot);

  const Array<std::int64_t>* left_out_ = nullptr;
  const Domain* domain_ = nullptr;
  std::array<Array<double>, 3> shown_;  // along periodic axes
  std::map<std::string, Array<double>> computed_;
  Array<std::int32_t> chosen_;
  std::map<std::string, std::vector<Array<double>>> chosen_values_;
  std::map<std::string, Array<std::int64_t>> chosen_numbers_;
  Array<std::int64_t> zeros_;  // of fields of numbers that have no memory
};

// The numbers of a state between steps, under one name of a checkpoint: written and read in the order in which they
// were added. Integers are written as doubles, which hold a count of steps exactly.
class SavedNumbers {
 public:
  explicit SavedNumbers(std::string name) : name_(std::move(name)) {}
  SavedNumbers& add(double& value);
  SavedNumbers& add(std::int64_t& value);
  void save(StateWriter& writer) const;
  // Throws FileError when their number is another: the file is of another version.
  void load(StateReader& reader) const;

 private:
  std::string name_;
  std::vector<std::variant<double*, std::int64_t*>> numbers_;
};

// What every particle method holds, for Method::arrays(): the fields of the particles and their arrangement.
std::vector<ArrayInfo> particle_arrays(const ParticleStore& particles, const Arrangement& arrangement);

}  // namespace spume
