#include "tag_reading.hpp"

#include <algorithm>
#include <cmath>

#include "is_inside.hpp"
#include "level_field.hpp"
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

constexpr double kBeside_cells = 0.2;  ///< from a cell's middle; a ring cut to half its width is still white there
constexpr double kSmoothReach_cells = 1.5, kSteppedReach_cells = 0.9;
constexpr double kMinLocalContrast = 0.3;  ///< of the tag's: with less around a cell, it is not read

/// The shares of the cells to the left, here and to the right in the blurred template, `offset` from a cell's middle;
/// both in cells.
struct Shares {
  double left, own, right;
  Shares(double offset, double sigma) {
    const auto beyond = [sigma](double distance) { return 0.5 * std::erfc(distance / (sigma * std::sqrt(2.0))); };
    left = beyond(0.5 + offset);
    right = beyond(0.5 - offset);
    own = 1.0 - left - right;
  }
};

TagReading read_cells(const ImageView& image, const CameraModel& camera, const TagPattern& pattern,
                      const Registration& registration, const LevelField* light) {
  const TagWarp warp(camera, registration.nHt, registration.bend);
  const Appearance& appearance = registration.appearance;
  const Eigen::Matrix2d G2 = warp.flat_jacobian(Eigen::Vector2d::Zero()).inverse().cwiseAbs2();
  // Linear interpolation between pixels blurs a little more, by 1/6 px^2 on average.
  const Eigen::Vector2d variance =
      G2 * Eigen::Vector2d(appearance.blur_u_px2 + 1.0 / 6.0, appearance.blur_v_px2 + 1.0 / 6.0);
  const Eigen::Vector2d sigma = variance.cwiseSqrt() / pattern.cell_side;
  const double rim = 0.5 * (pattern.cells - 2 * TagPattern::kMargin) * pattern.cell_side - 0.75 * pattern.cell_side;

  // By offset: to the left or up, none, to the right or down.
  const Shares shares_x[3] = {{-kBeside_cells, sigma.x()}, {0.0, sigma.x()}, {kBeside_cells, sigma.x()}};
  const Shares shares_y[3] = {{-kBeside_cells, sigma.y()}, {0.0, sigma.y()}, {kBeside_cells, sigma.y()}};
  const double mean_share = registration.light ? registration.light->mean_share() : 0.0;
  TagReading reading;
  double sum = 0.0;
  for (const TagPattern::Cell& cell : pattern.known) {
    const auto column = static_cast<int>(cell.centre.x() / pattern.cell_side + 0.5 * pattern.cells);
    const auto row = static_cast<int>(cell.centre.y() / pattern.cell_side + 0.5 * pattern.cells);
    const double sign = cell.white ? 1.0 : -1.0;
    const auto levels_at = [&](const Eigen::Vector2d& place) -> LevelField::Levels {
      if (light != nullptr) return light->at(cell.centre);
      double black = appearance.black + appearance.black_slope.dot(place);
      double contrast = appearance.contrast() + appearance.contrast_slope.dot(place);
      if (registration.light) {
        const double more = registration.light->share_at(place) - mean_share;
        black += more * registration.light->black_step;
        contrast += more * registration.light->contrast_step;
      }
      return {std::min(black, 255.0), std::min(black + contrast, 255.0)};
    };
    struct Place {
      Eigen::Vector2d tag, pixel;
    };
    const auto beside = [&](int to_x, int to_y) -> Place {
      const Eigen::Vector2d tag = cell.centre + kBeside_cells * pattern.cell_side * Eigen::Vector2d(to_x, to_y);
      return {tag, warp.pixel(camera, warp.flat(tag))};
    };
    // Half of the change that the other colour would make, less the difference from the right one.
    const auto certainty = [&](const Place& place, int to_x, int to_y, const LevelField::Levels& levels) {
      const Shares &across = shares_x[to_x + 1], &down = shares_y[to_y + 1];
      const auto white_in_row = [&](int j) {
        const std::uint8_t* c = pattern.colour.data() + static_cast<std::ptrdiff_t>(row + j) * pattern.cells + column;
        return across.left * c[-1] + across.own * c[0] + across.right * c[1];
      };
      const double T = down.left * white_in_row(-1) + down.own * white_in_row(0) + down.right * white_in_row(1);
      const double contrast = levels.white - levels.black;
      const double difference = bilinear(image, place.pixel) - (levels.black + contrast * T);
      return 0.5 * contrast * across.own * down.own + sign * difference;
    };

    const auto inwards = [&](double at) { return std::abs(at) > rim && !cell.data ? (at > 0.0 ? -1 : 1) : 0; };
    const int to_x = inwards(cell.centre.x()), to_y = inwards(cell.centre.y());
    const Place place = beside(to_x, to_y);
    const LevelField::Levels levels = levels_at(place.tag);
    const double contrast = levels.white - levels.black;
    if (cell.data) ++reading.bits;
    if (!is_inside(place.pixel, image.width, image.height)) {
      reading.outside_bits += cell.data ? 1 : 0;
      continue;
    }
    if ((light != nullptr || registration.light) && contrast < kMinLocalContrast * appearance.contrast()) {
      reading.unread_bits += cell.data ? 1 : 0;
      continue;
    }
    double certain = certainty(place, to_x, to_y, levels);
    if (!cell.data) {
      ++reading.frame_cells;
      reading.wrong_frame_cells += certain <= 0.0 ? 1 : 0;
      continue;
    }
    if (light != nullptr && certain <= 0.0) {
      // A bit of another tag is of the other colour all over. A spot, of dirt or without toner, is of that size by
      // chance only: where the parts of a cell disagree, most of them decide, or it cannot be read.
      int right = 0;
      for (int x : {-1, 1})
        for (int y : {-1, 1}) right += certainty(beside(x, y), x, y, levels) > 0.0 ? 1 : 0;
      if (right == 1 || right == 2) {
        ++reading.unread_bits;
        continue;
      }
      if (right > 2) certain = 1.0;
    }
    reading.wrong_bits += certain <= 0.0 ? 1 : 0;
    sum += 2.0 * sign * (bilinear(image, place.pixel) - (levels.black + 0.5 * contrast));
  }
  reading.decision_margin = sum / std::max(reading.bits - reading.outside_bits - reading.unread_bits, 1);
  return reading;
}

}  // namespace

TagReading read_tag(const ImageView& image, const CameraModel& camera, const TagPattern& pattern,
                    const Registration& registration) noexcept {
  const auto wrong = [](const TagReading& r) { return r.wrong_bits + r.unread_bits + r.wrong_frame_cells; };
  const TagWarp warp(camera, registration.nHt, registration.bend);
  TagReading best = read_cells(image, camera, pattern, registration, nullptr);
  struct {
    LevelField::Light light;
    double reach_cells;
  } const trials[] = {{LevelField::Light::smooth, kSmoothReach_cells},
                      {LevelField::Light::stepped, kSteppedReach_cells}};
  for (const auto& trial : trials) {
    if (best.wrong_bits == 0 && best.wrong_frame_cells == 0) break;
    LevelField light;
    if (!light.measure(image, camera, warp, pattern, trial.light, trial.reach_cells, true)) break;
    const TagReading reading = read_cells(image, camera, pattern, registration, &light);
    if (wrong(reading) < wrong(best)) best = reading;
  }
  return best;
}

}  // namespace pilotfish::vision
