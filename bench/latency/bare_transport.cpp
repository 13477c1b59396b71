// Bare transport, for bench/latency: liblcm's own receiver, which answers every image_t with a command_t and does
// nothing else. Of the image it reads the header alone. bare_transport LCM_URL

#include <lcm/lcm.h>
#include <sched.h>

#include <cstdint>
#include <cstdio>
#include <vector>

#include "bot_core/image_t.hpp"
#include "pilotfish/command_t.hpp"

namespace {

constexpr int kPriority = 15;  // of the coordinator's thread that listens: neither arm waits where the other does not

std::int64_t read_int64(const std::uint8_t* bytes) {
  std::uint64_t value = 0;
  for (int i = 0; i < 8; ++i) value = value << 8 | bytes[i];
  return static_cast<std::int64_t>(value);
}

struct Baseline {
  lcm_t* lcm;
  pilotfish::command_t command;

  void answer(const std::uint8_t* image, std::size_t size_bytes) {
    if (size_bytes < 16 || read_int64(image) != bot_core::image_t::getHash()) return;
    command.utime = read_int64(image + 8);  // behind the fingerprint
    ++command.counter;
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(command.getEncodedSize()));
    command.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    lcm_publish(lcm, "ROBOT1_COMMAND", bytes.data(), static_cast<unsigned>(bytes.size()));
  }
};

void on_image(const lcm_recv_buf_t* received, const char* /*channel*/, void* baseline) {
  static_cast<Baseline*>(baseline)->answer(static_cast<const std::uint8_t*>(received->data), received->data_size);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 64;
  Baseline baseline{lcm_create(argv[1]), {}};
  if (baseline.lcm == nullptr) return 69;
  baseline.command.session = 1;
  baseline.command.linear_mps = 0.5;
  baseline.command.status = pilotfish::command_t::STATUS_TRACKING;
  baseline.command.text = "tracking";  // as long as the coordinator's
  sched_param parameters{};
  parameters.sched_priority = kPriority;
  if (sched_setscheduler(0, SCHED_FIFO, &parameters) != 0)  // before liblcm starts its thread, which inherits it
    std::puts("no real-time scheduling");
  if (lcm_subscribe(baseline.lcm, "ROBOT1_IMAGE", on_image, &baseline) == nullptr) return 69;
  std::puts("ready");
  std::fflush(stdout);
  while (lcm_handle(baseline.lcm) == 0) {
  }
  return 70;
}
