// SPDX-License-Identifier: MIT
// Openings of explicit methods: buffer layers of particles behind inflows and outflows, as deep as a kernel reaches
// (M. Lastiwka, M. Basa, N. J. Quinlan, Int. J. Numer. Meth. Fluids 61 (2009); A. Tafuni et al., Comput. Methods Appl.
// Mech. Engrg. 342 (2018)).
//
// They are particles of the store, with a phase, neighbours and a part in every sum; the equations do not move them.
//
// Behind an inflow they stand in columns that move with the given velocity: by the volume of a particle over the
// cross-section of the column what enters is what the velocity gives, to a particle. Their pressure is that of the
// liquid before them and its weight. What passes the side is liquid.
//
// Liquid that passes an outflow goes on with its velocity, which follows that of the liquid before it. With u_n the
// mean velocity outwards of the liquid before it, U the mean of that before its column of the opening over a time 1 / K
// and Z the harmonic mean of the impedances rho c there, its pressure is
//
//   p = p_out + Z (u_n - U),  dU/dt = K (u_n - U).
//
// That lets sound out: it is the characteristic condition dp/dt + K (p - p_out) = Z du_n/dt of T. J. Poinsot and S. K.
// Lele, J. Comput. Phys. 101 (1992), with K = 0.25 c / L, L the length of the domain. By the mean over the whole
// opening in place of columns air that sloshes below an open top gains speed until it breaks up. Beside a free surface,
// which lets sound out itself, p = p_out: drops that fall out would be held back. What comes back is liquid again; one
// takes its place at the far end.
//
// Means are over the liquid within the kernel, pressures and velocities behind a side over that of the phase of the
// particle where there is any. An inflow holds its velocity and therefore reflects sound, as a wall does.
#pragma once

#include <functional>
#include <vector>

#include "spume/core/saved_state.hpp"
#include "spume/operators/image_values.hpp"
#include "spume/particles/arrangement.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/open_gates.hpp"
#include "spume/particles/phase_law.hpp"
#include "spume/particles/reports.hpp"

namespace spume {

class BufferLayers {
 public:
  // Adds the field that tells the particles of the layers. `scene`, `laws` and `particles` outlive them; lists of
  // neighbours hold until a particle has moved by skin / 2.
  BufferLayers(const Scene& scene, const Resolution& resolution, double skin, const std::vector<PhaseLaw>& laws,
               ParticleStore& particles);

  // At the start: the layers as the scene has them. `excess` is rho / rho_0 - 1; `changes` are rates and shifts, zero
  // in the layers.
  void fill(Array<std::int64_t>& phase, Array<double>& excess, std::vector<FloatVectorField> changes);

  const OpenGates& gates() const { return gates_; }
  // Whether a particle belongs to a layer.
  bool holds(std::size_t i) const { return (*column_)[i] >= 0; }
  // Whether it stands in a column of an inflow, which leads it along its axis alone.
  bool leads(std::size_t i) const { return holds(i) && gate_of((*column_)[i]).opening->inflow; }
  const Array<std::int64_t>& column() const { return *column_; }  // >= 0: holds

  // Sets the velocities with which the layers of inflows move in a step.
  void set_velocities(double t, double dt);
  // Whether the layers are to be renewed before the step, beside when lists are made.
  bool stale() const { return stale_; }
  // What is out of reach is dropped, what is missing at the far ends is added. Particles are numbered anew.
  void renew();
  // Walls, for a particle at r on its way; columns of inflows keep to their cross-section.
  void apply_walls(const Boundary& boundary, std::size_t i, Vec3& r, Vec3* u) const;

  // Of the liquid as it is, at time t.
  struct Liquid {
    const Arrangement& arrangement;
    ImageMap images;
    Vec3 gravity{};         // zero along periodic axes
    double background = 0;  // part of the pressures
    double time = 0;
    std::function<double(int axis, std::size_t i)> velocity;
  };
  // Excess, pressure and volume over that at rest of the particles of the layers.
  void find_pressures(const Liquid& liquid, Array<double>& excess, Array<float>& pressure, Array<float>& volume);
  // Particles are where the step has brought them: who passes a side changes over.
  void accept(double dt);

  // Columns of the volume of each phase in the domain, and of what has entered and left; the last net of what came
  // back.
  void add_columns(SeriesTable& series) const;
  // Volume of a phase that has left less that which has entered.
  double net_outflow(std::size_t phase) const;
  // The largest speed over sound speed with which an inflow lets anything enter until `end`, and its name.
  struct Fastest {
    double mach = 0;
    std::string name;
  };
  Fastest fastest_inflow(double end) const;

  void save(StateWriter& writer) const;
  void load(StateReader& reader);
  double bytes() const;

 private:
  struct Column {
    std::int32_t gate = 0, cell = 0;
    std::size_t phase = 0;    // of what enters
    Vec3 velocity{};          // of an inflow, in this step
    double acceleration = 0;  // of it along the axis of the opening
    double mean = 0;          // of the velocity outwards at an outflow
    bool known = false;       // `mean` is one
  };
  struct Newcomer {
    std::size_t source = 0;  // any particle that there is
    std::int64_t column = 0;
    std::int64_t phase = 0;
    Vec3 place{}, velocity{};
  };
  // What a particle of the layers sees of the liquid: means over its own phase, and sums over all phases.
  struct Seen {
    double weight = 0, pressure = 0;
    Vec3 velocity{};
    double all = 0, outwards = 0, compliance = 0;  // of u_n and of 1 / (rho c)
  };

  const OpenGate& gate_of(std::int64_t column) const {
    return gates_.list[static_cast<std::size_t>(columns_[static_cast<std::size_t>(column)].gate)];
  }
  void find_members();
  void add_columns_of_inflows(std::vector<Newcomer>& newcomers) const;
  void insert(const Array<std::int32_t>& staying, const std::vector<Newcomer>& newcomers);
  Seen look(const Liquid& liquid, const Array<float>& pressure, std::size_t i) const;
  double share_of_step(int axis, double sound_speed, double dt) const;
  double volume_inside(std::size_t phase) const;

  const Scene& scene_;
  const Resolution resolution_;
  const std::vector<PhaseLaw>& laws_;
  ParticleStore& particles_;
  OpenGates gates_;
  const double reach_;  // of the layers, when they are renewed
  std::vector<Column> columns_;
  std::vector<std::size_t> first_;         // column of each gate
  Array<std::int64_t>* column_ = nullptr;  // of each particle; -1: liquid, below: liquid that came back through -2 - it
  Array<std::int64_t>* phase_ = nullptr;
  Array<double>* excess_ = nullptr;
  std::vector<FloatVectorField> changes_;
  Array<std::int32_t> members_;               // particles of the layers
  Array<std::int32_t> passed_;                // particles that have passed a side
  std::vector<Seen> seen_;                    // of them
  std::vector<std::int64_t> entered_, left_;  // particles of each phase
  std::int64_t next_identifier_ = 0;
  bool stale_ = false;
};

}  // namespace spume
