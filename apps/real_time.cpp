#include "real_time.hpp"

#include <pthread.h>
#include <sched.h>
#include <spdlog/spdlog.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>

namespace pilotfish::apps {
void become_real_time(const char* thread_name, int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters); error != 0)
    spdlog::info("no real-time scheduling for {} ({}); on a busy computer deadlines can be missed. See `ulimit -r`",
                 thread_name, std::strerror(error));
}

void lock_memory() {
  // Only what is there now: MCL_FUTURE would make every later allocation fail where the limit is small.
  if (mlockall(MCL_CURRENT) != 0)
    spdlog::info("the memory cannot be locked ({}); see `ulimit -l`", std::strerror(errno));
}

}  // namespace pilotfish::apps
