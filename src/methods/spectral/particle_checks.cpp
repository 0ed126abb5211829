// SPDX-License-Identifier: MIT
// What [particles] must satisfy beyond types and ranges.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "spume/methods/spectral/options.hpp"
#include "spume/scene/draft.hpp"

namespace spume {
namespace {

// (nu^3 / injection)^(1/4).
double kolmogorov_length(const Draft& draft) {
  const FluidDraft& fluid = draft.fluid;
  const double nu = uses_si(fluid)   ? fluid.viscosity.value_or(0) / fluid.density.value_or(1)
                    : fluid.reynolds ? 1 / *fluid.reynolds
                                     : 0.0;
  return std::pow(nu * nu * nu / draft.options.get<ForcingOptions>().injection, 0.25);
}

}  // namespace

void check_particles(const Draft& draft, Problems& problems) {
  const Node* section = draft.node("particles");
  if (!section) return;
  const ParticleCaseOptions& p = draft.options.get<ParticleCaseOptions>();
  const auto has = [&](const char* key) { return draft.node(std::string("particles.") + key) != nullptr; };
  const auto fault = [&](const char* key, const std::string& text) {
    const Node* node = draft.node(std::string("particles.") + key);
    problems.add(node ? *node : *section, std::string("particles.") + key + " " + text);
  };
  const auto exactly_one = [&](std::vector<const char*> keys, bool required, const char* example) {
    const auto given = std::count_if(keys.begin(), keys.end(), has);
    if (given > 1)
      for (const char* key : keys)
        if (has(key)) {
          std::string others;
          for (const char* other : keys)
            if (other != key && has(other)) others += (others.empty() ? "" : ", ") + std::string(other);
          fault(key, "and " + others + " exclude each other; keep one");
          return;
        }
    if (given == 0 && required)
      problems.add(*section, std::string("missing key '") + keys[0] + "' in [particles]; add  " + example);
  };
  exactly_one({"count", "volume_fraction"}, true, "count = <number>");
  exactly_one({"diameter", "diameter_over_eta", "diameters"}, true, "diameter = <number>  # length, > 0");
  exactly_one({"stokes", "response_time"}, false, "");
  for (const char* key : {"stokes", "diameter_over_eta"})
    if (has(key) && draft.options.get<ForcingOptions>().kind != ForcingKind::shell)
      fault(key, "is in Kolmogorov scales of the injected energy and needs forcing.kind = \"shell\"");

  std::vector<double> diameters = p.diameters;
  if (has("diameter")) diameters = {p.diameter};
  const char* key = has("diameter") ? "diameter" : "diameters";
  if (has("diameter_over_eta") && draft.options.get<ForcingOptions>().injection > 0) {
    key = "diameter_over_eta";
    diameters = {p.diameter_over_eta * kolmogorov_length(draft)};
  }
  if (draft.dimensions == 3) {
    double shortest = draft.upper[0] - draft.lower[0];
    for (std::size_t a = 1; a < 3; ++a) shortest = std::min(shortest, draft.upper[a] - draft.lower[a]);
    for (const double d : diameters)
      if (!(d > 0) || !(2 * d < shortest)) {
        fault(key, std::string(has("diameter_over_eta") ? "makes a diameter, which " : "") +
                       "must lie between 0 and half of the shortest side of the box, " + brief(shortest) + "; found " +
                       brief(d));
        break;
      }
    if (p.count > 0 && !diameters.empty()) {
      double volume = 1, mean = 0, shares = 0;
      for (std::size_t a = 0; a < 3; ++a) volume *= draft.upper[a] - draft.lower[a];
      for (std::size_t i = 0; i < diameters.size(); ++i) {
        const double share = i < p.shares.size() ? p.shares[i] : 1.0;
        mean += share * std::pow(diameters[i], 3) * M_PI / 6;
        shares += share;
      }
      const double fraction = static_cast<double>(p.count) * mean / shares / volume;
      if (fraction > close_packing)
        fault("count", "of these diameters fill " + brief(fraction) + " of the box, more than spheres can (" +
                           brief(close_packing) + "); take at most " +
                           brief(std::floor(static_cast<double>(p.count) * close_packing / fraction)));
    }
  }
  if (has("shares") && p.shares.size() != p.diameters.size())
    fault("shares", "must have one entry for each of the " + std::to_string(p.diameters.size()) + " diameters, found " +
                        std::to_string(p.shares.size()));
  if (std::any_of(p.shares.begin(), p.shares.end(), [](double s) { return !(s >= 0); }))
    fault("shares", "must not be negative");
  else if (has("shares") && std::accumulate(p.shares.begin(), p.shares.end(), 0.0) == 0)
    fault("shares", "must not all be 0: no particle would have any of the diameters");
  if (has("gravity") && p.gravity.size() != 3)
    fault("gravity", "must have 3 entries, found " + std::to_string(p.gravity.size()));
  if (has("spline_order") && p.spline_order % 2 != 0)
    fault("spline_order", "must be 2, 4 or 6, found " + std::to_string(p.spline_order));
  if ((p.coupling == Coupling::two_way || p.coupling == Coupling::four_way) && has("beta") && p.beta == 0)
    fault("beta",
          "= 0 is an infinite density, which has no two-way coupling; give a value above 0, or "
          "particles.coupling = \"one-way\" or \"colliding\"");
  if (!has("stokes") && !has("response_time") && has("beta") && p.beta == 0)
    fault("beta", "= 0 has no response time of its own; add  stokes = <number>");
  if (p.placement == Placement::file && !has("file"))
    problems.add(*section, "missing key 'file' in [particles]; add  file = \"<path of a CSV file>\"");
  if (has("file") && p.placement != Placement::file) fault("file", "belongs to particles.placement = \"file\"");
  if (p.lyapunov > 0 && !p.double_records) fault("lyapunov", "needs particles.records = \"double\"");
}

}  // namespace spume
