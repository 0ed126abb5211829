// SPDX-License-Identifier: MIT
#include "wavemakers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "checks.hpp"
#include "spume/core/parallel.hpp"
#include "spume/scene/option.hpp"
#include "spume/scene/second_order_waves.hpp"
#include "spume/scene/wave_theory.hpp"

namespace spume {
namespace {

using std::numbers::pi;

// The velocity of a side along x. It has one value at a time: a clone keeps the last.
class PistonVelocity final : public Expression {
 public:
  PistonVelocity(std::shared_ptr<const PistonMotion> motion, double direction)
      : motion_(std::move(motion)), direction_(direction) {}
  double operator()(double, double, double, double t) const override {
    if (t != time_) {
      time_ = t;
      velocity_ = direction_ * motion_->velocity(t);
    }
    return velocity_;
  }
  std::unique_ptr<Expression> clone() const override { return std::make_unique<PistonVelocity>(*this); }

 private:
  std::shared_ptr<const PistonMotion> motion_;
  double direction_;
  mutable double time_ = std::numeric_limits<double>::quiet_NaN(), velocity_ = 0;
};

// Depth and bed of the liquid within five spacings of a wall, from its bed to its surface: exact for columns that are
// evenly filled. 0: there is none.
void find_still_water(const Scene& scene, double wall, Wavemaker& maker) {
  const InitialParticles& particles = scene.particles;
  const auto up = static_cast<std::size_t>(scene.domain.dimensions) - 1;
  constexpr double none = -std::numeric_limits<double>::infinity();
  const auto highest = [&](double sign) {
    return parallel_max(particles.size(), none, [&](std::size_t i) {
      const bool near = std::abs(particles.position[0][i] - wall) < 5 * scene.spacing;
      return near ? sign * particles.position[up][i] : none;
    });
  };
  const double lowest = -highest(-1), way = highest(1) - lowest;  // from the lowest layer to the uppermost
  if (!(way >= 0)) return;
  const double layers = std::round(way / scene.spacing) + 1;
  maker.still_depth = layers > 1 ? way * layers / (layers - 1) : scene.spacing;
  maker.bed = lowest - maker.still_depth / layers / 2;
}

void check_motion(const Draft& draft, const Scene& scene, const Wavemaker& maker, Problems& problems) {
  const Node& node = *draft.node(maker.name);
  // Liquid between walls needs two supports and a spacing of room (check_resolution).
  const double room =
      scene.domain.upper[0] - scene.domain.lower[0] - (2 * support_ratio(draft.options.resolution) + 1) * scene.spacing;
  // What it absorbs may be all of what it makes.
  const double farthest = maker.largest_displacement * (maker.absorbs ? 2 : 1);
  if (!(farthest < room))
    problems.add(node, maker.name + " would move its wall by " + brief(farthest) +
                           " into the liquid, which has room for " + brief(std::max(room, 0.0)) +
                           "; make the waves lower or shorter, or the domain longer");
  // Half the sound speed is what a weakly compressible liquid may reach at all.
  const double c = scene.fluid.sound_speed;
  if (c > 0 && !(maker.largest_speed <= c / 2))
    problems.add(node, maker.name + " would move its wall with " + brief(maker.largest_speed) +
                           ", more than half the sound speed " + brief(c) +
                           "; make the waves lower or longer, or raise the sound speed");
}

// Of waves that have a period; 0: there are none.
double frequency_of_first(const Draft& draft) {
  for (const WavemakerDraft& maker : draft.wavemakers)
    if (maker.waves != WaveKind::none && maker.waves != WaveKind::solitary && maker.period)
      return 2 * pi / *maker.period;
  return 0;
}

const char* name_of(WaveKind kind) {
  switch (kind) {
    case WaveKind::none:
      return "no";
    case WaveKind::jonswap:
      return "jonswap";
    case WaveKind::focused:
      return "focused";
    case WaveKind::solitary:
      return "solitary";
    case WaveKind::regular:
      break;
  }
  return "regular";
}

}  // namespace

std::shared_ptr<const PistonMotion> wavemaker_motion(const WavemakerDraft& draft, Wavemaker& maker, const Scene& scene,
                                                     double end) {
  const double gravity = gravity_of(scene), depth = maker.depth;
  if (draft.waves == WaveKind::none) {
    if (draft.period) maker.angular_frequency = 2 * pi / *draft.period;
    if (maker.angular_frequency > 0) maker.wavenumber = wavenumber(maker.angular_frequency, depth, gravity);
    return std::make_shared<OscillatingPiston>(std::vector<Oscillation>{}, 0);
  }
  if (draft.waves == WaveKind::solitary) {
    const SolitaryWave wave(*draft.height, depth, gravity);
    maker.wavenumber = wave.decay;
    maker.angular_frequency = wave.decay * wave.speed;
    return std::make_shared<SolitaryPiston>(wave);
  }
  const double period = *draft.period, w = 2 * pi / period;
  maker.angular_frequency = w;
  maker.wavenumber = wavenumber(w, depth, gravity);
  const auto count = static_cast<std::size_t>(draft.components);
  const auto transfer = draft.kind == WavemakerKind::flap ? flap_transfer : piston_transfer;
  std::vector<Oscillation> motion;
  if (draft.waves == WaveKind::regular) {
    motion = piston_motion({{maker.height / 2, w, 0}}, depth, gravity, transfer);
  } else if (draft.waves == WaveKind::jonswap) {
    motion = piston_motion(
        jonswap_waves(maker.height, period, draft.gamma, count, scene.seed, static_cast<std::uint32_t>(draft.seed)),
        depth, gravity, transfer);
  } else {
    const double wall = draft.kind == WavemakerKind::flap ? maker.hinge
                        : maker.side == "left"            ? scene.domain.lower[0]
                                                          : scene.domain.upper[0];
    const double way = std::abs(*draft.focus_place - wall);
    motion = piston_motion(
        focused_waves(*draft.amplitude, period, draft.gamma, count, way, *draft.focus_time, depth, gravity), depth,
        gravity, transfer);
  }
  std::shared_ptr<const TabulatedOscillations> second;
  if (takes_second_order(draft))
    second = std::make_shared<TabulatedOscillations>(second_order_motion(motion, draft.kind, depth, gravity), end);
  return std::make_shared<OscillatingPiston>(std::move(motion), draft.ramp.value_or(2 * period), std::move(second));
}

// Sampled at least forty times in a period, of a spectrum that of its peak: extremes are 1 % off at most.
void find_wavemaker_extremes(const PistonMotion& motion, double end, Wavemaker& maker) {
  const double wanted = end * maker.angular_frequency / (2 * pi) * 40;
  const auto samples = static_cast<std::size_t>(std::clamp(wanted, 1000.0, 100000.0));
  double lowest = 0, highest = 0;
  for (std::size_t i = 0; i <= samples; ++i) {
    const double t = end * static_cast<double>(i) / static_cast<double>(samples), x = motion.displacement(t);
    lowest = std::min(lowest, x);
    highest = std::max(highest, x);
    maker.largest_speed = std::max(maker.largest_speed, std::abs(motion.velocity(t)));
  }
  maker.stroke = highest - lowest;
  maker.largest_displacement = highest;
  maker.smallest_displacement = lowest;
}

std::vector<Wavemaker> make_wavemakers(const Draft& draft, Scene& scene,
                                       const std::vector<std::shared_ptr<const PistonMotion>>& of_flaps,
                                       Problems& problems) {
  std::vector<Wavemaker> made;
  for (std::size_t k = 0; k < draft.wavemakers.size(); ++k) {
    const WavemakerDraft& one = draft.wavemakers[k];
    Wavemaker maker;
    maker.name = entry("wavemaker", k);
    maker.side = one.side;
    const int end = one.side == "left" ? 0 : 1;
    double wall = (end == 0 ? scene.domain.lower : scene.domain.upper)[0];
    // The last bodies are those of the flaps, in their order.
    const auto flaps_left = static_cast<std::size_t>(
        std::count_if(draft.wavemakers.begin() + static_cast<std::ptrdiff_t>(k), draft.wavemakers.end(),
                      [](const WavemakerDraft& other) { return other.kind == WavemakerKind::flap; }));
    if (one.kind == WavemakerKind::flap) wall = maker.hinge = scene.motions[scene.motions.size() - flaps_left].pivot[0];
    find_still_water(scene, wall, maker);
    if (!(maker.still_depth > 0)) {
      problems.add(*draft.node(maker.name), maker.name +
                                                " has no liquid beside its wall; fill the domain there, or "
                                                "choose the other side");
      continue;
    }
    maker.depth = one.depth.value_or(maker.still_depth);
    maker.height = one.waves == WaveKind::focused ? 2 * *one.amplitude : one.height.value_or(0);
    maker.absorbs = one.absorption != AbsorptionKind::none;
    if (one.waves == WaveKind::none) maker.angular_frequency = frequency_of_first(draft);
    WavemakerDraft of_order = one;
    if (one.kind == WavemakerKind::flap) of_order.order = 1;  // the motion is known: its frequencies are meant
    auto motion = wavemaker_motion(of_order, maker, scene, draft.options.time.end);
    if (one.kind == WavemakerKind::flap) motion = of_flaps[of_flaps.size() - flaps_left];
    find_wavemaker_extremes(*motion, draft.options.time.end, maker);
    check_motion(draft, scene, maker, problems);
    if (one.kind == WavemakerKind::flap) {
      made.push_back(maker);
      continue;
    }
    VectorExpression velocity;
    velocity.component[0] = std::make_shared<PistonVelocity>(motion, end == 0 ? 1 : -1);
    Side& side = scene.domain.sides[0][static_cast<std::size_t>(end)];
    side.velocity = std::move(velocity);
    if (maker.absorbs) side.absorption = wave_absorption(one, maker, *motion, scene);
    made.push_back(maker);
  }
  return made;
}

std::vector<Sponge> make_sponges(const Draft& draft, const std::vector<Wavemaker>& wavemakers) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Wavemaker& maker : wavemakers)
    if (maker.angular_frequency > 0) lowest = std::min(lowest, maker.angular_frequency);
  // Long-wave theory of a layer before a wall: at 3 w this profile sends back 6, 2, and 0.2 % of a wave from a layer of
  // 0.5, 1 and 1.5 wavelengths; at 2 w it is 11, 3 and 0.1 %, at 6 w 22, 7 and 2 %.
  constexpr double best_strength = 3;
  std::vector<Sponge> made;
  for (const SpongeDraft& one : draft.sponges) {
    const auto [axis, end] = side_place(one.side, draft.dimensions);
    made.push_back({axis, end, one.length, one.strength.value_or(best_strength * lowest), to_vec3(one.velocity)});
  }
  return made;
}

