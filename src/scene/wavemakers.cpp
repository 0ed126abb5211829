// SPDX-License-Identifier: MIT
#include "wavemakers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "checks.hpp"
#include "spume/core/parallel.hpp"
#include "spume/scene/option.hpp"
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

std::string entry(const char* section, std::size_t k) {
  return std::string(section) + "." + std::to_string(k);
}

double gravity_of(const Scene& scene) {
  return -scene.fluid.gravity[static_cast<std::size_t>(scene.domain.dimensions) - 1];
}

bool gives_gravity(const Draft& draft) {
  return draft.fluid.froude || draft.fluid.gravity.value_or(0) > 0;
}

class CheckWavemaker {
 public:
  CheckWavemaker(const Draft& draft, std::size_t k, Problems& problems)
      : draft_(draft),
        maker_(draft.wavemakers[k]),
        name_(entry("wavemaker", k)),
        node_(*draft.node(name_)),
        problems_(problems) {}

  void side(std::set<std::string>& taken) {
    if (!draft_.usable(name_ + ".side")) return;
    const Node& node = *draft_.node(name_ + ".side");
    const std::string& side = maker_.side;
    const auto kind = draft_.sides.find(side);
    if (!taken.insert(side).second) problems_.add(node, "another wavemaker moves the " + side + " wall already");
    if ((kind == draft_.sides.end() || kind->second == BoundaryKind::open) && draft_.usable("domain." + side))
      problems_.add(node, name_ + " moves a side that is not a wall; add  " + side + " = \"free-slip\"  to [domain]");
    if (draft_.wall_velocity.count(side))
      problems_.add(node, name_ + " and domain.wall_velocity." + side + " move the same wall; remove one of the two");
  }

  void waves() {
    if (!gives_gravity(draft_))
      problems_.add(node_, name_ +
                               " needs gravity, without which there are no waves; add  gravity = <number>  or  "
                               "froude = <number>  to [fluid]");
    if (!draft_.usable(name_ + ".waves")) return;
    const WaveKind kind = maker_.waves;
    const bool focused = kind == WaveKind::focused;
    need("height", !focused && !maker_.height, "length");
    need("amplitude", focused && !maker_.amplitude, "length");
    need("period", kind != WaveKind::solitary && !maker_.period, "time");
    need("focus_place", focused && !maker_.focus_place, "length");
    need("focus_time", focused && !maker_.focus_time, "time");
    if (maker_.kind == WavemakerKind::flap) flap();
    if (maker_.order == 2 && (kind == WaveKind::jonswap || focused))
      problems_.add(*draft_.node(name_ + ".order"),
                    name_ + ".order is 2, and for sums of waves there is the theory of first order only; remove it");
    if (focused && maker_.focus_place && draft_.dimensions > 0 &&
        !(*maker_.focus_place > draft_.lower[0] && *maker_.focus_place < draft_.upper[0]))
      problems_.add(*draft_.node(name_ + ".focus_place"),
                    name_ + ".focus_place lies outside the domain: x = " + brief(*maker_.focus_place) +
                        ", the domain's x from " + brief(draft_.lower[0]) + " to " + brief(draft_.upper[0]));
  }

 private:
  // The stroke of a flap must be known before there is liquid beside it.
  void flap() {
    need("depth", !maker_.depth, "length");
    if (maker_.waves == WaveKind::solitary)
      problems_.add(*draft_.node(name_ + ".waves"),
                    name_ + ".waves is \"solitary\", which need a piston; set  kind = \"piston\"");
    if (maker_.order == 2)
      problems_.add(*draft_.node(name_ + ".order"),
                    name_ + ".order is 2, and for flaps there is the theory of first order only; remove it");
    if (draft_.dimensions > 0 && maker_.depth &&
        !(*maker_.depth < draft_.upper[static_cast<std::size_t>(draft_.dimensions) - 1] -
                              draft_.lower[static_cast<std::size_t>(draft_.dimensions) - 1]))
      problems_.add(*draft_.node(name_ + ".depth"), name_ + ".depth must be less than the height of the domain");
  }
  void need(const char* key, bool missing, const char* unit) {
    if (missing && !draft_.node(name_ + "." + key))
      problems_.add(node_,
                    std::string("missing key '") + key + "' in [[wavemaker]]; add  " + key + " = <number>  # " + unit);
  }

