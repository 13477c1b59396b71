#include "background.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "pilotfish/core/angles.hpp"
#include "random.hpp"

namespace pilotfish::sim {
namespace {

// The cylinder: columns are azimuth, clockwise; rows are the tangent of the elevation, from kTop down to
// -kTop. At 652 columns a radian it is about as fine as a picture with f = 600 px.
constexpr int kColumns = 4096;
constexpr int kRows = 1024;
constexpr double kTop = 0.785;
constexpr int kStride = kColumns + 1;  // the first column once more, so that the last one has a neighbour

int row_of(double tangent) { return static_cast<int>(std::lround((kTop - tangent) / (2.0 * kTop) * kRows)); }

/// Shapes that run over the seam come in again on the other side.
template <class Draw>
void draw_around(const Draw& draw) {
  for (int shift : {-kColumns, 0}) draw(shift);
}

void draw_rectangle(cv::Mat& wall, Random& random, int left, int top, int width, int height, int gray) {
  draw_around([&](int shift) {
    cv::rectangle(wall, cv::Rect(left + shift, top, width, height), cv::Scalar(gray), cv::FILLED);
  });
  // Some carry a frame, some a pattern of squares: which confuse a detector of squares.
  const int kind = random.integer(0, 3);
  if (kind == 0)
    draw_around(
        [&](int shift) { cv::rectangle(wall, cv::Rect(left + shift, top, width, height), cv::Scalar(255 - gray), 3); });
  if (kind != 1) return;
  const int cell = random.integer(6, 24);
  for (int y = 0; y + cell <= height; y += cell)
    for (int x = 0; x + cell <= width; x += cell) {
      if (random.integer(0, 1) == 0) continue;
      const int shade = random.integer(20, 235);
      draw_around([&](int shift) {
        cv::rectangle(wall, cv::Rect(left + x + shift, top + y, cell, cell), cv::Scalar(shade), cv::FILLED);
      });
    }
}

cv::Mat painted_wall(std::uint64_t seed) {
  Random random(seed);
  cv::Mat wall(kRows, kColumns, CV_8UC1);
  const int skirting = row_of(-0.08);  // where the wall meets the floor: 3 m away for a camera 0.25 m high
  for (int row = 0; row < kRows; ++row)
    wall.row(row).setTo(row < skirting ? 140 + row * 40 / skirting : 80 + (row - skirting) * 60 / (kRows - skirting));
  // Tiles of 0.3 m: joints straight ahead, and rows of joints that come closer together towards the wall.
  for (int tile = 1; tile < 10; ++tile) {
    const int row = row_of(-0.25 / (0.3 * tile));
    cv::line(wall, {0, row}, {kColumns, row}, cv::Scalar(60), 2);
  }
  for (int column = 0; column < kColumns; column += 128)
    cv::line(wall, {column, skirting}, {column, kRows}, cv::Scalar(60), 2);
  cv::line(wall, {0, skirting}, {kColumns, skirting}, cv::Scalar(40), 8);
  for (int i = 0; i < 70; ++i) {
    const int left = random.integer(0, kColumns - 1), top = random.integer(0, skirting - 40);
    const int width = random.integer(20, 260), height = random.integer(20, 220);
    draw_rectangle(wall, random, left, top, width, std::min(height, skirting - top), random.integer(20, 235));
  }
  for (int i = 0; i < 40; ++i) {
    const cv::Point from(random.integer(0, kColumns - 1), random.integer(0, kRows - 1));
    const cv::Point by(random.integer(-250, 250), random.integer(-150, 150));
    const int gray = random.integer(20, 235), thickness = random.integer(1, 5);
    draw_around([&](int shift) {
      cv::line(wall, from + cv::Point(shift, 0), from + by + cv::Point(shift, 0), cv::Scalar(gray), thickness);
    });
  }
  return wall;
}

}  // namespace

Background::Background(const RayGrid& grid, const CameraMounting& mounting, double contrast, std::uint64_t seed) {
  const cv::Mat wall = painted_wall(seed);
  panorama_.resize(static_cast<std::size_t>(kRows) * kStride);
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kStride; ++column)
      panorama_[static_cast<std::size_t>(row) * kStride + column] =
          cv::saturate_cast<std::uint8_t>(128.0 + contrast * (wall.at<std::uint8_t>(row, column % kColumns) - 128.0));

  const Eigen::Matrix3d bRc = base_from_camera(mounting).linear();
  places_.reserve(static_cast<std::size_t>(grid.columns - 1) * (grid.rows - 1));
  for (int v = 0; v + 1 < grid.rows; ++v)
    for (int u = 0; u + 1 < grid.columns; ++u) {
      // The centre of a pixel is near enough the middle of two opposite corners.
      const std::size_t upper = static_cast<std::size_t>(v) * grid.columns + u, lower = upper + grid.columns + 1;
      const Eigen::Vector3d ray((grid.x[upper] + grid.x[lower]) / 2.0, (grid.y[upper] + grid.y[lower]) / 2.0, 1.0);
      const Eigen::Vector3d direction = bRc * ray;
      const double azimuth_rad = std::atan2(direction.y(), direction.x());
      const double tangent = direction.z() / std::hypot(direction.x(), direction.y());
      const double row = std::clamp((kTop - tangent) / (2.0 * kTop) * kRows, 0.0, kRows - 1.01);
      places_.push_back({static_cast<std::int32_t>(std::lround(-azimuth_rad / (2.0 * kPi) * kColumns * 256.0)),
                         static_cast<std::int32_t>(row) * kStride,
                         static_cast<std::uint16_t>((row - std::floor(row)) * 256.0)});
    }
}

void Background::paint(double robot_heading_rad, Gray16* image) const {
  const auto turned =
      static_cast<std::int32_t>(std::lround(-wrap_angle(robot_heading_rad) / (2.0 * kPi) * kColumns * 256.0));
  for (const Place& place : places_) {
    const auto column = static_cast<std::uint32_t>(place.column + turned);
    const std::uint8_t* at = panorama_.data() + place.row_start + ((column >> 8) & (kColumns - 1));
    const std::uint32_t right = column & 255, left = 256 - right, below = place.row_part, above = 256 - below;
    const std::uint32_t upper = left * at[0] + right * at[1], lower = left * at[kStride] + right * at[kStride + 1];
    *image++ = static_cast<Gray16>((above * upper + below * lower) >> 8);
  }
}

}  // namespace pilotfish::sim