void describe_waves(const Draft& draft, const Scene& scene, const std::vector<Wavemaker>& wavemakers,
                    std::map<std::string, std::string>& groups) {
  for (std::size_t k = 0; k < wavemakers.size(); ++k) {
    const Wavemaker& maker = wavemakers[k];
    const WaveKind kind = draft.wavemakers[k].waves;
    const double length = 2 * pi / maker.wavenumber, kh = maker.wavenumber * maker.depth;
    std::string text = name_of(kind) + std::string(" waves, ");
    if (kind == WaveKind::solitary)
      text += "kappa h " + brief(kh) + ", height / depth " + brief(maker.height / maker.depth) + ", ";
    else if (kind != WaveKind::none)
      text += "wavelength " + brief(length) + ", kh " + brief(kh) + ", steepness H/L " + brief(maker.height / length) +
              ", ";
    if (kind != WaveKind::none)
      text += brief(maker.height / scene.spacing) + " spacings high; stroke " + brief(maker.stroke) +
              ", largest speed " + brief(maker.largest_speed) + ", ";
    text += "depth " + brief(maker.depth);
    if (maker.absorbs)
      text += "; absorbs: " +
              describe_absorption(*scene.domain.sides[0][maker.side == "left" ? 0 : 1].absorption, kind, maker, scene);
    if (draft.wavemakers[k].kind == WavemakerKind::flap)
      text += "; flap with its hinge at x = " + brief(maker.hinge) + ", turns by up to " +
              brief(std::atan(maker.stroke / 2 / maker.depth) * 180 / pi) + " degrees";
    groups["wavemaker " + maker.side] = text;
  }
  for (std::size_t k = 0; k < scene.sponges.size(); ++k) {
    const Sponge& sponge = scene.sponges[k];
    std::string text = "length " + brief(sponge.length);
    if (!wavemakers.empty() && wavemakers[0].wavenumber > 0 && draft.wavemakers[0].waves != WaveKind::solitary)
      text += " (" + brief(sponge.length * wavemakers[0].wavenumber / (2 * pi)) + " wavelengths)";
    groups["sponge " + draft.sponges[k].side] = text + ", strength " + brief(sponge.strength);
  }
}

}  // namespace spume
