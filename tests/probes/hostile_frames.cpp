#include "hostile_frames.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "pilotfish/sim/renderer.hpp"
#include "pilotfish/sim/robot_body.hpp"

namespace pilotfish::probes {
namespace {

constexpr std::pair<int, int> kUsualSizes[] = {{160, 120}, {161, 119}, {320, 240}, {400, 300}};
constexpr std::pair<int, int> kOddSizes[] = {{16, 16}, {17, 31}, {64, 48}, {4000, 16}, {16, 2000}, {97, 640}};
constexpr std::array<const char*, 9> kFamilies = {"tag36h11",      "tag36h10",         "tag25h9",
                                                  "tag16h5",       "tagStandard41h12", "tagStandard52h13",
                                                  "tagCircle21h7", "tagCircle49h12",   "tagCustom48h12"};
constexpr int kIdsEverywhere = 30;  ///< the smallest family has so many

/// Lenses from none to nonsense: each coefficient up to 10^reach.
double any_distortion(RandomNumbers& random, double reach) {
  return (random.once_in(2) ? 1.0 : -1.0) * std::pow(10.0, random.between(-3.0, reach));
}

void push_back_repeated(std::vector<std::uint8_t>& bytes, std::uint8_t value, int count) {
  bytes.insert(bytes.end(), static_cast<std::size_t>(count), value);
}

}  // namespace

CameraModel plain_camera(int width, int height) {
  CameraModel camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 0.9 * std::max(width, height);
  camera.cx = 0.5 * width - 0.5;
  camera.cy = 0.5 * height - 0.5;
  return camera;
}

CameraModel any_camera(RandomNumbers& random) {
  const auto [width, height] = random.once_in(4) ? kOddSizes[random.below(6)] : kUsualSizes[random.below(4)];
  CameraModel camera = plain_camera(width, height);
  const double longest = std::max(width, height);
  switch (random.below(6)) {
    case 0:  // a real lens
      camera.k1 = random.between(-0.3, 0.1);
      camera.k2 = random.between(-0.05, 0.1);
      camera.p1 = random.between(-0.01, 0.01);
      break;
    case 1:  // any pinhole
      camera.fx = longest * std::pow(10.0, random.between(-0.99, 1.99));
      camera.fy = std::clamp(camera.fx * random.between(0.81, 1.24), 0.1 * longest, 99.0 * longest);
      camera.cx = random.between(0.01, width - 0.01);
      camera.cy = random.between(0.01, height - 0.01);
      break;
    case 2: {  // no lens at all
      const double reach = random.once_in(4) ? 300.0 : 1.0;
      for (double CameraModel::*k :
           {&CameraModel::k1, &CameraModel::k2, &CameraModel::p1, &CameraModel::p2, &CameraModel::k3})
        if (random.once_in(2)) camera.*k = any_distortion(random, reach);
      break;
    }
    default: break;
  }
  try {
    camera.validate();
  } catch (const ConfigError&) {  // what no program can be given
    return plain_camera(width, height);
  }
  return camera;
}

LeaderBody any_body(RandomNumbers& random) {
  LeaderBody body;
  body.family = random.once_in(2) ? kFamilies[0] : kFamilies[random.below(kFamilies.size())];
  const int count = random.once_in(3) ? static_cast<int>(kMaxTagsOnBody) : 1 + random.below(3);
  const int first = random.below(kIdsEverywhere - count + 1);
  for (int i = 0; i < count; ++i) {
    BodyTag tag;
    tag.id = first + i;
    tag.size_m = std::pow(10.0, random.between(-2.0, 0.0));
    if (i > 0) {
      for (double& coordinate : tag.position_m) coordinate = random.between(-0.5, 0.5);
      tag.facing_rad = random.between(-3.1, 3.1);
      tag.tilt_rad = random.between(-1.5, 1.5);
      tag.roll_rad = random.between(-3.1, 3.1);
    }
    body.tags.push_back(tag);
  }
  return body;
}

Picture with_leader(const LeaderBody& body, const CameraModel& plain, RandomNumbers& random) {
  sim::RobotBody robot;
  robot.leader = body;
  const std::vector<sim::Surface> surfaces = sim::surfaces_of(robot);
  // The first tag looks to the rear: seen from behind and near enough to be read, or too near to be whole.
  const double depth_m = plain.fx * body.tags.front().size_m / (random.between(0.2, 1.1) * plain.height);
  Eigen::Isometry3d cMo = Eigen::Isometry3d::Identity();
  cMo.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;  // base (x ahead, y left, z up) to camera (x right, y down, z ahead)
  cMo.linear() *= Eigen::AngleAxisd(random.between(-0.9, 0.9), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  cMo.translation() << random.between(-0.3, 0.3) * depth_m, random.between(-0.25, 0.25) * depth_m, depth_m;
  sim::View view;
  view.bodies.push_back({&surfaces, cMo});
  const sim::Renderer renderer(plain, {}, {}, random.bits());
  Picture picture{renderer.render({view}, random.bits()), plain.width, plain.height, plain.width};
  if (random.once_in(3)) {
    Picture padded{{}, plain.width, plain.height, plain.width + 1 + random.below(70)};
    for (int v = 0; v < plain.height; ++v) {
      const auto row = picture.bytes.begin() + static_cast<std::ptrdiff_t>(v) * plain.width;
      padded.bytes.insert(padded.bytes.end(), row, row + plain.width);
      if (v + 1 < plain.height) push_back_repeated(padded.bytes, 77, padded.stride_bytes - plain.width);
    }
    padded.bytes.shrink_to_fit();
    return padded;
  }
  return picture;
}

Picture without_sense(int width, int height, RandomNumbers& random) {
  Picture picture{std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height), width, height, width};
  const int kind = random.below(4), side = 1 + random.below(20);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      std::uint8_t& gray = picture.bytes[static_cast<std::size_t>(v) * width + u];
      switch (kind) {
        case 0: gray = static_cast<std::uint8_t>(random.bits()); break;
        case 1: gray = static_cast<std::uint8_t>((u / side + v / side) % 2 == 0 ? 255 : 0); break;
        case 2: gray = static_cast<std::uint8_t>(u * side + v); break;
        default: gray = static_cast<std::uint8_t>(13 * side); break;
      }
    }
  return picture;
}

