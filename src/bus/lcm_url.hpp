#pragma once

#include <string>

namespace pilotfish::bus {

/// Throws BusError if liblcm has no provider for the URL, or if the server of a tcpq URL does not answer within a
/// second: liblcm would try that one again for ever, and say nothing.
void check_lcm_url(const std::string& url);

}  // namespace pilotfish::bus
