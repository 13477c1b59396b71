#include "visp_scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <random>

#include "pilotfish/visp/conversions.hpp"

namespace pilotfish::bench {
namespace {

constexpr std::size_t kNoiseOffsets = 65536;

/// vpImageSimulator takes the texture's pixel (int)(t (size - 1)) for t in [0, 1): with one pixel more than there are
/// cells it finds every cell's edges where they are. Between pixels (bilinear) the edge between two pixels is half a
/// pixel too early: 1/40 of a cell with 20 pixels each.
vpImage<unsigned char> texture_of(const sim::Surface& surface, bool bilinear) {
  const int per_cell = bilinear ? 20 : 1, side = surface.cells * per_cell + 1;
  vpImage<unsigned char> texture(static_cast<unsigned>(side), static_cast<unsigned>(side));
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      const int i = std::min(row / per_cell, surface.cells - 1), j = std::min(column / per_cell, surface.cells - 1);
      texture[row][column] = static_cast<unsigned char>(
          std::lround(surface.grays[static_cast<std::size_t>(i) * static_cast<std::size_t>(surface.cells) + j]));
    }
  return texture;
}

}  // namespace

VispScene::VispScene(const std::vector<sim::Surface>& surfaces, const CameraModel& camera,
                     const sim::Imperfections& imperfections, const std::vector<std::uint8_t>& background,
                     bool bilinear)
    : camera_(camera.fx, camera.fy, camera.cx, camera.cy),
      imperfections_(imperfections),
      background_(static_cast<unsigned>(camera.height), static_cast<unsigned>(camera.width)),
      picture_(background_) {
  std::memcpy(background_.bitmap, background.data(), background_.getSize());
  planes_.resize(surfaces.size());
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const sim::Surface& surface = surfaces[i];
    const Eigen::Vector3d &c = surface.centre_m, &a = surface.half_a_m, &b = surface.half_b_m;
    vpColVector corners[4];
    const Eigen::Vector3d points[4] = {c - a - b, c + a - b, c + a + b, c - a + b};
    for (int k = 0; k < 4; ++k) {
      corners[k].resize(3);
      for (unsigned axis = 0; axis < 3; ++axis) corners[k][axis] = points[k][axis];
    }
    Plane& plane = planes_[i];
    plane.simulator.init(texture_of(surface, bilinear), corners);
    plane.simulator.setInterpolationType(bilinear ? vpImageSimulator::BILINEAR_INTERPOLATION
                                                  : vpImageSimulator::SIMPLE);
    plane.centre_m = c;
    plane.is_sheet = surface.is_sheet;
  }
  if (imperfections.noise_sigma > 0.0) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal(0.0, imperfections.noise_sigma);
    noise_.resize(picture_.getSize() + kNoiseOffsets);
    for (std::int16_t& each : noise_)
      each = static_cast<std::int16_t>(std::clamp(std::lround(normal(random)), -255L, 255L));
  }
  for (int gray = -256; gray < 512; ++gray)
    response_.push_back(static_cast<unsigned char>(
        std::lround(255.0 * std::pow(std::clamp(gray, 0, 255) / 255.0, 1.0 / imperfections.gamma))));
}

/// The faces of a box that can be seen do not overlap; sheets lie on them and are drawn afterwards, the farthest first.
/// No z-buffer is needed.
const vpImage<unsigned char>& VispScene::picture(const Eigen::Isometry3d& cMo, std::uint64_t noise_seed) {
  std::memcpy(picture_.bitmap, background_.bitmap, background_.getSize());
  const vpHomogeneousMatrix pose = visp::homogeneous_of(cMo);
  std::vector<std::pair<double, Plane*>> order;
  for (Plane& plane : planes_) {
    plane.simulator.setCameraPosition(pose);
    order.emplace_back(plane.is_sheet ? -(cMo * plane.centre_m).z() : -1e9, &plane);
  }
  std::stable_sort(order.begin(), order.end(), [](const auto& one, const auto& two) { return one.first < two.first; });
  for (const auto& [depth, plane] : order) plane->simulator.getImage(picture_, camera_);
  disturb(noise_seed);
  return picture_;
}

void VispScene::disturb(std::uint64_t noise_seed) {
  if (const double sigma_px = imperfections_.blur_sigma_px; sigma_px > 0.0) {
    const int side = 2 * static_cast<int>(std::ceil(3.0 * sigma_px)) + 1;
    cv::Mat image(static_cast<int>(picture_.getHeight()), static_cast<int>(picture_.getWidth()), CV_8UC1,
                  picture_.bitmap);
    cv::GaussianBlur(image, image, {side, side}, sigma_px, sigma_px, cv::BORDER_REPLICATE);
  }
  if (noise_.empty()) return;
  const std::int16_t* noise = noise_.data() + noise_seed * 2654435761U % kNoiseOffsets;
  const unsigned char* response = response_.data() + 256;
  const std::size_t count = picture_.getSize();
  for (std::size_t i = 0; i < count; ++i) picture_.bitmap[i] = response[picture_.bitmap[i] + noise[i]];
}

}  // namespace pilotfish::bench
