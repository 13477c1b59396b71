#include "process.hpp"

#include <sched.h>
#include <spdlog/async.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/mman.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <thread>

namespace pilotfish::apps {
namespace {

constexpr int kPriority = 20;  // above every ordinary program, below the kernel's own interrupt threads (50)
constexpr int kLogPriority = 1;
constexpr std::size_t kLogLines = 1024;

bool be_real_time(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  return sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
}

}  // namespace

void log_without_waiting(bool quiet) {
  // The queue has a lock. Its other holder must not wait for a core among a hundred busy programs while the loop waits
  // for the lock: so it has a real-time priority too, the lowest.
  spdlog::init_thread_pool(kLogLines, 1, [] { be_real_time(kLogPriority); });
  auto logger = spdlog::create_async_nb<spdlog::sinks::stderr_color_sink_mt>("pilotfish-base");
  logger->set_pattern("%H:%M:%S.%e %^%l%$ %v");
  logger->set_level(quiet ? spdlog::level::warn : spdlog::level::info);
  spdlog::set_default_logger(logger);
}

std::string ask_for_real_time() {
  std::string refused;
  if (!be_real_time(kPriority)) refused += std::string("no real-time priority (") + std::strerror(errno) + ")";
  if (mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) != 0)
    refused += std::string(refused.empty() ? "" : ", ") + "memory not locked (" + std::strerror(errno) + ")";
  return refused;
}

void end_process(int code) {
  // The writing thread may hang in a blocked terminal; then what it has not written is lost.
  const auto written = std::make_shared<std::atomic<bool>>(false);
  std::thread([written] {
    spdlog::shutdown();
    *written = true;
  }).detach();
  for (int i = 0; i < 40 && !*written; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  std::_Exit(code);
}

}  // namespace pilotfish::apps
