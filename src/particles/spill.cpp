// SPDX-License-Identifier: MIT
#include "spume/particles/spill.hpp"

#include <algorithm>
#include <utility>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/scene/document.hpp"

namespace spume {
namespace {

bool falls_along(const Scene& scene, int axis) {
  return axis == scene.domain.dimensions - 1 && scene.fluid.gravity[axis] < 0;
}

}  // namespace

Spill::Spill(const Scene& scene, const Walls& walls)
    : scene_(scene), walls_(walls), count_(std::max<std::size_t>(1, scene.phases.size())) {
  for (int axis = 0; axis < scene.domain.dimensions; ++axis)
    for (std::size_t end = 0; end < 2; ++end)
      possible_ =
          possible_ || (!scene.domain.sides[axis][end].bounds_liquid() && !(end == 1 && falls_along(scene, axis)));
}

bool Spill::has_left(const Liquid& liquid, std::size_t i) const {
  if (liquid.left_out != nullptr && (*liquid.left_out)[i] >= 0) return false;
  for (int axis = 0; axis < scene_.domain.dimensions; ++axis) {
    const double x = (*liquid.particles.position[axis])[i], lower = walls_[axis][0], upper = walls_[axis][1];
    const bool falls = falls_along(scene_, axis);
    const double below = falls ? liquid.reach : upper - lower;
    if (x < lower - below && !scene_.domain.sides[axis][0].bounds_liquid()) return true;
    if (!falls && x > 2 * upper - lower && !scene_.domain.sides[axis][1].bounds_liquid()) return true;
  }
  return false;
}

std::size_t Spill::remove(const Liquid& liquid, double time) {
  if (!possible_) return 0;
  const std::size_t before = liquid.particles.size();
  const double gone = parallel_sum(before, [&](std::size_t i) { return has_left(liquid, i) ? 1.0 : 0.0; });
  if (gone == 0) return 0;
  if (count() == 0)
    remark_ = "liquid leaves through an open side from t = " + brief(time) +
              " on: particles that cannot come back are removed";
  for (std::size_t i = 0; i < before; ++i)
    if (has_left(liquid, i)) ++count_[liquid.phase == nullptr ? 0 : static_cast<std::size_t>((*liquid.phase)[i])];
  Array<std::int32_t> kept;
  parallel_select(before, kept, [&](std::size_t i) { return !has_left(liquid, i); });
  liquid.particles.fields.permute(kept);
  return before - kept.size();
}

std::string Spill::take_remark() {
  return std::exchange(remark_, {});
}

void Spill::load(StateReader& reader) {
  Array<std::int64_t> count;
  reader.i64("spill", count);
  if (count.size() != count_.size()) throw FileError("the checkpoint was written by another version of the method");
  std::copy_n(count.data(), count.size(), count_.begin());
}

}  // namespace spume
