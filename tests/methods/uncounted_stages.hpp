// SPDX-License-Identifier: MIT
// A check of a plan: stages that ran and whose traffic nobody counts, or that name no array.
#pragma once

#include <string>

#include "spume/methods/method.hpp"

namespace spume::test {

// In words; "" for none. ledger: of the runs of the plan.
inline std::string uncounted_stages(const Method& method, const Ledger& ledger) {
  std::string names;
  for (const Stage& stage : method.plan())
    if (stage.on && stage.reads.empty() && stage.writes.empty()) names += stage.name + " names no array; ";
  for (const Ledger::Entry& entry : ledger.entries())
    if (!(entry.bytes > 0)) names += entry.stage + " has no traffic; ";
  return names;
}

}  // namespace spume::test
