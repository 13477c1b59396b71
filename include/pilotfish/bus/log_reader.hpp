#pragma once

#include <memory>
#include <optional>
#include <string>

#include "pilotfish/api.hpp"
#include "pilotfish/core/frame.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::bus {

/// The images of one channel in a file written by lcm-logger, oldest first.
class LogReader {
 public:
  /// Throws BusError if the file cannot be read as an LCM log, or has nothing on that channel (the message lists its
  /// channels).
  LogReader(const std::string& path, const std::string& channel);
  ~LogReader();
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;

  /// Nothing at the end. A corrupt image comes as a frame without pixels, 1 us after the one before.
  std::optional<Frame> next();

  std::size_t size() const;      ///< images on the channel, corrupt ones included
  std::int64_t damaged() const;  ///< damaged parts of the file that were skipped

 private:
  struct File;
  std::unique_ptr<File> file_;
};

}  // namespace pilotfish::bus
PILOTFISH_API_END
