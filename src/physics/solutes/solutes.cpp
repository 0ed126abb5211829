// SPDX-License-Identifier: MIT
#include "spume/physics/solutes/solutes.hpp"

#include "spume/scene/case.hpp"

namespace spume {

SoluteFeatures::SoluteFeatures(const Case& options)
    : scalars(!options.get<ScalarOptions>().scalars.empty()),
      oxygen(options.get<OxygenOptions>().on),
      biokinetics(options.get<BiokineticsOptions>().on),
      recorded_flow(options.get<RecordedFlowOptions>().on) {}

Solutes::Solutes(ParticleStore& particles, const Resolution& resolution, const Case& options, const Scene& scene) {
  const SoluteFeatures has(options);
  if (has.scalars) {
    scalars = std::make_unique<Scalars>(particles, resolution, scene.domain, options.get<ScalarOptions>(),
                                        options.get<ScalarWalls>());
    if (!scene.openings.empty()) scalars->expect_openings();
  }
  if (has.oxygen) {
    oxygen = std::make_unique<oxygen::Oxygen>(*scalars, particles, resolution, options, scene);
    if (oxygen::RigidBubbles::exist(scene))
      rigid_bubbles = std::make_unique<oxygen::RigidBubbles>(scene, resolution, oxygen->gas());
  }
  if (has.biokinetics) sludge = std::make_unique<biokinetics::Sludge>(*scalars, options.get<BiokineticsOptions>());
  if (has.recorded_flow)
    recorded = std::make_unique<RecordedFlow>(particles, scene, options.get<RecordedFlowOptions>(), *scalars,
                                              oxygen.get(), sludge.get());
}

void Solutes::take_from_rigid_bubbles(ParticleStore& particles, double t, double dt) {
  ScratchArray<float> change(particles.scratch(), particles.size());
  const double given = rigid_bubbles->exchange(t, dt,
                                               {.size = particles.size(),
                                                .particle_volume = particles.volume,
                                                .places = particles.position,
                                                .velocity = particles.velocity,
                                                .dissolved = oxygen->dissolved(),
                                                .left_out = scalars->left_out()},
                                               change);
  oxygen->take_from_bubbles(change, given);
}

void Solutes::add_columns(SeriesTable& series, const oxygen::Supply* bubbles) const {
  if (scalars != nullptr) scalars->add_columns(series);
  if (rigid_bubbles != nullptr) rigid_bubbles->add_columns(series);
  if (oxygen != nullptr) oxygen->add_columns(series, supply(bubbles));
  if (sludge != nullptr) sludge->add_columns(series);
  if (recorded != nullptr) recorded->add_columns(series);
}

void Solutes::save(StateWriter& writer) const {
  if (scalars != nullptr) scalars->save(writer);
  if (oxygen != nullptr) oxygen->save(writer);
  if (rigid_bubbles != nullptr) rigid_bubbles->save(writer);
  if (sludge != nullptr) sludge->save(writer);
  if (recorded != nullptr) recorded->save(writer);
}

void Solutes::load(StateReader& reader) {
  if (scalars != nullptr) scalars->load(reader);
  if (oxygen != nullptr) oxygen->load(reader);
  if (rigid_bubbles != nullptr) rigid_bubbles->load(reader);
  if (sludge != nullptr) sludge->load(reader);
  if (recorded != nullptr) recorded->load(reader);
}

std::vector<Section> solute_sections() {
  return {scalar_section(), scalar_wall_section(), oxygen_section(), biokinetics_section(), recorded_flow_section()};
}

void check_solutes(Draft& draft, const std::vector<std::string>& taken, Problems& problems) {
  check_scalars(draft, taken, problems);
  check_oxygen(draft, problems);
  check_biokinetics(draft, problems);
  check_scalar_walls(draft, problems);
  check_recorded_flow(draft, problems);
}

}  // namespace spume
