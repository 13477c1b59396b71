#pragma once

namespace pilotfish::apps {

/// Opens /dev/null in place of each of the standard streams that is closed. Call first in main: else the next socket
/// or camera gets the number 1 or 2, and what is meant for the console goes out on the bus.
void fill_missing_standard_streams();

}  // namespace pilotfish::apps