  const Draft& draft_;
  const WavemakerDraft& maker_;
  std::string name_;
  const Node& node_;
  Problems& problems_;
};

// Depth of the liquid within five spacings of a wall, from its bed to its surface: exact for columns that are evenly
// filled. 0: there is none.
double still_depth_beside(const Scene& scene, double wall) {
  const InitialParticles& particles = scene.particles;
  const auto up = static_cast<std::size_t>(scene.domain.dimensions) - 1;
  constexpr double none = -std::numeric_limits<double>::infinity();
  const auto highest = [&](double sign) {
    return parallel_max(particles.size(), none, [&](std::size_t i) {
      const bool near = std::abs(particles.position[0][i] - wall) < 5 * scene.spacing;
      return near ? sign * particles.position[up][i] : none;
    });
  };
  const double way = highest(1) + highest(-1);  // from the lowest layer to the uppermost
  if (!(way >= 0)) return 0;
  const double layers = std::round(way / scene.spacing) + 1;
  return layers > 1 ? way * layers / (layers - 1) : scene.spacing;
}

void check_motion(const Draft& draft, const Scene& scene, const Wavemaker& maker, Problems& problems) {
  const Node& node = *draft.node(maker.name);
  // Liquid between walls needs two supports and a spacing of room (check_resolution).
  const double room =
      scene.domain.upper[0] - scene.domain.lower[0] - (2 * support_ratio(draft.options.resolution) + 1) * scene.spacing;
  if (!(maker.largest_displacement < room))
    problems.add(node, maker.name + " would move its wall by " + brief(maker.largest_displacement) +
                           " into the liquid, which has room for " + brief(std::max(room, 0.0)) +
                           "; make the waves lower or shorter, or the domain longer");
  // Half the sound speed is what a weakly compressible liquid may reach at all.
  const double c = scene.fluid.sound_speed;
  if (c > 0 && !(maker.largest_speed <= c / 2))
    problems.add(node, maker.name + " would move its wall with " + brief(maker.largest_speed) +
                           ", more than half the sound speed " + brief(c) +
                           "; make the waves lower or longer, or raise the sound speed");
}

