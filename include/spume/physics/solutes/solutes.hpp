// SPDX-License-Identifier: MIT
// All that the liquid of a particle method carries, as far as a case names it: scalars, oxygen, sludge. A method that
// carries them names their sections, calls their checks, and has three stages behind those that accept a step:
// "scalars", "oxygen" and "reactions".
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "spume/physics/biokinetics/sludge.hpp"
#include "spume/physics/oxygen/oxygen.hpp"
#include "spume/physics/oxygen/rigid_bubbles.hpp"
#include "spume/physics/scalars/scalars.hpp"

namespace spume {

struct SoluteFeatures {
  explicit SoluteFeatures(const Case& options);
  bool scalars = false, oxygen = false, biokinetics = false;
};

struct Solutes {
  // Adds fields of state per scalar. All outlive it.
  Solutes(ParticleStore& particles, const Resolution& resolution, const Case& options, const Scene& scene);

  // Null: none.
  std::unique_ptr<Scalars> scalars;
  std::unique_ptr<oxygen::Oxygen> oxygen;
  std::unique_ptr<oxygen::RigidBubbles> rigid_bubbles;
  std::unique_ptr<biokinetics::Sludge> sludge;

  std::size_t count() const { return scalars == nullptr ? 0 : scalars->size(); }

  // Over dt up to the time t, of released bodies; the particles as they are then.
  void take_from_rigid_bubbles(ParticleStore& particles, double t, double dt);

  // `bubbles`: discrete ones; null without.
  void add_columns(SeriesTable& series, const oxygen::Supply* bubbles) const;
  void save(StateWriter& writer) const;
  void load(StateReader& reader);
};

std::vector<Section> solute_sections();
// `taken`: output fields that the method has beside them.
void check_solutes(Draft& draft, const std::vector<std::string>& taken, Problems& problems);

}  // namespace spume
