// SPDX-License-Identifier: MIT
// Openings as buffer layers of particles behind inflows and outflows, as deep as a kernel reaches (M. Lastiwka, M.
// Basa, N. J. Quinlan, Int. J. Numer. Meth. Fluids 61 (2009); A. Tafuni et al., Comput. Methods Appl. Mech. Engrg. 342
// (2018)).
//
// They are particles of the store, with a phase, neighbours and a part in every sum; the equations do not move them.
//
// Behind an inflow they stand in columns that move with the given velocity: by the volume of a particle over the
// cross-section of the column what enters is what the velocity gives, to a particle. What passes the side is liquid.
// Liquid that passes an outflow goes on as part of its layer. What comes back is liquid again; one takes its place at
// the far end.
//
// Pressures in the layers, and velocities behind outflows, are those of the equations: particles/acoustic_layers.hpp of
// compressible phases, particles/layer_stencils.hpp of incompressible ones.
#pragma once

#include <vector>

#include "spume/core/saved_state.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/open_gates.hpp"
#include "spume/particles/reports.hpp"
#include "spume/particles/resolution.hpp"

namespace spume {

class BufferLayers {
 public:
  struct Column {
    std::int32_t gate = 0, cell = 0;
    std::size_t phase = 0;    // of what enters
    Vec3 velocity{};          // of an inflow, its mean over this step
    double acceleration = 0;  // of it along the axis of the opening
  };

  // Adds the field that tells the particles of the layers. `scene` and `particles` outlive them; lists of neighbours
  // hold until a particle has moved by skin / 2.
  BufferLayers(const Scene& scene, const Resolution& resolution, double skin, ParticleStore& particles);

  // Fields that liquid takes along: what is made up for behind an outflow has them of what it is a copy of.
  void carry(std::vector<const Array<double>*> fields) { carried_ = std::move(fields); }
  // At the start: the layers as the scene has them. `changes` are rates and shifts, zero in the layers.
  void fill(Array<std::int64_t>& phase, std::vector<FloatVectorField> changes);

  const OpenGates& gates() const { return gates_; }
  // Whether a particle belongs to a layer.
  bool holds(std::size_t i) const { return (*column_)[i] >= 0; }
  // Whether it stands in a column of an inflow, which leads it along its axis alone.
  bool leads(std::size_t i) const { return holds(i) && gate_of((*column_)[i]).opening->inflow; }
  const Array<std::int64_t>& column() const { return *column_; }  // >= 0: holds
  // The gate and the column of a particle that the layers hold.
  const OpenGate& gate_of(std::int64_t column) const {
    return gates_.list[static_cast<std::size_t>(columns_[static_cast<std::size_t>(column)].gate)];
  }
  const Column& column_of(std::size_t i) const { return columns_[static_cast<std::size_t>((*column_)[i])]; }
  std::size_t columns() const { return columns_.size(); }
  std::vector<Coming> coming();  // all behind inflows
  // Per column of an inflow that has particles the liquid particle that is nearest before its side; where there is none
  // within a support radius that which is nearest to the first such column of the opening. -1 of other columns, and
  // without liquid.
  std::vector<std::int32_t> nearest_liquid(const std::vector<Coming>& coming);
  // The particles of the layers, as numbered when they were found; particles are numbered anew by sorting.
  const Array<std::int32_t>& find_members();

  // Sets the velocities with which the layers of inflows move in a step.
  void set_velocities(double t, double dt);
  // Whether the layers are to be renewed before the step, beside when lists are made.
  bool stale() const { return stale_; }
  // What is out of reach is dropped, what is missing at the far ends is added. Particles are numbered anew.
  void renew();
  // Walls, for a particle at r on its way; columns of inflows keep to their cross-section. `from` as for
  // Boundary::apply_walls().
  void apply_walls(const Boundary& boundary, std::size_t i, Vec3& r, Vec3* u, const Vec3* from = nullptr) const;

  // Particles are where the step has brought them: who passes a side changes over.
  void accept();

  // Columns of the volume of each phase in the domain, and of what has entered and left; the last net of what came
  // back.
  void add_columns(SeriesTable& series) const;
  // Volume of a phase that has left less that which has entered.
  double net_outflow(std::size_t phase) const;
  void save(StateWriter& writer) const;
  void load(StateReader& reader);
  double bytes() const;

 private:
  struct Newcomer {
    std::size_t source = 0;  // any particle that there is
    std::int64_t column = 0;
    std::int64_t phase = 0;
    Vec3 place{}, velocity{};
  };
  void add_columns_of_inflows(std::vector<Newcomer>& newcomers) const;
  void insert(const Array<std::int32_t>& staying, const std::vector<Newcomer>& newcomers);
  double volume_inside(std::size_t phase) const;
  std::int32_t nearest_of_all(const Vec3& place) const;

  const Scene& scene_;
  const Resolution resolution_;
  ParticleStore& particles_;
  OpenGates gates_;
  const double reach_;  // of the layers, when they are renewed
  std::vector<Column> columns_;
  std::vector<std::size_t> first_;         // column of each gate
  Array<std::int64_t>* column_ = nullptr;  // of each particle; -1: liquid, below: liquid that came back through -2 - it
  Array<std::int64_t>* phase_ = nullptr;
  std::vector<FloatVectorField> changes_;
  std::vector<const Array<double>*> carried_;
  Array<std::int32_t> members_;               // particles of the layers
  Array<std::int32_t> passed_;                // particles that have passed a side
  Array<std::int32_t> before_;                // liquid before inflows
  std::vector<std::int64_t> entered_, left_;  // particles of each phase
  std::int64_t next_identifier_ = 0;
  bool stale_ = false;
};

}  // namespace spume
