// SPDX-License-Identifier: MIT
// A particle method on a tiny case: from text, a few steps, and its state in the order of the identifiers.
#pragma once

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "scene/helpers.hpp"
#include "spume/core/error.hpp"
#include "spume/core/ledger.hpp"
#include "spume/core/saved_state.hpp"
#include "spume/scene/load.hpp"

namespace spume::test {

using Overrides = std::vector<std::string>;

// The beginning of a case in a cube of side 1 without sides; ends within [resolution].
inline std::string periodic_cube(const std::string& method, const std::string& spacing) {
  return "method = \"" + method +
         "\"\n[domain]\nlower = [0, 0, 0]\nupper = [1, 1, 1]\nx = \"periodic\"\ny = \"periodic\"\nz = "
         "\"periodic\"\n[resolution]\nspacing = " +
         spacing + "\n";
}

// One thread for a test that counts allocations: threads keep room of their own for lists, a few blocks long, and which
// of them meets its first large block when is a matter of chance.
class OneThread {
 public:
  OneThread() : before_(omp_get_max_threads()) { omp_set_num_threads(1); }
  ~OneThread() { omp_set_num_threads(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_;
};

// A checkpoint in memory.
class MemoryState final : public StateWriter, public StateReader {
 public:
  void f64(const std::string& name, std::span<const double> values) override {
    f64_[name] = {values.begin(), values.end()};
  }
  void i64(const std::string& name, std::span<const std::int64_t> values) override {
    i64_[name] = {values.begin(), values.end()};
  }
  void f64(const std::string& name, Array<double>& values) override { copy(f64_, name, values); }
  void i64(const std::string& name, Array<std::int64_t>& values) override { copy(i64_, name, values); }

  // Every number of the state; arrays of particles and of bubbles in the order of their identifiers, as a step may sort
  // them without changing the state.
  std::map<std::string, std::vector<double>> in_order_of_identifiers() const {
    std::map<std::string, std::vector<double>> state = f64_;
    for (const auto& [name, values] : i64_) state[name].assign(values.begin(), values.end());
    for (const std::string family : {"", "bubble_"}) {
      const auto found = i64_.find(family + "identifier");
      if (found == i64_.end()) continue;
      const std::vector<std::int64_t>& identifier = found->second;
      std::vector<std::size_t> order(identifier.size());
      for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
      std::sort(order.begin(), order.end(),
                [&](std::size_t a, std::size_t b) { return identifier[a] < identifier[b]; });
      for (auto& [name, values] : state) {
        if (values.size() != order.size() || name.starts_with("bubble_") != (family == "bubble_")) continue;
        std::vector<double> sorted(values.size());
        for (std::size_t i = 0; i < order.size(); ++i) sorted[i] = values[order[i]];
        values = sorted;
      }
    }
    return state;
  }

 private:
  template <class T>
  static void copy(const std::map<std::string, std::vector<T>>& from, const std::string& name, Array<T>& values) {
    const auto found = from.find(name);
    if (found == from.end()) throw FileError("no array '" + name + "'");
    values.resize(found->second.size());
    std::copy(found->second.begin(), found->second.end(), values.begin());
  }
  std::map<std::string, std::vector<double>> f64_;
  std::map<std::string, std::vector<std::int64_t>> i64_;
};

template <class Method>
struct MethodRun {
  LoadedCase loaded;
  Method method;
  Ledger ledger;

  explicit MethodRun(const std::string& text, const Overrides& overrides = {})
      : loaded(load_text(text, overrides)), method(loaded) {}
  MethodRun(const MethodRun&) = delete;
  MethodRun& operator=(const MethodRun&) = delete;

  // As a fresh run does before its first step; again, nothing.
  void prepare() {
    if (method.step_count() == 0 && !std::exchange(prepared_, true)) method.prepare(ledger, {});
  }
  void steps(int count, double dt) {
    prepare();
    for (int k = 0; k < count; ++k) method.step(dt, ledger);
  }
  std::map<std::string, double> series() {
    const auto columns = method.series_columns();
    std::vector<double> values(columns.size());
    method.series_values(values);
    std::map<std::string, double> result;
    for (std::size_t k = 0; k < columns.size(); ++k) result[columns[k].name] = values[k];
    return result;
  }
  std::map<std::string, std::vector<double>> saved_state() const {
    MemoryState saved;
    method.save(saved);
    return saved.in_order_of_identifiers();
  }

 private:
  bool prepared_ = false;
};

// Runs some steps, then one whose pressure cannot converge: what is wrong with the state after it, nothing or a name.
template <class Method>
std::string changed_by_a_refused_step(const std::string& text, const Overrides& overrides, double dt) {
  MethodRun<Method> run(text, overrides);
  run.steps(3, dt);
  MemoryState saved;
  run.method.save(saved);
  Overrides impossible = overrides;
  impossible.insert(impossible.end(), {"pressure.max_iterations=1", "pressure.tolerance=1e-14"});
  MethodRun<Method> strict(text, impossible);
  strict.method.load(saved);
  EXPECT_THROW(strict.steps(1, dt), StepFailure);
  MemoryState after;
  strict.method.save(after);
  const auto a = saved.in_order_of_identifiers(), b = after.in_order_of_identifiers();
  EXPECT_GT(a.size(), 5U);
  std::string changed;
  for (const auto& [name, values] : a)
    if (b.at(name) != values) changed += name + " ";
  return changed;
}

// After `count` steps, resumed for as many more.
template <class Run>
void expect_the_same_bits_resumed(const std::string& text, int count, double dt) {
  Run straight(text), resumed(text);
  straight.steps(count, dt);
  MemoryState saved;
  straight.method.save(saved);
  resumed.method.load(saved);
  straight.steps(count, dt);
  resumed.steps(count, dt);
  EXPECT_EQ(straight.saved_state(), resumed.saved_state());
}

}  // namespace spume::test