void disturb(Picture& picture, RandomNumbers& random) {
  std::vector<std::uint8_t>& bytes = picture.bytes;
  switch (random.below(5)) {
    case 0: break;
    case 1:
      for (std::uint8_t& gray : bytes) gray = static_cast<std::uint8_t>(gray ^ (random.bits() & 31U));
      break;
    case 2:
      for (std::uint8_t& gray : bytes) gray = static_cast<std::uint8_t>(255 - gray);
      break;
    case 3:  // by rows and columns at once
      std::rotate(bytes.begin(), bytes.begin() + random.below(static_cast<int>(bytes.size())), bytes.end());
      break;
    default: {
      const int left = random.below(picture.width), top = random.below(picture.height);
      const int width = 1 + random.below(picture.width - left), height = 1 + random.below(picture.height - top);
      for (int v = top; v < top + height; ++v)
        std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(v) * picture.stride_bytes + left, width,
                    static_cast<std::uint8_t>(random.bits()));
    }
  }
}

Frame claimed(Picture picture, std::int64_t utime, RandomNumbers& random) {
  auto bytes = std::make_shared<const std::vector<std::uint8_t>>(std::move(picture.bytes));
  Frame frame;
  frame.utime = utime;
  frame.image = {bytes->data(), bytes->size(), picture.width, picture.height, picture.stride_bytes};
  if (random.once_in(10)) {
    const int any[] = {-1,
                       0,
                       1,
                       15,
                       picture.width + 1,
                       16384,
                       16385,
                       std::numeric_limits<int>::max(),
                       std::numeric_limits<int>::min()};
    int ImageView::*const claims[] = {&ImageView::width, &ImageView::height, &ImageView::stride_bytes};
    frame.image.*claims[random.below(3)] = any[random.below(9)];
  } else if (random.once_in(10)) {  // cut off on its way
    const std::size_t left = random.bits() % bytes->size();
    bytes = std::make_shared<const std::vector<std::uint8_t>>(bytes->begin(),
                                                              bytes->begin() + static_cast<std::ptrdiff_t>(left));
    frame.image.data = bytes->data();
    frame.image.size_bytes = left;
  }
  frame.pixels_owner = bytes;
  return frame;
}

}  // namespace pilotfish::probes
