#pragma once

namespace pilotfish::apps {

/// What ends this process without asking (SIGSEGV, SIGABRT, SIGBUS and their kin, std::terminate) calls `say` first;
/// then the process dies as it would have. `say` must be async-signal-safe. After SIGKILL nothing can be sent.
void on_fault(void (*say)()) noexcept;

}  // namespace pilotfish::apps
