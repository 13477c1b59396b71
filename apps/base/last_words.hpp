#pragma once

namespace pilotfish::apps {

/// What ends this process without asking tells the wheels zero first: a signal of a broken program (SIGSEGV, SIGABRT
/// and their kin) and std::terminate write a prepared line to the serial line, then the process dies as it would have.
/// After SIGKILL nothing can be sent; there the controller's own watchdog stops the wheels.
void prepare_last_words();

/// The serial line's descriptor; -1: there is none.
void last_words_to(int descriptor) noexcept;

}  // namespace pilotfish::apps
