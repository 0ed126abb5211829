// SPDX-License-Identifier: MIT
// The ledger: how often every stage ran, for how long, and on how many particles, pairs and bytes. Always on
// (two clock reads a stage). The driver prints it as a table and writes it as ledger.json.
//
// Bytes are the compulsory traffic of a stage: every array that it says it reads or writes, once, and what its sweeps
// pack and gather, as if the caches held what a stage comes back to and nothing from one stage to the next. A rate near
// what memory gives tells a stage that waits for memory; one far below tells of arithmetic, of gathers, or of arrays
// that stay in cache.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace spume {

class Ledger {
 public:
  struct Entry {
    std::string stage;
    std::int64_t calls = 0;
    double seconds = 0;
    double particles = 0;  // particles handled, summed over calls
    double pairs = 0;      // particle pairs handled, summed over calls
    double bytes = 0;      // compulsory traffic, summed over calls; 0 when not counted
  };

  // Times a stage from construction to destruction.
  class Scope {
   public:
    Scope(Ledger& ledger, std::size_t entry, double particles, double pairs, double bytes);
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope();

    // Work and traffic that are known only when the work is done.
    void add_particles(double particles) { particles_ += particles; }
    void add_pairs(double pairs) { pairs_ += pairs; }
    void add_bytes(double bytes) { bytes_ += bytes; }

   private:
    Ledger& ledger_;
    std::size_t entry_;
    std::chrono::steady_clock::time_point start_;
    double particles_, pairs_, bytes_;
  };

  // The entry is found by name, or appended.
  [[nodiscard]] Scope time(std::string_view stage, double particles = 0, double pairs = 0, double bytes = 0);

  // Adds work to a stage that a caller timed or counted itself (solver iterations).
  void count(std::string_view stage, std::int64_t calls, double seconds, double particles, double pairs,
             double bytes = 0);

  // Gives a stage its place before it runs: a start runs some stages, the first step others between them.
  void list(std::string_view stage) { find(stage); }

  // Of stages that ran, in the order in which they were listed or first called.
  std::vector<Entry> entries() const;
  void clear() { entries_.clear(); }

 private:
  std::size_t find(std::string_view stage);
  std::vector<Entry> entries_;
};

}  // namespace spume
