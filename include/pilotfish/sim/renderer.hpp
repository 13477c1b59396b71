#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/sim/robot_body.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::sim {

/// The differences between an ideal picture and a camera's.
struct Imperfections {
  PILOTFISH_PARAMETERS(Imperfections);
  PILOTFISH_PARAMETER(double, blur_sigma_px, 0.7, 0.0, 20.0, "of the lens's Gaussian blur; 0: sharp");
  /// After the exposure.
  PILOTFISH_PARAMETER(double, noise_sigma, 3.0, 0.0, 100.0, "of white Gaussian noise, in gray levels");
  PILOTFISH_PARAMETER(double, shot_noise, 0.0, 0.0, 100.0,
                      "of the light's own noise at gray 255, in gray levels; it grows as the root of the gray");
  PILOTFISH_PARAMETER(double, gamma, 1.0, 0.5, 4.0,
                      "of the sensor's response: gray^(1/gamma), after the noise; 1: linear, 2.2: most cameras");
  PILOTFISH_PARAMETER(double, exposure_gain, 1.0, 0.01, 10.0, "all grays times this, clipped at 255");
  /// Around the instant of the frame's time.
  PILOTFISH_PARAMETER(double, exposure_time_s, 0.0, 0.0, 0.5, "how long the shutter is open: motion blur");
  PILOTFISH_PARAMETER(int, exposure_samples, 5, 1, 64, "instants averaged if the shutter is open for long");
  /// Row v of H is exposed (v + 1/2 - H/2) / H of this after the frame's time: rolling shutter.
  PILOTFISH_PARAMETER(double, readout_s, 0.0, 0.0, 0.1,
                      "from the exposure of the first row to that of the last: rolling shutter; 0: all rows at once");
  PILOTFISH_PARAMETER(double, clutter, 1.0, 0.0, 1.0, "contrast of the background; 0: a plain wall");
};

/// A body in front of the camera.
struct VisibleBody {
  const std::vector<Surface>* surfaces = nullptr;         ///< see surfaces_of(); nullptr: none. Outlives the call
  Eigen::Isometry3d cMo = Eigen::Isometry3d::Identity();  ///< base frame to camera frame
};

/// A camera's view at one instant.
struct View {
  std::vector<VisibleBody> bodies;  ///< what is in front of the camera
  double camera_heading_rad = 0.0;  ///< of the robot that carries it: the background turns with it
};

/// Rows of a picture that are exposed together, from the band before (or the top) to before end_row.
struct RowBand {
  int end_row = 0;             ///< the first row below it
  std::vector<View> instants;  ///< whose mean they are: one, or several (motion blur)
};

/// A camera, as a function of what is in front of it: gray pictures with exact geometry.
///
/// Every surface is a rectangle in space. Along the ray of the undistorted image point (x, y, 1) its own
/// coordinates are (a, b, 1) ~ M^-1 (x, y, 1) with M = [half_a half_b centre]: so its outline and every line
/// between the cells of a tag is a straight line in (x, y), and on which side a point lies is the sign of a
/// linear function. A pixel that such a line crosses is cut up along those lines, nearest surface first, and
/// each piece counts with its area: edges come out as the exact area-weighted mean, not as a number of
/// samples. The lens distortion sits in the corners of the pixels, which are taken back to (x, y) once per
/// camera by normalize_pixel.
///
/// The background is a wall and a floor full of edges on a cylinder infinitely far away: it turns with the
/// camera and does not come nearer. Same camera, views and seeds: same bytes. The random numbers are our own
/// (no std distribution, whose results depend on the library); blur and shapes of the clutter are
/// OpenCV's integer code. Several threads may use one renderer at once.
class Renderer {
 public:
  /// Throws ConfigError on a camera or imperfections out of range.
  Renderer(const CameraModel& camera, const CameraMounting& mounting, const Imperfections& imperfections,
           std::uint64_t clutter_seed);

  /// The picture, camera.height rows of camera.width bytes: of one instant, or the mean of several (motion blur).
  /// std::invalid_argument if there is none.
  std::vector<std::uint8_t> render(const std::vector<View>& instants, std::uint64_t noise_seed) const;

  /// The same, band by band from the top, of a camera with a rolling shutter. std::invalid_argument unless they make up
  /// the picture.
  std::vector<std::uint8_t> render_bands(const std::vector<RowBand>& bands, std::uint64_t noise_seed) const;

  const CameraModel& camera() const;           ///< size and lens
  const Imperfections& imperfections() const;  ///< of its pictures

 private:
  struct Optics;
  std::shared_ptr<const Optics> optics_;  ///< the same for all copies, which cost no memory
};

}  // namespace pilotfish::sim
PILOTFISH_API_END
