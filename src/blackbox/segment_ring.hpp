#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <string>

#include "event_queue.hpp"

namespace pilotfish::blackbox {

struct RingLimits {
  std::int64_t total_bytes = 0;
  std::int64_t segment_bytes = 0;
  std::int64_t max_age_us = 0;  ///< since the newest event of a file; 0: any age
};

/// Files DIR/<name>-<start>-<k>.lcmlog, of one robot, of which the oldest go first. `start` is the wall clock at the
/// program's start, but later than that of every file there is, so that the names sort by age whatever the clock says.
/// One thread. Nothing throws but the constructor.
class SegmentRing {
 public:
  /// Throws ConfigError naming black_box.directory.
  SegmentRing(std::filesystem::path directory, std::string name, std::int64_t utime, const RingLimits& limits);
  ~SegmentRing();
  SegmentRing(const SegmentRing&) = delete;
  SegmentRing& operator=(const SegmentRing&) = delete;

  /// The event as a whole, or nothing of it: false if the disk refuses. Then errno says why. A full disk costs the
  /// oldest files first. Begins a file where there is none.
  bool write(const Event& event);
  /// The file has its size: begin the next, best with a place to replay from.
  bool is_full() const { return bytes_ >= limits_.segment_bytes; }
  void close_segment();
  void sync();
  std::int64_t files() const { return next_; }

 private:
  struct Segment {
    std::filesystem::path path;
    std::int64_t start = 0, number = 0, bytes = 0;
    std::int64_t newest_utime = 0;  ///< of its last event
  };
  void lock_directory();
  void find_older(std::int64_t utime);
  bool open_segment();
  bool delete_oldest();
  void delete_aged(std::int64_t utime);
  bool append();
  bool make_room_on_full_disk();

  std::filesystem::path directory_;
  std::string name_;
  RingLimits limits_;
  std::int64_t start_ = 0, next_ = 0;
  std::deque<Segment> older_;  ///< the oldest first, without the current one
  std::int64_t older_bytes_ = 0;
  Segment current_;
  int file_ = -1, lock_ = -1;
  std::int64_t bytes_ = 0;   ///< in the current one
  std::int64_t events_ = 0;  ///< numbers of LCM's log
  Bytes buffer_;             ///< the event that is being written
};

}  // namespace pilotfish::blackbox
