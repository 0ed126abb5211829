// SPDX-License-Identifier: MIT
// The machine that the program runs on.
#pragma once

namespace spume {

// Memory in bytes that this process may use: the machine's, or less where the user has set a limit (ulimit -v).
double machine_memory_bytes();

}  // namespace spume
