#include "log.hpp"

#include <pthread.h>
#include <sched.h>
#include <spdlog/async.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <memory>
#include <thread>

namespace pilotfish::apps {
namespace {

constexpr std::size_t kEntries = 1024;
constexpr std::chrono::milliseconds kDrainWithin{250};

/// The queues have locks. A thread that sends commands at a real-time priority must not wait for a lock whose holder
/// waits for a core among a hundred busy programs: so the writing threads have the lowest real-time priority, where it
/// is permitted.
void never_hold_up_the_caller() {
  sched_param lowest{};
  lowest.sched_priority = 1;
  pthread_setschedparam(pthread_self(), SCHED_FIFO, &lowest);
}

std::shared_ptr<spdlog::sinks::sink> log_sink(bool to_stderr) {
  if (to_stderr) return std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  return std::make_shared<spdlog::sinks::stdout_color_sink_mt>();
}

}  // namespace

struct Log::Queues {
  explicit Queues(const Options& options)
      : entries(std::make_shared<spdlog::details::thread_pool>(kEntries, 1, never_hold_up_the_caller)),
        lines(std::make_shared<spdlog::details::thread_pool>(kEntries, 1, never_hold_up_the_caller)) {
    const auto when_full =
        options.never_wait ? spdlog::async_overflow_policy::overrun_oldest : spdlog::async_overflow_policy::block;
    log = std::make_shared<spdlog::async_logger>("pilotfish", log_sink(options.to_stderr), entries, when_full);
    log->set_pattern("%H:%M:%S.%e %^%l%$ %v");
    log->flush_on(spdlog::level::info);
    out = std::make_shared<spdlog::async_logger>("lines", std::make_shared<spdlog::sinks::stdout_sink_mt>(), lines,
                                                 when_full);
    out->set_pattern("%v");
    out->flush_on(spdlog::level::info);
  }
  std::shared_ptr<spdlog::details::thread_pool> entries, lines;
  std::shared_ptr<spdlog::async_logger> log, out;
};

Log::Log(const Options& options) : never_wait_(options.never_wait), queues_(new Queues(options)) {
  spdlog::set_default_logger(queues_->log);
}

void Log::line(const std::string& text) { queues_->out->info(text); }

std::int64_t Log::lost() const {
  return static_cast<std::int64_t>(queues_->entries->overrun_counter() + queues_->lines->overrun_counter());
}

bool Log::drain() {
  // A queue that is empty may still have its last entry under way, so each thread answers once more: it has written all
  // that came before when the flush has been taken out of the queue behind it.
  const auto until = std::chrono::steady_clock::now() + kDrainWithin;
  for (const auto& logger : {queues_->log, queues_->out}) logger->flush();
  while (queues_->entries->queue_size() > 0 || queues_->lines->queue_size() > 0) {
    if (never_wait_ && std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

Log::~Log() {
  if (!drain()) return;
  spdlog::set_default_logger(nullptr);
  delete queues_;
}

}  // namespace pilotfish::apps
