// SPDX-License-Identifier: MIT
// Wavemakers that turn about a hinge at the bed: a half-space behind the flap, as a body with a given angle.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "checks.hpp"
#include "spume/geometry/shapes.hpp"
#include "spume/scene/expression.hpp"
#include "spume/scene/option.hpp"
#include "wavemakers.hpp"

namespace spume {
namespace {

// In degrees, of a flap that is at x at the still surface.
class FlapAngle final : public Expression {
 public:
  FlapAngle(std::shared_ptr<const PistonMotion> motion, double depth, double direction)
      : motion_(std::move(motion)), depth_(depth), direction_(direction) {}
  double operator()(double, double, double, double t) const override {
    // Differences of the angle around the start ask for times before it.
    return direction_ * std::atan(motion_->displacement(std::max(t, 0.0)) / depth_) * 180 / std::numbers::pi;
  }
  std::unique_ptr<Expression> clone() const override { return std::make_unique<FlapAngle>(*this); }

 private:
  std::shared_ptr<const PistonMotion> motion_;
  double depth_, direction_;
};

}  // namespace

std::vector<std::shared_ptr<const PistonMotion>> add_flaps(const Draft& draft, Scene& scene, Problems& problems) {
  std::vector<std::shared_ptr<const PistonMotion>> motions;
  const Domain& domain = scene.domain;
  const int up = domain.dimensions - 1;
  for (std::size_t k = 0; k < draft.wavemakers.size(); ++k) {
    const WavemakerDraft& one = draft.wavemakers[k];
    if (one.kind != WavemakerKind::flap) continue;
    const bool left = one.side == "left";
    const double side = (left ? domain.lower : domain.upper)[0], inwards = left ? 1 : -1;
    Wavemaker maker;
    maker.name = "wavemaker." + std::to_string(k);
    maker.side = one.side;
    maker.depth = *one.depth;
    maker.height = one.waves == WaveKind::focused ? 2 * *one.amplitude : *one.height;
    maker.hinge = one.hinge.value_or(side);
    auto motion = wavemaker_motion(one, maker, scene, draft.options.time.end);
    find_wavemaker_extremes(*motion, draft.options.time.end, maker);
    // Wall points stand as deep as the support behind the flap; at the top of the domain it swings farthest back.
    const double room = support_ratio(draft.options.resolution) * scene.spacing -
                        maker.smallest_displacement * (domain.upper[up] - domain.lower[up]) / maker.depth;
    if (one.hinge) {
      if (const double given = inwards * (*one.hinge - side); given < room)
        problems.add(*draft.node(maker.name + ".hinge"), maker.name + ".hinge is " + brief(given) + " from the " +
                                                             one.side + " side, and the flap needs " + brief(room) +
                                                             " to swing back; move it, or remove the key");
    } else {
      // Whole spacings of the lattice, so that columns of particles stand as before a side.
      const double length = domain.upper[0] - domain.lower[0], step = length / std::round(length / scene.spacing);
      maker.hinge = side + inwards * step * std::ceil(room / step);
      if (one.waves == WaveKind::focused)
        motion = wavemaker_motion(one, maker, scene, draft.options.time.end);  // the way to the focus
    }
    const ShapePointer half = make_half_space({inwards, 0, 0}, domain.dimensions);
    Pose pose;
    pose.position = {maker.hinge, 0, 0};
    pose.position[static_cast<std::size_t>(up)] = domain.lower[up];
    const ShapePointer shape = place(half, pose, true, domain.dimensions);
    BodyMotion turning;
    turning.bodies = {scene.bodies.size()};
    turning.pivot = pose.position;
    // A positive angle leads from z to x about y, and from x to y about z.
    turning.axis = up == 2 ? Vec3{0, 1, 0} : Vec3{0, 0, -1};
    motions.push_back(motion);
    turning.angle = std::make_shared<FlapAngle>(motion, maker.depth, inwards);
    turning.time_scale = 2 * std::numbers::pi / maker.angular_frequency;
    scene.bodies.push_back({.name = maker.name,
                            .kind = "flap",
                            .shape = shape,
                            .solid = shape,
                            .wall = domain.sides[0][left ? 0 : 1].kind,
                            .motion = scene.motions.size(),
                            .alone = shape});
    scene.motions.push_back(std::move(turning));
  }
  return motions;
}

}  // namespace spume
