// A calibration is refused with ConfigError, or is one with which pixels can be computed.
#include "fuzz_input.hpp"
#include "pilotfish/config/files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pilotfish;
  try {
    const CameraModel camera =
        config::parse_calibration({"fuzzed", std::string(reinterpret_cast<const char*>(data), size)});
    const Eigen::Vector2d middle(0.5 * camera.width, 0.5 * camera.height);
    fuzz::require(normalize_pixel(camera, middle).allFinite(), "an accepted camera looks somewhere");
  } catch (const ConfigError&) {  // refused, as it should be
  }
  return 0;
}
