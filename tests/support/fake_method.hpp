// SPDX-License-Identifier: MIT
// A small deterministic method and a loader of cases for it: points that turn about the origin and repel from an
// oscillating centre, so that every step depends on all the digits of time and state.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "spume/methods/method.hpp"
#include "spume/scene/case.hpp"

namespace spume::test {

// A flat TOML file: title, end, every, series_every, spectrum_every, checkpoint_every, dimensions, max_retries,
// probes (true or false), idle (has no effect, which is a warning) and what the method obeys: particles, dt,
// largest_dt, fails_from, sleep, memory_until, solvable, surface. Overrides are key=value.
LoadedCase load_fake_case(const std::string& path, const std::vector<std::string>& overrides);

std::unique_ptr<Method> make_fake_method(const LoadedCase& loaded);

}  // namespace spume::test
