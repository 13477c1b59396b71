#include "line_reader.hpp"

#include <poll.h>

#include <array>
#include <atomic>
#include <mutex>
#include <thread>

namespace pilotfish::apps {

/// Owned by both, so that a thread that waits in the kernel can be detached.
struct LineReader::Shared {
  explicit Shared(std::shared_ptr<SerialPort> line) : port(std::move(line)) {}

  std::shared_ptr<SerialPort> port;
  std::atomic<bool> stop{false};
  std::mutex mutex;  // guards what follows
  base::ControllerParser parser;
  Taken taken;
};

namespace {

constexpr int kLookUp_ms = 50;  // for the request to end

template <class Shared>
void read_lines(Shared& shared) {
  std::array<char, 512> buffer;
  while (!shared.stop) {
    pollfd waiting{shared.port->descriptor(), POLLIN, 0};
    if (::poll(&waiting, 1, kLookUp_ms) <= 0) continue;
    const std::size_t size = shared.port->read(buffer.data(), buffer.size());
    const std::lock_guard lock(shared.mutex);
    for (std::size_t k = 0; k < size; ++k)
      if (const auto line = shared.parser.feed(buffer[k])) shared.taken.lines.push_back(*line);
    shared.taken.rejected = shared.parser.rejected();
  }
}

}  // namespace

LineReader::LineReader(std::shared_ptr<SerialPort> port) : shared_(std::make_shared<Shared>(std::move(port))) {
  std::thread([shared = shared_] {
    try {
      read_lines(*shared);
    } catch (const SerialError& error) {
      const std::lock_guard lock(shared->mutex);
      shared->taken.lost = error.what();
    }
  }).detach();
}

LineReader::~LineReader() { shared_->stop = true; }

LineReader::Taken LineReader::take() {
  const std::lock_guard lock(shared_->mutex);
  Taken taken = shared_->taken;
  shared_->taken.lines.clear();
  return taken;
}

}  // namespace pilotfish::apps
