#pragma once

#include <string>

namespace pilotfish::apps {

/// What a loop with a deadline needs of its process.

/// Logs to stderr through a queue that drops the oldest line when it is full: a blocked terminal never stops the
/// caller.
void log_without_waiting(bool quiet);

/// SCHED_FIFO and locked memory for the calling thread and those that it starts. What was not permitted, for the log;
/// empty if all was.
std::string ask_for_real_time();

/// Ends the process, after a fifth of a second at most for what is still in the log's queue.
[[noreturn]] void end_process(int code);

}  // namespace pilotfish::apps
