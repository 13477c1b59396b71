#pragma once

#include <cstdint>
#include <string>

namespace pilotfish::apps {

/// The program's log, and with `lines` its output of JSON lines, each through a queue and a thread of its own: a
/// terminal that does not read (a pipe that is full, Ctrl-S, a lost ssh) must not block the caller. Live, what does
/// not fit replaces the oldest, and is counted; a program that processes files waits instead.
class Log {
 public:
  struct Options {
    bool to_stderr = false;  ///< stdout carries the JSON lines
    bool never_wait = true;  ///< live
  };
  explicit Log(const Options& options);
  ~Log();
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;

  void line(const std::string& text);  ///< to stdout as it is
  std::int64_t lost() const;           ///< entries and lines that were replaced
  /// Waits until everything has been written; live, a quarter of a second at most. False: a thread is stuck in
  /// write(2), and the process must end by _exit.
  bool drain();

 private:
  struct Queues;
  bool never_wait_;
  Queues* queues_;  // left behind on purpose if a thread is stuck: joining it would wait for the terminal
};

}  // namespace pilotfish::apps
