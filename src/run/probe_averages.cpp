// SPDX-License-Identifier: MIT
#include "spume/run/probe_averages.hpp"

#include <algorithm>
#include <cmath>

#include "spume/run/probes.hpp"

namespace spume {
namespace {

double pressure_of(const ProbeOptions& probe, Method& method, std::size_t scalar) {
  FieldProbes& fields = *method.field_probes();
  const std::vector<double> scalars =
      probe.kind == ProbeKind::plane
          ? fields.plane_average(probe.axis, probe.position[static_cast<std::size_t>(probe.axis)]).scalars
          : fields.sample(place_of(probe, probe.position, fields)).scalars;
  return std::isfinite(scalars[scalar]) ? scalars[scalar] : 0.0;
}

}  // namespace

ProbeAverages::ProbeAverages(const std::vector<ProbeOptions>& probes, const std::vector<ProbeScalar>& scalars) {
  const auto pressure = std::find_if(scalars.begin(), scalars.end(), [](auto& one) { return one.name == "pressure"; });
  if (pressure == scalars.end()) return;
  scalar_ = static_cast<std::size_t>(pressure - scalars.begin());
  for (std::size_t k = 0; k < probes.size(); ++k)
    if (probes[k].average > 0) windows_.push_back({k, probes[k], {}});
}

void ProbeAverages::add_step(Method& method, double dt) {
  for (Window& window : windows_) {
    std::vector<double>& marks = window.marks;
    const double t = method.time();
    if (marks.empty()) marks = {t - dt, 0};
    marks.insert(marks.end(), {t, marks.back() + dt * pressure_of(window.options, method, scalar_)});
    std::size_t first = 0;
    while (first + 3 < marks.size() && marks[first + 2] <= t - window.options.average) first += 2;
    marks.erase(marks.begin(), marks.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

double ProbeAverages::pressure(std::size_t probe, double now) const {
  for (const Window& window : windows_) {
    const std::vector<double>& marks = window.marks;
    if (window.probe != probe || marks.size() < 4) continue;
    const double end = marks[marks.size() - 2], start = std::max(marks[0], end - window.options.average);
    const double within = (start - marks[0]) / (marks[2] - marks[0]);
    return (marks.back() - marks[1] - within * (marks[3] - marks[1])) / (end - start);
  }
  return now;
}

std::vector<double> ProbeAverages::scalars(std::size_t probe, std::vector<double> now) const {
  if (any()) now[scalar_] = pressure(probe, now[scalar_]);
  return now;
}

void ProbeAverages::restore(std::size_t k, std::span<const double> marks) {
  windows_[k].marks.assign(marks.begin(), marks.end());
}

}  // namespace spume
