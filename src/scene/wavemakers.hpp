// SPDX-License-Identifier: MIT
// From the [[wavemaker]] and [[sponge]] entries of a case to moving sides and damping layers of the scene.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "spume/scene/draft.hpp"
#include "spume/scene/wave_absorption.hpp"
#include "spume/scene/wave_theory.hpp"

namespace spume {

inline std::string entry(const char* section, std::size_t k) {
  return std::string(section) + "." + std::to_string(k);
}
inline double gravity_of(const Scene& scene) {
  return -scene.fluid.gravity[static_cast<std::size_t>(scene.domain.dimensions) - 1];
}

// What a wavemaker makes, and how far and fast it moves for it until the end of the run.
struct Wavemaker {
  std::string name;  // "wavemaker.0"
  std::string side;
  double depth = 0, still_depth = 0;  // that the theory takes, and that of the liquid beside the wall at the start
  double height = 0;                  // of the waves; of jonswap significant, of focused twice the crest
  // Of jonswap and focused waves at the peak, of a solitary wave kappa c; of a wall that only absorbs what it is tuned
  // to, or 0.
  double angular_frequency = 0;
  double wavenumber = 0;                                           // at that frequency; of a solitary wave kappa
  double stroke = 0, largest_displacement = 0, largest_speed = 0;  // of a flap at the still surface
  double smallest_displacement = 0;                                // out of the liquid, below zero
  double hinge = 0;                                                // x of a flap
  double bed = 0;                                                  // height of the bed beside the wall
  bool absorbs = false;
};

// A wavemaker needs a wall that nothing else moves, gravity, and what its waves are described by; a sponge a side.
void check_wavemakers(const Draft& draft, Problems& problems);
void check_sponges(const Draft& draft, Problems& problems);

// The motion that makes the waves on the depth of `maker`, of a flap at the still surface. Sets frequency and
// wavenumber. `end` of the run.
std::shared_ptr<const PistonMotion> wavemaker_motion(const WavemakerDraft& draft, Wavemaker& maker, const Scene& scene,
                                                     double end);
// Their pairs take seven seconds of processor time.
constexpr std::int64_t most_of_second_order = 300;
inline bool takes_second_order(const WavemakerDraft& draft) {
  const bool sum = draft.waves == WaveKind::jonswap || draft.waves == WaveKind::focused;
  return draft.order != 1 && (draft.waves == WaveKind::regular || (sum && draft.components <= most_of_second_order));
}
void find_wavemaker_extremes(const PistonMotion& motion, double end, Wavemaker& maker);

inline FaceOfPiston face_of(const Wavemaker& maker, const Scene& scene) {
  return {maker.depth, gravity_of(scene), gauge_columns * scene.spacing / 2};
}
// How it takes up waves beside those that it makes with `motion`. A wall that makes none is tuned to its period, else
// to that of the first wavemaker that has one; without either its law is that of long waves, as beside solitary waves.
WaveAbsorption wave_absorption(const WavemakerDraft& draft, const Wavemaker& maker, const PistonMotion& motion,
                               const Scene& scene);
// The reflection that linear theory expects, in words.
std::string describe_absorption(const WaveAbsorption& absorption, WaveKind waves, const Wavemaker& maker,
                                const Scene& scene);

// Adds the walls of flaps to the bodies, behind all others: solids from the flap to its side, which turn about the
// hinge. The scene has its domain, its fluid and its other bodies. Returns their motions, in their order: of hundreds
// of components those of second order take seconds.
std::vector<std::shared_ptr<const PistonMotion>> add_flaps(const Draft& draft, Scene& scene, Problems& problems);

// Sets the velocities of the sides; `of_flaps` as add_flaps() returns them. The scene has its particles: the still
// water is measured beside the wall.
std::vector<Wavemaker> make_wavemakers(const Draft& draft, Scene& scene,
                                       const std::vector<std::shared_ptr<const PistonMotion>>& of_flaps,
                                       Problems& problems);
std::vector<Sponge> make_sponges(const Draft& draft, const std::vector<Wavemaker>& wavemakers);

// For the start-up table.
void describe_waves(const Draft& draft, const Scene& scene, const std::vector<Wavemaker>& wavemakers,
                    std::map<std::string, std::string>& groups);

// Waves that break or are beyond the theory, a depth that is not that of the still water, sponges too short to absorb.
std::vector<Problem> wave_warnings(const Draft& draft, const Scene& scene, const std::vector<Wavemaker>& wavemakers,
                                   const std::string& file);

}  // namespace spume
