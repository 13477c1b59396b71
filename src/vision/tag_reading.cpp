#include "tag_reading.hpp"

#include <algorithm>
#include <cmath>

#include "tag_warp.hpp"

// A cell is compared with the expected appearance of a right and of a wrong one there, blurred as the picture is. With
// s the share of a neighbour in the blurred middle of a cell, Phi(-c / (2 sigma)) along each axis, the middle of a cell
// shows
//
//   T = sum over its 3 x 3 cells of a_i a_j colour_ij,    a = (s, 1 - 2 s, s)
//
// and were the cell of the other colour, T would differ by (1 - 2 s_x)(1 - 2 s_y). The bit is right if the gray is
// nearer to the first. So a single white cell in the black is read where a threshold in the middle would lose it.

namespace pilotfish::vision {
namespace {

double bilinear(const ImageView& image, const Eigen::Vector2d& pixel) {
  const double u = std::clamp(pixel.x(), 0.0, image.width - 1.001),
               v = std::clamp(pixel.y(), 0.0, image.height - 1.001);
  const auto column = static_cast<std::ptrdiff_t>(u), row = static_cast<std::ptrdiff_t>(v);
  const double a = u - static_cast<double>(column), b = v - static_cast<double>(row);
  const std::uint8_t* p = image.data + row * image.stride_bytes + column;
  const std::uint8_t* q = p + image.stride_bytes;
  return (1 - b) * ((1 - a) * p[0] + a * p[1]) + b * ((1 - a) * q[0] + a * q[1]);
}

double neighbours_share(double cell_sigmas) { return 0.5 * std::erfc(0.5 * cell_sigmas / std::sqrt(2.0)); }

}  // namespace

TagReading read_tag(const ImageView& image, const CameraModel& camera, const TagPattern& pattern,
                    const Registration& registration) noexcept {
  const TagWarp warp(camera, registration.nHt);
  const Appearance& look = registration.appearance;
  const Eigen::Matrix2d G2 = warp.flat_jacobian(Eigen::Vector2d::Zero()).inverse().cwiseAbs2();
  // Linear interpolation between pixels blurs a little more, by 1/6 px^2 on average.
  const Eigen::Vector2d variance = G2 * Eigen::Vector2d(look.blur_u_px2 + 1.0 / 6.0, look.blur_v_px2 + 1.0 / 6.0);
  const double sx = neighbours_share(pattern.cell_side / std::sqrt(variance.x()));
  const double sy = neighbours_share(pattern.cell_side / std::sqrt(variance.y()));
  const double ax[3] = {sx, 1 - 2 * sx, sx}, ay[3] = {sy, 1 - 2 * sy, sy};

  TagReading reading;
  int bits = 0;
  for (const TagPattern::Cell& cell : pattern.known) {
    const double gray = bilinear(image, warp.pixel(camera, warp.flat(cell.centre)));
    const auto column = static_cast<int>(cell.centre.x() / pattern.cell_side + 0.5 * pattern.cells);
    const auto row = static_cast<int>(cell.centre.y() / pattern.cell_side + 0.5 * pattern.cells);
    double T = 0.0;
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i)
        T += ax[i + 1] * ay[j + 1] * pattern.colour[static_cast<std::size_t>(row + j) * pattern.cells + column + i];
    const double black = look.black + look.black_slope.dot(cell.centre);
    const double contrast = look.contrast() + look.contrast_slope.dot(cell.centre);
    const double sign = cell.white ? 1.0 : -1.0;
    // Half of the change that the other colour would make, less the difference from the right one.
    const double certainty = 0.5 * contrast * ax[1] * ay[1] + sign * (gray - (black + contrast * T));
    if (cell.data) {
      ++bits;
      reading.wrong_bits += certainty <= 0.0 ? 1 : 0;
      reading.decision_margin += 2.0 * sign * (gray - (black + 0.5 * contrast));
    } else {
      ++reading.frame_cells;
      reading.wrong_frame_cells += certainty <= 0.0 ? 1 : 0;
    }
  }
  reading.decision_margin /= std::max(bits, 1);
  return reading;
}

}  // namespace pilotfish::vision
