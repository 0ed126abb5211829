// SPDX-License-Identifier: MIT
// The section [recorded_flow]: from some time on what is dissolved is carried by the flow that was recorded before. A
// method that takes it names the section in its registration and calls the check behind those of the scalars.
#pragma once

#include <optional>

namespace spume {

struct Draft;
class Problems;
struct Section;

struct RecordedFlowOptions {
  bool on = false;
  // All given, with the section.
  std::optional<double> from, until;  // times between which the flow is recorded
  std::optional<double> lag;          // over which its exchange is recorded, and step of what follows
  std::optional<double> cell;         // longest side of the cells
};

Section recorded_flow_section();
void check_recorded_flow(Draft& draft, Problems& problems);

}  // namespace spume
