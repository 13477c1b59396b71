#pragma once

namespace pilotfish::apps {

/// Above ordinary work, below what drivers and the kernel's own threads use (50); commands before vision.
inline constexpr int kCommandsPriority = 20;
inline constexpr int kListeningPriority = 15;
inline constexpr int kVisionPriority = 10;

/// Requests real-time scheduling (SCHED_FIFO) of the calling thread. Where it is not permitted the thread stays an
/// ordinary one, and that is logged. See `ulimit -r`, LimitRTPRIO= of systemd.
void become_real_time(const char* thread_name, int priority);

/// Keeps what the program has touched in memory: a page that must be fetched from a disk is a missed deadline.
void lock_memory();

}  // namespace pilotfish::apps
