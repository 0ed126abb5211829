// SPDX-License-Identifier: MIT
#include "spume/run/probes.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "spume/scene/refusal.hpp"

namespace spume {
namespace {

bool of_the_surface(ProbeKind kind) {
  return kind == ProbeKind::elevation || kind == ProbeKind::wetted || kind == ProbeKind::front;
}

}  // namespace

void require_probes(const Case& options, Method& method) {
  for (std::size_t k = 0; k < options.probes.size(); ++k) {
    const bool surface = of_the_surface(options.probes[k].kind);
    if (surface ? method.surface_probes() != nullptr : method.field_probes() != nullptr) continue;
    const std::string name = "probe." + std::to_string(k) + ".kind";
    const std::string other =
        surface && method.field_probes() != nullptr ? "; use \"point\", \"line\" or \"plane\"" : "";
    throw refusal(options, name,
                  name + (surface ? " needs a free surface" : " needs fields at a point") + ", which method \"" +
                      options.method + "\" does not have" + other);
  }
}

std::vector<SeriesColumn> probe_columns(const LoadedCase& loaded) {
  std::vector<SeriesColumn> columns = {{"t", "time"}};
  const int dimensions = loaded.scene.domain.dimensions;
  for (const ProbeOptions& probe : loaded.options.probes) {
    if (of_the_surface(probe.kind)) columns.push_back({probe.name, "length"});
    if (of_the_surface(probe.kind) || probe.kind == ProbeKind::line) continue;
    if (probe.kind == ProbeKind::plane) columns.push_back({probe.name + "_area", dimensions == 2 ? "length" : "area"});
    for (const ProbeScalar& scalar : loaded.probe_scalars)
      columns.push_back({probe.name + "_" + scalar.name, scalar.unit});
    for (int axis = 0; axis < dimensions; ++axis)
      columns.push_back({probe.name + "_velocity_" + "xyz"[axis], "velocity"});
  }
  return columns;
}

Vec3 place_of(const ProbeOptions& probe, const Vec3& start, const FieldProbes& fields) {
  return probe.motion ? fields.carried(*probe.motion, start) : start;
}

void probe_values(const LoadedCase& loaded, Method& method, const ProbeAverages& averages, std::vector<double>& row) {
  const auto put = [&](const std::vector<double>& scalars, const Vec3& velocity) {
    row.insert(row.end(), scalars.begin(), scalars.end());
    row.insert(row.end(), velocity.begin(), velocity.begin() + loaded.scene.domain.dimensions);
  };
  row.assign(1, method.time());
  for (std::size_t k = 0; k < loaded.options.probes.size(); ++k) {
    const ProbeOptions& probe = loaded.options.probes[k];
    switch (probe.kind) {
      case ProbeKind::point: {
        FieldProbes& fields = *method.field_probes();
        const PointSample sample = fields.sample(place_of(probe, probe.position, fields));
        put(averages.scalars(k, sample.scalars), sample.velocity);
        break;
      }
      case ProbeKind::plane: {
        const double position = probe.position[static_cast<std::size_t>(probe.axis)];
        const PlaneSample sample = method.field_probes()->plane_average(probe.axis, position);
        row.push_back(sample.area);
        put(averages.scalars(k, sample.scalars), sample.velocity);
        break;
      }
      case ProbeKind::elevation:
        row.push_back(method.surface_probes()->elevation(probe.position));
        break;
      case ProbeKind::wetted:
        row.push_back(method.surface_probes()->wetted_length(probe.position));
        break;
      case ProbeKind::front:
        row.push_back(method.surface_probes()->front(probe.axis, probe.height));
        break;
      case ProbeKind::line:
        break;
    }
  }
}

std::vector<SeriesColumn> line_columns(const LoadedCase& loaded) {
  std::vector<SeriesColumn> columns{{"t", "time"},
                                    {"name", ""},
                                    {"s", "length"},
                                    {"x", "length"},
                                    {"y", "length"},
                                    {"z", "length"},
                                    {"velocity_x", "velocity"},
                                    {"velocity_y", "velocity"},
                                    {"velocity_z", "velocity"}};
  for (const ProbeScalar& scalar : loaded.probe_scalars) columns.push_back({scalar.name, scalar.unit});
  return columns;
}

void write_line(const ProbeOptions& line, Method& method, SeriesFile& file) {
  const int last = std::max(line.samples - 1, 1);
  for (int i = 0; i < std::max(line.samples, 1); ++i) {
    const double fraction = static_cast<double>(i) / last;
    Vec3 position{};
    double distance2 = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double run = fraction * (line.end[axis] - line.position[axis]);
      position[axis] = line.position[axis] + run;
      distance2 += run * run;
    }
    position = place_of(line, position, *method.field_probes());
    const PointSample sample = method.field_probes()->sample(position);
    const double time = method.time();
    std::vector<double> values{std::sqrt(distance2)};
    values.insert(values.end(), position.begin(), position.end());
    values.insert(values.end(), sample.velocity.begin(), sample.velocity.end());
    values.insert(values.end(), sample.scalars.begin(), sample.scalars.end());
    file.row(std::span(&time, 1), line.name, values);
  }
}

}  // namespace spume
