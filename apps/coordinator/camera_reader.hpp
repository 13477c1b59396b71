#pragma once

#include <functional>
#include <memory>
#include <thread>

#include "inbox.hpp"
#include "pilotfish/capture/frame_source.hpp"

namespace pilotfish::apps {

using OpenSource = std::function<std::unique_ptr<capture::FrameSource>()>;

/// Frames of a live source into the inbox, on a thread of its own. When the source ends it is opened again every second
/// with `open`, which may throw CaptureError.
class CameraReader {
 public:
  CameraReader(std::unique_ptr<capture::FrameSource> first, OpenSource open, std::shared_ptr<Inbox> inbox);
  ~CameraReader();
  CameraReader(const CameraReader&) = delete;
  CameraReader& operator=(const CameraReader&) = delete;

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;  ///< owned by both: a thread that is stuck in a driver is detached
  std::thread thread_;
};

}  // namespace pilotfish::apps
