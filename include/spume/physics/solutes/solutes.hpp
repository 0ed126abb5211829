// SPDX-License-Identifier: MIT
// All that the liquid of a particle method carries, as far as a case names it: scalars, oxygen, sludge. A method that
// carries them names their sections, calls their checks, and has four stages behind those that accept a step:
// "scalars", "oxygen", "reactions" and "record of the flow"; while that carries, "recorded flow" is its only one.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "spume/physics/biokinetics/sludge.hpp"
#include "spume/physics/oxygen/oxygen.hpp"
#include "spume/physics/oxygen/rigid_bubbles.hpp"
#include "spume/physics/recorded_flow/recorded_flow.hpp"
#include "spume/physics/scalars/scalars.hpp"

namespace spume {

struct SoluteFeatures {
  explicit SoluteFeatures(const Case& options);
  bool scalars = false, oxygen = false, biokinetics = false, recorded_flow = false;
};

struct Solutes {
  // Adds fields of state per scalar. All outlive it.
  Solutes(ParticleStore& particles, const Resolution& resolution, const Case& options, const Scene& scene);

  // Null: none.
  std::unique_ptr<Scalars> scalars;
  std::unique_ptr<oxygen::Oxygen> oxygen;
  std::unique_ptr<oxygen::RigidBubbles> rigid_bubbles;
  std::unique_ptr<biokinetics::Sludge> sludge;
  std::unique_ptr<RecordedFlow> recorded;

  std::size_t count() const { return scalars == nullptr ? 0 : scalars->size(); }

  // Over dt up to the time t, of released bodies; the particles as they are then.
  void take_from_rigid_bubbles(ParticleStore& particles, double t, double dt);

  // Whether the flow stands still and its record carries.
  bool record_carries() const { return recorded != nullptr && recorded->carries(); }
  // Of a step of dt up to t; `bubbles`: discrete ones, null without.
  void record(double t, double dt, const oxygen::Supply* bubbles) { recorded->record(t, dt, supply(bubbles)); }
  const oxygen::Supply* supply(const oxygen::Supply* bubbles) const {
    return bubbles != nullptr ? bubbles : rigid_bubbles.get();
  }

  // `bubbles`: discrete ones; null without.
  void add_columns(SeriesTable& series, const oxygen::Supply* bubbles) const;
  void save(StateWriter& writer) const;
  void load(StateReader& reader);
};

std::vector<Section> solute_sections();
// `taken`: output fields that the method has beside them.
void check_solutes(Draft& draft, const std::vector<std::string>& taken, Problems& problems);

}  // namespace spume
