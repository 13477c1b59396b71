// Bytes as a file of lcm-logger: the index of its events, and the pictures among them.
#include <sstream>
#include <string>

#include "fuzz_input.hpp"
#include "image_codec.hpp"
#include "log_index.hpp"

using namespace pilotfish;
using namespace pilotfish::bus;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream file(std::string(reinterpret_cast<const char*>(data), size));
  const LogIndex index = index_log(file, "IMAGE");
  std::int64_t events = 0;
  for (const auto& [channel, count] : index.channels) {
    fuzz::require(!channel.empty() && channel.size() <= 63 && count > 0, "a channel has a name");
    events += count;
  }
  fuzz::require(events * 29 <= static_cast<std::int64_t>(size), "events do not overlap");
  for (const LogIndex::Event& event : index.events) {
    fuzz::require(event.data_offset >= 0 && event.data_bytes >= 0 &&
                      event.data_offset + event.data_bytes <= static_cast<std::int64_t>(size),
                  "an event lies in its file");
    const std::vector<std::uint8_t> bytes(data + event.data_offset, data + event.data_offset + event.data_bytes);
    decode_image(bytes.data(), bytes.size());
  }
  return 0;
}
