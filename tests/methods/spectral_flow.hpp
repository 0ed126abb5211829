// SPDX-License-Identifier: MIT
// Small flows of the spectral method for its tests.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "scene/helpers.hpp"
#include "spume/core/error.hpp"
#include "spume/methods/spectral/spectral.hpp"

namespace spume::test {

// A periodic case of the given sections; lengths 1, 1.5 and 2.
inline std::string spectral_text(const std::string& grid, const std::string& rest) {
  return "method = \"spectral\"\n[domain]\nlower = [0, 0, 0]\nupper = [1, 1.5, 2]\nx = \"periodic\"\ny = \"periodic\"\n"
         "z = \"periodic\"\n[resolution]\ngrid = " +
         grid + "\n[time]\nend = 1\ncourant = 0.5\n" + rest;
}

inline const std::string random_start =
    "[fluid]\nreynolds = 60\n[initial]\nkind = \"random\"\nspectrum = \"k^2*exp(-(k/8)^2)\"\nenergy = 0.5\n";

// An ABC-like Beltrami flow along z in a stream: exact for any lengths. u = U + exp(-nu k^2 t) (cos k(z - W t),
// -sin k(z - W t), 0) with k = 2 pi / 2.
inline std::string beltrami_start(const std::string& integrator, const std::string& more = "") {
  return "[fluid]\nreynolds = 20\n[initial]\nkind = \"expressions\"\nvelocity = [\"0.3 + cos(pi*z)\", \"0.2 - "
         "sin(pi*z)\", \"0.9\"]\n[spectral]\nintegrator = \"" +
         integrator + "\"\n" + more;
}

// The state as what `save` gives.
struct SavedState final : StateWriter, StateReader {
  std::map<std::string, std::vector<double>> reals;
  std::map<std::string, std::vector<std::int64_t>> integers;
  void f64(const std::string& name, std::span<const double> values) override {
    reals[name].assign(values.begin(), values.end());
  }
  void i64(const std::string& name, std::span<const std::int64_t> values) override {
    integers[name].assign(values.begin(), values.end());
  }
  void f64(const std::string& name, Array<double>& values) override {
    values.resize(reals.at(name).size());
    std::copy(reals[name].begin(), reals[name].end(), values.begin());
  }
  void i64(const std::string& name, Array<std::int64_t>& values) override {
    values.resize(integers.at(name).size());
    std::copy(integers[name].begin(), integers[name].end(), values.begin());
  }
};

template <class T = double>
struct SpectralRun {
  LoadedCase loaded;
  spectral::Spectral<T> method;
  Ledger ledger;

  explicit SpectralRun(const std::string& text, const std::vector<std::string>& overrides = {})
      : loaded(load_text(text, overrides)), method(loaded) {}
  SpectralRun& start() {
    method.start();
    return *this;
  }
  SpectralRun& steps(int count, double dt) {
    for (int i = 0; i < count; ++i) method.step(dt, ledger);
    return *this;
  }
  std::map<std::string, double> series() {
    const auto columns = method.series_columns();
    std::vector<double> values(columns.size());
    method.series_values(values);
    std::map<std::string, double> row;
    for (std::size_t i = 0; i < columns.size(); ++i) row[columns[i].name] = values[i];
    return row;
  }
  SavedState saved() const {
    SavedState state;
    method.save(state);
    return state;
  }
};

}  // namespace spume::test
