#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/planar_motion.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::base {

/// Two driven wheels on one axle.
struct DriveGeometry {
  PILOTFISH_PARAMETERS(DriveGeometry);
  PILOTFISH_PARAMETER(double, wheel_radius_m, 0.05, 0.005, 1.0, "of both driven wheels, as they roll under load");
  PILOTFISH_PARAMETER(double, track_width_m, 0.30, 0.02, 5.0,
                      "between the points where the two wheels touch the ground");
  PILOTFISH_PARAMETER(int, ticks_per_revolution, 2048, 1, 1'000'000,
                      "of a wheel (not of its motor), as the controller counts them: all edges, behind the gear");
};

/// Turn rates of the two wheels; positive: forwards.
struct WheelSpeeds {
  double left_radps = 0.0;   ///< [rad/s]
  double right_radps = 0.0;  ///< [rad/s]
};

/// Wheels that roll without slipping, r their radius, b the distance between them. The turning centre is half way
/// between them; when it moves with v and turns with w, the left wheel's centre moves with v - w b / 2, the right one's
/// with v + w b / 2, and a wheel whose centre moves with u turns with u / r:
///
///   left = (v - w b / 2) / r,   right = (v + w b / 2) / r.
WheelSpeeds wheel_speeds(const DriveGeometry& geometry, const Twist& twist) noexcept;

/// The same solved for v and w: half the sum, and the difference over b.
Twist twist_of(const DriveGeometry& geometry, const WheelSpeeds& speeds) noexcept;

/// The encoders' counters at one instant. They wrap around at 32 bits, as a microcontroller's do, and so does
/// its clock in milliseconds.
struct EncoderReading {
  std::uint32_t time_ms = 0;     ///< the controller's clock [ms]
  std::int32_t left_ticks = 0;   ///< positive: forwards
  std::int32_t right_ticks = 0;  ///< positive: forwards
};

/// Odometry from the wheels' encoders.
class WheelOdometry {
 public:
  /// `max_wheel_radps`: the wheels' limit. Readings of more than twice that are not motion but a counter that
  /// was reset (a controller that restarted).
  WheelOdometry(const DriveGeometry& geometry, double max_wheel_radps);

  /// Integrates from the reading before, exactly along the arc. The twist is the mean one in between; nothing for the
  /// first reading, for one at the same time as the last, and for one that cannot be motion (counted in jumps()).
  std::optional<Twist> update(const EncoderReading& reading) noexcept;
  /// The next reading is the first one again; the pose stays.
  void forget() noexcept { last_.reset(); }

  const Pose2& pose() const noexcept { return pose_; }    ///< since the start, in the odometry frame
  std::int64_t jumps() const noexcept { return jumps_; }  ///< readings that cannot be motion

 private:
  DriveGeometry geometry_;
  double max_wheel_radps_;
  Pose2 pose_;
  std::optional<EncoderReading> last_;
  std::int64_t jumps_ = 0;
};

}  // namespace pilotfish::base
PILOTFISH_API_END
