#pragma once

namespace pilotfish::apps {

/// From now on SIGINT and SIGTERM only raise a flag (and SIGPIPE is ignored), so that the loop can end in order: zeros
/// first.
void catch_stop_signals();
bool stop_requested();

}  // namespace pilotfish::apps
