// SPDX-License-Identifier: MIT
// The sections of the bubbles as read: what checks complete to BubbleOptions and BubbleSources. A group of options of
// the case.
#pragma once

#include <optional>
#include <vector>

#include "spume/physics/bubbles/options.hpp"
#include "spume/scene/draft.hpp"

namespace spume {

struct SpargerDraft {
  Sparger sparger;
  std::vector<double> position, end;
  std::optional<ExpressionText> rate;
};

struct BubbleCloudDraft {
  BubbleCloud cloud;
  std::vector<double> lower, upper, centre;
  std::optional<double> radius;
};

struct BubbleDraft {
  std::optional<double> weber, surface_tension, density_ratio, gas_density, hinze_radius, smallest_entrained_radius;
  std::vector<SpargerDraft> spargers;
  std::vector<BubbleCloudDraft> clouds;
};

inline BubbleDraft& bubbles_of(Draft& draft) {
  return draft.options.get<BubbleDraft>();
}

}  // namespace spume
