// SPDX-License-Identifier: MIT
// What the probes of a case record: columns, and values of the present state.
#pragma once

#include <vector>

#include "spume/io/series.hpp"
#include "spume/methods/method.hpp"
#include "spume/run/probe_averages.hpp"
#include "spume/scene/case.hpp"

namespace spume {

// Throws InputError at the first probe of a kind that the method does not have.
void require_probes(const Case& options, Method& method);

// probes.csv: t, then <name>_<scalar> for each scalar of the method and <name>_velocity_x, _y (, _z) of a point, <name>
// of an elevation, a wetted length or a front, <name>_area, _<scalar> and _velocity_x, ... of a plane. Only t where no
// probe has a column.
std::vector<SeriesColumn> probe_columns(const LoadedCase& loaded);
// A row of it. Precondition, here and below: require_probes().
void probe_values(const LoadedCase& loaded, Method& method, const ProbeAverages& averages, std::vector<double>& row);

// Where a point of a probe is now, that was at `start`.
Vec3 place_of(const ProbeOptions& probe, const Vec3& start, const FieldProbes& fields);

// lines.csv: t, name, s, x, y, z, velocity_x, velocity_y, velocity_z and the scalars, with s the distance from the
// start.
std::vector<SeriesColumn> line_columns(const LoadedCase& loaded);
// Its rows of one line at one time: `samples` points from `position` to `end`, equally far apart.
void write_line(const ProbeOptions& line, Method& method, SeriesFile& file);

}  // namespace spume
