// SPDX-License-Identifier: MIT
// What a [[wavemaker]] or a [[sponge]] lacks, or cannot be.
#include <algorithm>
#include <set>

#include "checks.hpp"
#include "spume/scene/option.hpp"
#include "wavemakers.hpp"

namespace spume {
namespace {

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
    if (kind == WaveKind::none) {
      absorber();
      return;
    }
    if (maker_.absorption != AbsorptionKind::none && maker_.kind == WavemakerKind::flap)
      problems_.add(*draft_.node(name_ + ".absorption"),
                    name_ + ".absorption is for pistons; set  kind = \"piston\", or remove it");
    need("height", !focused && !maker_.height, "length");
    need("amplitude", focused && !maker_.amplitude, "length");
    need("period", kind != WaveKind::solitary && !maker_.period, "time");
    need("focus_place", focused && !maker_.focus_place, "length");
    need("focus_time", focused && !maker_.focus_time, "time");
    if (maker_.kind == WavemakerKind::flap) flap();
    if (maker_.order == 2 && kind != WaveKind::solitary && !takes_second_order(maker_))
      problems_.add(*draft_.node(name_ + ".components"), name_ + ".components is " + std::to_string(maker_.components) +
                                                             ", and theory of second order takes " +
                                                             std::to_string(most_of_second_order) +
                                                             " at most; lower it, or set  order = 1");
    if (focused && maker_.focus_place && draft_.dimensions > 0 &&
        !(*maker_.focus_place > draft_.lower[0] && *maker_.focus_place < draft_.upper[0]))
      problems_.add(*draft_.node(name_ + ".focus_place"),
                    name_ + ".focus_place lies outside the domain: x = " + brief(*maker_.focus_place) +
                        ", the domain's x from " + brief(draft_.lower[0]) + " to " + brief(draft_.upper[0]));
  }

 private:
  void absorber() {
    if (maker_.kind == WavemakerKind::flap)
      problems_.add(*draft_.node(name_ + ".kind"), name_ + " makes no waves, and a flap absorbs none; remove the key");
    else if (maker_.absorption == AbsorptionKind::none)
      problems_.add(node_, name_ + " makes no waves and absorbs none; add  absorption = \"tuned\"");
  }
  // The stroke of a flap must be known before there is liquid beside it.
  void flap() {
    need("depth", !maker_.depth, "length");
    if (maker_.waves == WaveKind::solitary)
      problems_.add(*draft_.node(name_ + ".waves"),
                    name_ + ".waves is \"solitary\", which need a piston; set  kind = \"piston\"");
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

}  // namespace

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
    const bool waves = std::any_of(draft.wavemakers.begin(), draft.wavemakers.end(), [](const WavemakerDraft& maker) {
      return maker.waves != WaveKind::none || maker.period;
    });
    if (!draft.node(name + ".strength") && !waves)
      problems.add(*draft.node(name), name +
                                          " has no strength, and no wavemaker has waves to take it from; add  "
                                          "strength = <number>  # 1/time, about three times the angular frequency "
                                          "of the waves");
  }
}

}  // namespace spume
