#pragma once

namespace pilotfish::apps {

/// What ends this process without asking (SIGSEGV, SIGABRT, SIGBUS and their kin, std::terminate) calls `say` first;
/// then the process dies as it would have. `say` must be async-signal-safe. Of SIGKILL nobody hears.
void on_fault(void (*say)()) noexcept;

}  // namespace pilotfish::apps
