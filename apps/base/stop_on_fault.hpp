#pragma once

namespace pilotfish::apps {

/// A crash sets the wheels to zero first: the signals of a program fault (SIGSEGV, SIGABRT and the
/// like) and std::terminate write a prepared line to the serial line, then the process ends as it would have.
/// After SIGKILL nothing can be sent; there the controller's own watchdog stops the wheels.
void prepare_stop_on_fault();

/// The serial line's descriptor; -1: there is none.
void set_stop_on_fault_line(int descriptor) noexcept;

}  // namespace pilotfish::apps
