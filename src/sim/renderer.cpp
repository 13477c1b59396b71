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

/// Of the pixels from `first` to before `end`, into the first picture.
void average(std::vector<std::vector<Gray16>>& pictures, std::size_t count, std::size_t first, std::size_t end) {
  for (std::size_t i = first; i < end; ++i) {
    std::size_t sum = count / 2;
    for (std::size_t k = 0; k < count; ++k) sum += pictures[k][i];
    pictures[0][i] = static_cast<Gray16>(sum / count);
  }
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
  return render_bands({{optics_->camera.height, instants}}, noise_seed);
}

std::vector<std::uint8_t> Renderer::render_bands(const std::vector<RowBand>& bands, std::uint64_t noise_seed) const {
  const CameraModel& camera = optics_->camera;
  const auto width = static_cast<std::size_t>(camera.width);
  if (bands.empty() || bands.back().end_row != camera.height)
    throw std::invalid_argument("bands that do not make the whole picture");
  std::vector<std::vector<Gray16>> sharp(1, std::vector<Gray16>(width * camera.height));
  int row = 0;
  for (const RowBand& band : bands) {
    if (band.instants.empty()) throw std::invalid_argument("a picture of no instant at all");
    if (band.end_row <= row) throw std::invalid_argument("a band without rows");
    const std::size_t first = row * width, end = band.end_row * width;
    while (sharp.size() < band.instants.size()) sharp.emplace_back(width * camera.height);
    for (std::size_t k = 0; k < band.instants.size(); ++k) {
      optics_->background.paint(band.instants[k].camera_heading_rad, first, end, sharp[k].data());
      draw(camera, optics_->grid, band.instants[k].bodies, row, band.end_row, sharp[k].data());
    }
    if (band.instants.size() > 1) average(sharp, band.instants.size(), first, end);
    row = band.end_row;
  }
  std::vector<Gray16>& grays = sharp[0];
  cv::Mat soft;
  if (optics_->imperfections.blur_sigma_px > 0.0)
    soft = blurred(grays, camera.width, camera.height, optics_->imperfections.blur_sigma_px);
  const Gray16* exposed = soft.empty() ? grays.data() : soft.ptr<Gray16>();
  std::vector<std::uint8_t> pixels;
  optics_->noise.expose(exposed, grays.size(), optics_->imperfections.exposure_gain, noise_seed, pixels);
  return pixels;
}

}  // namespace pilotfish::sim
