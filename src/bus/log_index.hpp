#pragma once

#include <cstdint>
#include <istream>
#include <map>
#include <string>
#include <vector>

namespace pilotfish::bus {

/// Where the messages of one channel lie in a log file.
struct LogIndex {
  struct Event {
    std::int64_t data_offset = 0;
    std::int32_t data_bytes = 0;
  };
  std::vector<Event> events;                     ///< of the channel asked for, in the file's order
  std::map<std::string, std::int64_t> channels;  ///< how many events there are of each
  std::int64_t damaged = 0;                      ///< places where the file was damaged and skipped
};

/// Reads the headers of a file written by lcm-logger: per event, big endian,
///   int32 sync word 0xEDA1DA01, int64 event number, int64 time [us], int32 channel length, int32 data
///   length, channel, data
///
/// Our own, because liblcm 1.3.1 crashes on a damaged file: it allocates the length in an event's header
/// unchecked. Here an event must fit into the file, and after damage the next sync word is looked for.
LogIndex index_log(std::istream& file, const std::string& channel);

}  // namespace pilotfish::bus
