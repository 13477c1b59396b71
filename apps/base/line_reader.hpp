#pragma once

#include <memory>
#include <string>

#include "pilotfish/base/serial_protocol.hpp"
#include "pilotfish/core/bounded_vector.hpp"
#include "serial_port.hpp"

namespace pilotfish::apps {

/// Reads a serial line in a thread of its own. A non-blocking read waits nevertheless: the kernel hands
/// bytes over in a worker with an ordinary priority, and read() and poll() wait for that worker when it has something
/// to do (n_tty_read, tty_buffer_flush_work). Inferred, not traced, from zeros that came late
/// on a computer with 20 busy programs.
class LineReader {
 public:
  explicit LineReader(std::shared_ptr<SerialPort> port);
  /// Requests the thread's end and does not wait for it; the line is closed when it has.
  ~LineReader();
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  struct Taken {
    BoundedVector<base::ControllerLine, 64> lines;  ///< since the last call; of a flood, the oldest
    base::ControllerParser::Rejected rejected;      ///< since the line was opened
    std::string lost;                               ///< why the line is gone; empty if it is not
  };
  Taken take();

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
};

}  // namespace pilotfish::apps
