#pragma once

namespace pilotfish::apps {

// sysexits.h's numbers, so that a supervisor (systemd: RestartPreventExitStatus=78) can decide what to retry.
inline constexpr int kOk = 0;
inline constexpr int kUsage = 64;        ///< the command line is wrong
inline constexpr int kUnavailable = 69;  ///< the source or the bus cannot be opened
inline constexpr int kSoftware = 70;     ///< gave up
inline constexpr int kConfig = 78;       ///< the configuration is wrong; the message names the key

}  // namespace pilotfish::apps
