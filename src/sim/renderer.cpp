#include "pilotfish/sim/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "background.hpp"
#include "noise.hpp"
#include "rasterizer.hpp"

namespace pilotfish::sim {
namespace {

std::vector<Gray16> mean(const std::vector<std::vector<Gray16>>& pictures) {
  std::vector<Gray16> result(pictures[0].size());
  const std::size_t count = pictures.size();
  for (std::size_t i = 0; i < result.size(); ++i) {
    std::size_t sum = count / 2;
    for (const std::vector<Gray16>& picture : pictures) sum += picture[i];
    result[i] = static_cast<Gray16>(sum / count);
  }
  return result;
}

/// In place OpenCV would copy the picture first.
cv::Mat blurred(std::vector<Gray16>& grays, int width, int height, double sigma_px) {
  const int reach = static_cast<int>(std::ceil(3.0 * sigma_px));
  const cv::Mat image(height, width, CV_16UC1, grays.data());
  cv::Mat result;
  cv::GaussianBlur(image, result, cv::Size(2 * reach + 1, 2 * reach + 1), sigma_px, sigma_px, cv::BORDER_REPLICATE);
  return result;
}

}  // namespace

/// What is computed once per camera.
struct Renderer::Optics {
  CameraModel camera;
  Imperfections imperfections;
  RayGrid grid;
  Background background;
  NoiseTable noise;
};

Renderer::Renderer(const CameraModel& camera, const CameraMounting& mounting, const Imperfections& imperfections,
                   std::uint64_t clutter_seed) {
  camera.validate();
  check_ranges(mounting, "mounting");
  check_ranges(imperfections, "imperfections");
  const RayGrid grid(camera);
  optics_.reset(new Optics{camera, imperfections, grid, Background(grid, mounting, imperfections.clutter, clutter_seed),
                           NoiseTable(imperfections.noise_sigma, imperfections.shot_noise, imperfections.gamma)});
}

const CameraModel& Renderer::camera() const { return optics_->camera; }
const Imperfections& Renderer::imperfections() const { return optics_->imperfections; }

std::vector<std::uint8_t> Renderer::render(const std::vector<View>& instants, std::uint64_t noise_seed) const {
  if (instants.empty()) throw std::invalid_argument("a picture of no instant at all");
  const CameraModel& camera = optics_->camera;
  std::vector<std::vector<Gray16>> sharp;
  for (const View& view : instants) {
    sharp.emplace_back(static_cast<std::size_t>(camera.width) * camera.height);
    optics_->background.paint(view.camera_heading_rad, sharp.back().data());
    draw(camera, optics_->grid, view.bodies, sharp.back().data());
  }
  std::vector<Gray16> grays = sharp.size() == 1 ? std::move(sharp[0]) : mean(sharp);
  cv::Mat soft;
  if (optics_->imperfections.blur_sigma_px > 0.0)
    soft = blurred(grays, camera.width, camera.height, optics_->imperfections.blur_sigma_px);
  const Gray16* exposed = soft.empty() ? grays.data() : soft.ptr<Gray16>();
  std::vector<std::uint8_t> pixels;
  optics_->noise.expose(exposed, grays.size(), optics_->imperfections.exposure_gain, noise_seed, pixels);
  return pixels;
}

}  // namespace pilotfish::sim
