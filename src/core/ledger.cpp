// SPDX-License-Identifier: MIT
#include "spume/core/ledger.hpp"

#include <algorithm>
#include <iterator>

namespace spume {

using Clock = std::chrono::steady_clock;

Ledger::Scope::Scope(Ledger& ledger, std::size_t entry, double particles, double pairs, double bytes)
    : ledger_(ledger), entry_(entry), start_(Clock::now()), particles_(particles), pairs_(pairs), bytes_(bytes) {}

Ledger::Scope::~Scope() {
  Entry& entry = ledger_.entries_[entry_];
  ++entry.calls;
  entry.seconds += std::chrono::duration<double>(Clock::now() - start_).count();
  entry.particles += particles_;
  entry.pairs += pairs_;
  entry.bytes += bytes_;
}

Ledger::Scope Ledger::time(std::string_view stage, double particles, double pairs, double bytes) {
  return Scope(*this, find(stage), particles, pairs, bytes);
}

void Ledger::count(std::string_view stage, std::int64_t calls, double seconds, double particles, double pairs,
                   double bytes) {
  Entry& entry = entries_[find(stage)];
  entry.calls += calls;
  entry.seconds += seconds;
  entry.particles += particles;
  entry.pairs += pairs;
  entry.bytes += bytes;
}

std::vector<Ledger::Entry> Ledger::entries() const {
  std::vector<Entry> called;
  std::copy_if(entries_.begin(), entries_.end(), std::back_inserter(called),
               [](const Entry& entry) { return entry.calls > 0; });
  return called;
}

std::size_t Ledger::find(std::string_view stage) {
  for (std::size_t i = 0; i < entries_.size(); ++i)
    if (entries_[i].stage == stage) return i;
  entries_.push_back({std::string(stage)});
  return entries_.size() - 1;
}

}  // namespace spume
