#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace pilotfish::apps {

/// The line cannot be opened, or is gone.
class SerialError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A serial line: 8 data bits, no parity, one stop bit, nothing translated, and never waited for.
class SerialPort {
 public:
  /// Exclusive: a second program is refused. Throws SerialError.
  SerialPort(const std::string& device, int baud);
  ~SerialPort();
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  enum class Written { all, after_flush, nothing };
  /// Unsent bytes before it are discarded if there are many: an old set-point is useless, and must
  /// not be sent late. `nothing`: not even then. Throws SerialError if the line is gone.
  Written write_newest(std::string_view line);
  /// What has come, up to the buffer's size; 0: nothing. Throws SerialError if the line is gone.
  std::size_t read(char* buffer, std::size_t size);
  bool output_empty() const noexcept;
  int descriptor() const noexcept { return descriptor_; }

 private:
  Written write_or_flush(std::string_view line);

  int descriptor_ = -1;
  bool blocked_ = false;  ///< the last line was not sent at once
};

}  // namespace pilotfish::apps
