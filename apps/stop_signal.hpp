#pragma once

namespace pilotfish::bus {
class FinalMessage;
}

namespace pilotfish::apps {

/// For programs with one thread: from now on every signal that requests an end (INT, TERM, HUP of a lost terminal,
/// QUIT, USR1, USR2) only raises a flag, so that the loop can end in order: zeros first. SIGPIPE is ignored.
void catch_stop_signals();
bool stop_requested();

/// For programs with several: the same signals wait in every thread until wait_for_stop_signal() takes one. Call before
/// the first thread is started.
void block_stop_signals();
/// True if one has come within that time.
bool wait_for_stop_signal(int timeout_ms);

/// The message sent when the process crashes (SIGSEGV, SIGABRT, SIGBUS, ...) or of std::terminate, before it does.
/// Must outlive everything else; nullptr: nothing any more.
void set_final_message(const bus::FinalMessage* message);

}  // namespace pilotfish::apps
