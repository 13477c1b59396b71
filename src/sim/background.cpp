#include "background.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "pilotfish/core/angles.hpp"
#include "random.hpp"
#include "wider_registers.hpp"

namespace pilotfish::sim {
namespace {

// The cylinder: columns are azimuth, clockwise; rows are the tangent of the elevation, from kTop down to
// -kTop. At 652 columns a radian it is about as fine as a picture with f = 600 px.
constexpr int kColumns = 4096;
constexpr int kRows = 1024;
constexpr double kTop = 0.785;

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

/// Bilinear, in integers. Of each word `mix` has the upper two pixels, mixed, in its lower half, and the lower two in
/// its upper half: 256 * 255 fits into 16 bits.
PILOTFISH_FOR_WIDER_REGISTERS
void interpolate(const std::uint32_t* words, const std::uint32_t* columns, const std::uint32_t* rows,
                 std::uint32_t turned, std::size_t count, Gray16* image) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t column = columns[i] + turned, row = rows[i], word = words[i];
    const std::uint32_t right = column & 255, left = 256 - right, below = row & 255, above = 256 - below;
    const std::uint32_t mix = (word & 0x00FF00FF) * left + ((word >> 8) & 0x00FF00FF) * right;
    image[i] = static_cast<Gray16>((above * (mix & 0xFFFF) + below * (mix >> 16)) >> 8);
  }
}

}  // namespace

Background::Background(const RayGrid& grid, const CameraMounting& mounting, double contrast, std::uint64_t seed)
    : plain_(contrast == 0.0) {
  const Eigen::Matrix3d bRc = base_from_camera(mounting).linear();
  const std::size_t pixels = static_cast<std::size_t>(grid.columns - 1) * (grid.rows - 1);
  columns_.reserve(pixels);
  rows_.reserve(pixels);
  int first_row = kRows, last_row = 0;
  for (int v = 0; v + 1 < grid.rows; ++v)
    for (int u = 0; u + 1 < grid.columns; ++u) {
      // The centre of a pixel is near enough the middle of two opposite corners.
      const std::size_t upper = static_cast<std::size_t>(v) * grid.columns + u, lower = upper + grid.columns + 1;
      const Eigen::Vector3d ray((grid.x[upper] + grid.x[lower]) / 2.0, (grid.y[upper] + grid.y[lower]) / 2.0, 1.0);
      const Eigen::Vector3d direction = bRc * ray;
      const double azimuth_rad = std::atan2(direction.y(), direction.x());
      const double tangent = direction.z() / std::hypot(direction.x(), direction.y());
      const double row = std::clamp((kTop - tangent) / (2.0 * kTop) * kRows, 0.0, kRows - 1.01);
      const int whole_row = static_cast<int>(row);
      first_row = std::min(first_row, whole_row);
      last_row = std::max(last_row, whole_row);
      columns_.push_back(
          static_cast<std::uint32_t>(std::lround(-azimuth_rad / (2.0 * kPi) * kColumns * 256.0)));  // modulo 2^32
      rows_.push_back(static_cast<std::uint32_t>(whole_row) * kColumns * 256U +
                      static_cast<std::uint32_t>((row - std::floor(row)) * 256.0));
    }
  for (std::uint32_t& row : rows_) row -= static_cast<std::uint32_t>(first_row) * kColumns * 256U;

  std::array<std::uint32_t, 256> with_contrast;
  for (std::size_t gray = 0; gray < with_contrast.size(); ++gray)
    with_contrast[gray] = cv::saturate_cast<std::uint8_t>(128.0 + contrast * (static_cast<double>(gray) - 128.0));
  const cv::Mat wall = painted_wall(seed);
  panorama_.reserve(static_cast<std::size_t>(last_row - first_row + 1) * kColumns);
  for (int row = first_row; row <= last_row; ++row) {
    const std::uint8_t *here = wall.ptr(row), *below = wall.ptr(row + 1);
    for (int column = 0; column < kColumns; ++column) {
      const int next = (column + 1) % kColumns;
      panorama_.push_back(with_contrast[here[column]] | with_contrast[here[next]] << 8 |
                          with_contrast[below[column]] << 16 | with_contrast[below[next]] << 24);
    }
  }
}

void Background::paint(double robot_heading_rad, std::size_t first, std::size_t end, Gray16* image) const {
  if (plain_) {
    std::fill(image + first, image + end, static_cast<Gray16>(128 * 256));
    return;
  }
  const auto turned =
      static_cast<std::uint32_t>(std::lround(-wrap_angle(robot_heading_rad) / (2.0 * kPi) * kColumns * 256.0));
  std::array<std::uint32_t, 1024> words;  // looked up one by one: gathering is no faster
  for (std::size_t begin = first; begin < end; begin += words.size()) {
    const std::size_t count = std::min(words.size(), end - begin);
    const std::uint32_t *columns = columns_.data() + begin, *rows = rows_.data() + begin;
    for (std::size_t i = 0; i < count; ++i)
      words[i] = panorama_[(rows[i] >> 8) + (((columns[i] + turned) >> 8) & (kColumns - 1))];
    interpolate(words.data(), columns, rows, turned, count, image + begin);
  }
}

}  // namespace pilotfish::sim
