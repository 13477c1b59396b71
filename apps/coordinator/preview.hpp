#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "pilotfish/bus/bus.hpp"
#include "pilotfish/config/files.hpp"
#include "pilotfish/core/frame.hpp"

namespace pilotfish::apps {

/// Small pictures for people on NAME_PREVIEW. Made and sent by a thread of low priority; whoever offers a picture waits
/// for nothing.
class Preview {
 public:
  /// config.rate_hz: above zero.
  Preview(const config::PreviewConfig& config, std::string robot, const std::string& bus_url);
  ~Preview();
  Preview(const Preview&) = delete;
  Preview& operator=(const Preview&) = delete;

  /// The newest is sent, if the rate allows one. Only frames that own their pixels, which are shared.
  void offer(const Frame& frame) noexcept;

 private:
  void work();

  const config::PreviewConfig config_;
  const std::string robot_;
  bus::Bus bus_;
  MonotonicTime next_;  ///< of the thread that offers
  std::mutex mutex_;
  std::condition_variable offered_;
  std::optional<Frame> newest_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace pilotfish::apps
