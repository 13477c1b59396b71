#pragma once

namespace pilotfish::apps {

/// A fatal signal (SIGSEGV, SIGABRT, SIGBUS and the like) and std::terminate call `say` first;
/// then the process ends as it would have. `say` must be async-signal-safe. After SIGKILL nothing can be sent.
void on_fault(void (*say)()) noexcept;

}  // namespace pilotfish::apps
