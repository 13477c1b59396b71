// A JPEG is refused, or has as many pixels as its header says.
#include "pilotfish/jpeg/jpeg.hpp"

#include "fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pilotfish;
  const auto claimed = jpeg::claimed_size(data, size);
  if (!claimed || claimed->width > 512 || claimed->height > 512) return 0;  // more takes time and shows nothing new
  const auto pixels = jpeg::decode(data, size, *claimed);
  const std::size_t wanted = static_cast<std::size_t>(claimed->width) * static_cast<std::size_t>(claimed->height);
  if (pixels) fuzz::require(pixels->size() == wanted, "a decoded picture has the size of its header");
  return 0;
}
