// SPDX-License-Identifier: MIT
#include "spume/operators/free_box.hpp"

#include "free_box_sweep.hpp"

namespace spume {

void box_moments(const SweepContext& context, const SolidUnion& solids, double spacing, std::span<const FreeBox> boxes,
                 std::span<BoxMoments> out) {
  with_kernel(context, [&]<int dimensions, class Kernel>() {
    const KernelScale<dimensions, Kernel> common(context);
    sweep(boxes.size(), [&](std::size_t k) {
      const auto i = static_cast<std::size_t>(boxes[k].particle);
      const KernelScale<dimensions, Kernel> scale = common.at(context, i);
      double trace = 0;
      std::array<double, 3> normal{};
      visit_box<dimensions>(context, solids, boxes[k], spacing, Kernel::support / scale.inverse_h,
                            [&](const std::array<double, dimensions>& d, double share, std::size_t source) {
                              double r2 = 0;
                              for (const double x : d) r2 += x * x;
                              const double g = -share * scale.gradient * own_volume<Kernel>(context, source) *
                                               Kernel::f(std::sqrt(r2) * scale.inverse_h);
                              trace += g * r2;
                              for (int axis = 0; axis < dimensions; ++axis) normal[axis] += g * d[axis];
                            });
      out[k].divergence_of_position = static_cast<float>(trace);
      for (int axis = 0; axis < dimensions; ++axis)
        out[k].normal[axis] = static_cast<float>(-normal[axis] / scale.inverse_h);
    });
  });
}

}  // namespace spume