const char* name_of(WaveKind kind) {
  switch (kind) {
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

class WarnOfWaves {
 public:
  WarnOfWaves(const Draft& draft, const Scene& scene, const std::string& file)
      : draft_(draft), scene_(scene), file_(file) {}

  // The limits are those of McCowan (1894) for a solitary wave and of Miche (1944) for periodic ones.
  void maker(const Wavemaker& maker, const WavemakerDraft& draft) {
    const Node* height = draft_.node(maker.name + (draft.waves == WaveKind::focused ? ".amplitude" : ".height"));
    const std::string what = draft.waves == WaveKind::jonswap   ? "the significant wave height "
                             : draft.waves == WaveKind::focused ? "twice the amplitude, "
                                                                : "the wave height ";
    const double kh = maker.wavenumber * maker.depth, steepness = maker.height * maker.wavenumber / (2 * pi);
    constexpr double highest = 0.78, steepest = 0.14;
    if (maker.height > highest * maker.depth)
      warn(*height, what + brief(maker.height) + " is " + brief(maker.height / maker.depth) +
                        " of the depth; waves break above " + brief(highest) + ": lower it");
    else if (draft.waves != WaveKind::solitary && steepness > steepest * std::tanh(kh))
      warn(*height, what + brief(maker.height) + " is " + brief(steepness) +
                        " of the wavelength; waves break above 0.14 tanh kh = " + brief(steepest * std::tanh(kh)) +
                        ": lower it, or make the period longer");
    if (draft.waves == WaveKind::regular && draft.order != 1 && draft.kind == WavemakerKind::piston &&
        madsen_number(maker.height, maker.wavenumber, maker.depth) > 1)
      warn(*height, "waves of height " + brief(maker.height) +
                        " are too long for second-order theory: H L^2 / h^3 is " +
                        brief(8 * pi * pi / 3 * madsen_number(maker.height, maker.wavenumber, maker.depth)) +
                        " and should be below 8 pi^2 / 3 = 26.3; free waves will go with them: lower the height or "
                        "the period");
    // The surface is known to half a spacing.
    if (std::abs(maker.depth - maker.still_depth) > scene_.spacing / 2)
      warn(*draft_.node(maker.name + ".depth"), maker.name + ".depth is " + brief(maker.depth) +
                                                    ", and the liquid beside the wall is " + brief(maker.still_depth) +
                                                    " deep; remove the key to take that");
  }

  void sponge(const Sponge& sponge, std::size_t k, const Wavemaker& maker) {
    const double length = 2 * pi / maker.wavenumber;
    const std::string name = entry("sponge", k);
    if (sponge.axis == 0 && draft_.sponges[k].side == maker.side)
      warn(*draft_.node(name + ".side"),
           name + " damps the waves where " + maker.name + " makes them; put it at the other end");
    else if (sponge.length < length / 2)
      warn(*draft_.node(name + ".length"), name + ".length is " + brief(sponge.length / length) +
                                               " wavelengths; below 0.5 more than 6 % of a wave comes back: make it " +
                                               brief(length) + " or longer");
  }

  std::vector<Problem> warnings;

 private:
  void warn(const Node& node, const std::string& text) {
    warnings.push_back(node.override_text.empty() ? Problem{file_, node.place.line, node.place.column, text}
                                                  : Problem{node.override_text, 0, 0, text});
  }
  const Draft& draft_;
  const Scene& scene_;
  const std::string& file_;
};

}  // namespace

std::shared_ptr<const PistonMotion> wavemaker_motion(const WavemakerDraft& draft, Wavemaker& maker,
                                                     const Scene& scene) {
  const double gravity = gravity_of(scene), depth = maker.depth;
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
    const double kh = maker.wavenumber * depth;
    motion = piston_motion({{maker.height / 2, w, 0}}, depth, gravity, transfer);
    if (draft.order != 1 && draft.kind == WavemakerKind::piston)
      motion.push_back({piston_second_amplitude(maker.height, kh, depth), 2 * w, 0});
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
  return std::make_shared<OscillatingPiston>(std::move(motion), draft.ramp.value_or(2 * period));
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

void check_wavemakers(const Draft& draft, Problems& problems) {
  if (!draft.usable("wavemaker")) return;
  std::set<std::string> taken;
  for (std::size_t k = 0; k < draft.wavemakers.size(); ++k) {
    CheckWavemaker check(draft, k, problems);
    check.side(taken);
    check.waves();
  }
}

void check_sponges(const Draft& draft, Problems& problems) {
  if (draft.dimensions == 0 || !draft.usable("sponge")) return;
  std::set<std::string> taken;
  for (std::size_t k = 0; k < draft.sponges.size(); ++k) {
    const SpongeDraft& sponge = draft.sponges[k];
    const std::string name = entry("sponge", k);
    if (!draft.usable(name + ".side")) continue;
    const Node& node = *draft.node(name + ".side");
    const auto [axis, end] = side_place(sponge.side, draft.dimensions);
    if (axis < 0) {
      problems.add(node, name + ".side: a 2-D domain has left, right, bottom, top");
      continue;
    }
    const auto a = static_cast<std::size_t>(axis);
    if (draft.periodic[a])
      problems.add(node, name + ".side is a side of the periodic direction " + std::string(1, "xyz"[a]) +
                             ", which has none; choose another side");
    if (!taken.insert(sponge.side).second)
      problems.add(node, "another sponge lies at the side " + sponge.side + " already; keep one of them");
    const double room = draft.upper[a] - draft.lower[a];
    if (draft.usable(name + ".length") && sponge.length > room)
      problems.add(*draft.node(name + ".length"), name + ".length is " + brief(sponge.length) +
                                                      ", longer than the domain, which is " + brief(room) +
                                                      " long in " + std::string(1, "xyz"[a]));
    const auto wanted = static_cast<std::size_t>(draft.dimensions);
    if (const Node* given = draft.node(name + ".velocity");
        given && sponge.velocity.size() != wanted && draft.usable(name + ".velocity"))
      problems.add(*given, name + ".velocity must have " + std::to_string(wanted) + " entries in a " +
                               std::to_string(wanted) + "-D domain, found " + std::to_string(sponge.velocity.size()));
    if (!draft.node(name + ".strength") && draft.wavemakers.empty())
      problems.add(*draft.node(name), name +
                                          " has no strength, and there is no wavemaker to take it from; add  "
                                          "strength = <number>  # 1/time, about three times the angular frequency "
                                          "of the waves");
  }
}

std::vector<Wavemaker> make_wavemakers(const Draft& draft, Scene& scene, Problems& problems) {
  std::vector<Wavemaker> made;
  for (std::size_t k = 0; k < draft.wavemakers.size(); ++k) {
    const WavemakerDraft& one = draft.wavemakers[k];
    Wavemaker maker;
    maker.name = entry("wavemaker", k);
    maker.side = one.side;
    const int end = one.side == "left" ? 0 : 1;
    double wall = (end == 0 ? scene.domain.lower : scene.domain.upper)[0];
    if (one.kind == WavemakerKind::flap) {
      // The last bodies are those of the flaps, in their order.
      const auto flaps =
          std::count_if(draft.wavemakers.begin() + static_cast<std::ptrdiff_t>(k), draft.wavemakers.end(),
                        [](const WavemakerDraft& other) { return other.kind == WavemakerKind::flap; });
      wall = maker.hinge = scene.motions[scene.motions.size() - static_cast<std::size_t>(flaps)].pivot[0];
    }
    maker.still_depth = still_depth_beside(scene, wall);
    if (!(maker.still_depth > 0)) {
      problems.add(*draft.node(maker.name), maker.name +
                                                " has no liquid beside its wall; fill the domain there, or "
                                                "choose the other side");
      continue;
    }
    maker.depth = one.depth.value_or(maker.still_depth);
    maker.height = one.waves == WaveKind::focused ? 2 * *one.amplitude : *one.height;
    const auto motion = wavemaker_motion(one, maker, scene);
    find_wavemaker_extremes(*motion, draft.options.time.end, maker);
    check_motion(draft, scene, maker, problems);
    if (one.kind == WavemakerKind::flap) {
      made.push_back(maker);
      continue;
    }
    VectorExpression velocity;
    velocity.component[0] = std::make_shared<PistonVelocity>(motion, end == 0 ? 1 : -1);
    scene.domain.sides[0][static_cast<std::size_t>(end)].velocity = std::move(velocity);
    made.push_back(maker);
  }
  return made;
}

std::vector<Sponge> make_sponges(const Draft& draft, const std::vector<Wavemaker>& wavemakers) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Wavemaker& maker : wavemakers) lowest = std::min(lowest, maker.angular_frequency);
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
    text +=
        kind == WaveKind::solitary
            ? "kappa h " + brief(kh) + ", height / depth " + brief(maker.height / maker.depth)
            : "wavelength " + brief(length) + ", kh " + brief(kh) + ", steepness H/L " + brief(maker.height / length);
    text += ", " + brief(maker.height / scene.spacing) + " spacings high; stroke " + brief(maker.stroke) +
            ", largest speed " + brief(maker.largest_speed) + ", depth " + brief(maker.depth);
    if (draft.wavemakers[k].kind == WavemakerKind::flap)
      text += "; flap with its hinge at x = " + brief(maker.hinge) + ", turns by up to " +
              brief(std::atan(maker.stroke / 2 / maker.depth) * 180 / pi) + " degrees";
    groups["wavemaker " + maker.side] = text;
  }
  for (std::size_t k = 0; k < scene.sponges.size(); ++k) {
    const Sponge& sponge = scene.sponges[k];
    std::string text = "length " + brief(sponge.length);
    if (!wavemakers.empty() && draft.wavemakers[0].waves != WaveKind::solitary)
      text += " (" + brief(sponge.length * wavemakers[0].wavenumber / (2 * pi)) + " wavelengths)";
    groups["sponge " + draft.sponges[k].side] = text + ", strength " + brief(sponge.strength);
  }
}

std::vector<Problem> wave_warnings(const Draft& draft, const Scene& scene, const std::vector<Wavemaker>& wavemakers,
                                   const std::string& file) {
  WarnOfWaves of(draft, scene, file);
  for (std::size_t k = 0; k < wavemakers.size(); ++k) of.maker(wavemakers[k], draft.wavemakers[k]);
  for (std::size_t k = 0; k < scene.sponges.size(); ++k)
    for (const Wavemaker& maker : wavemakers) of.sponge(scene.sponges[k], k, maker);
  return std::move(of.warnings);
}

}  // namespace spume
