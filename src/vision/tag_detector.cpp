#include "pilotfish/vision/tag_detector.hpp"

#include <apriltag/apriltag.h>

#include <algorithm>
#include <array>
#include <climits>
#include <iterator>
#include <tuple>

#include "gray_tiles.hpp"
#include "pilotfish/vision/tag_family.hpp"

namespace pilotfish::vision {
namespace {

/// libapriltag truncates any other factor to a whole number when it shrinks the image but not when it scales
/// the quads back, so that 2.5 puts them 25 % off.
constexpr double kDecimations[] = {1.0, 1.5, 2.0, 3.0, 4.0};

/// Below so many pixels a cell, on the decimated picture, libapriltag misses quads (docs/vision.md).
constexpr double kMinCell_px = 1.55;

constexpr double kNoiseRange = 1.6;  ///< see least_contrast()

/// Bytes of the decoding table for `corrected_bits`: libapriltag stores every code with every pattern of up
/// to that many flipped bits, 16 bytes each, in a hash table three times that size.
double decoding_table_bytes(const TagFamily& family, int corrected_bits) {
  const double bits = family.bits();
  const double patterns =
      1.0 + (corrected_bits >= 1 ? bits : 0.0) + (corrected_bits >= 2 ? bits * (bits - 1) / 2 : 0.0);
  return 3.0 * 16.0 * family.size() * patterns;
}

/// Tags with more errors than are accepted should still be recognised, so that they can be counted as
/// refused; but for the families with tens of thousands of codes the table for two bits takes gigabytes.
int bits_to_recognise(const TagFamily& family, int max_hamming) {
  if (decoding_table_bytes(family, max_hamming) > 512e6)
    throw ConfigError("vision.max_hamming", std::to_string(max_hamming) + " needs a decoding table of " +
                                                std::to_string(decoding_table_bytes(family, max_hamming) / 1e9) +
                                                " GB with this tag family; use a smaller number");
  int bits = 2;
  while (bits > max_hamming && decoding_table_bytes(family, bits) > 64e6) --bits;
  return bits;
}

/// Where less than this separates black from white, no quads are searched for, in gray levels. The library's own 5
/// finds them in the noise of any camera, which costs two thirds of its time (docs/vision.md); a tag that passes the
/// margin gate has more. The library compares the grays of 12 x 12 pixels, of which noise alone makes 1.5 times the
/// range of 4 x 4; of that, the quarter of the picture in which it is smallest shows the noise.
int least_contrast(const ImageView& image, double min_decision_margin) {
  constexpr int kTile_px = 4, kEvery = 4;  // one tile of sixteen
  std::array<int, 256> histogram{};
  int tiles = 0;
  for (int v = 0; v + kTile_px <= image.height; v += kEvery * kTile_px)
    for (int u = 0; u + kTile_px <= image.width; u += kEvery * kTile_px) {
      ++histogram[gray_range(image, u, v, kTile_px)];
      ++tiles;
    }
  const int range = quantile_of(histogram, tiles, 4);
  return std::clamp(static_cast<int>(std::max(min_decision_margin, kNoiseRange * range)), 5, 60);
}

TagDetection to_tag_detection(const apriltag_detection_t& detection) {
  TagDetection tag;
  tag.id = detection.id;
  tag.hamming = detection.hamming;
  tag.decision_margin = detection.decision_margin;
  // AprilTag's origin is the corner of the top-left pixel, ours is its centre: (0.5, 0.5) there is (0, 0)
  // here. Its order of corners, bottom left first and counter-clockwise as one reads the tag, is ours already.
  for (int i = 0; i < 4; ++i) tag.corners_px[i] = {detection.p[i][0] - 0.5, detection.p[i][1] - 0.5};
  return tag;
}

bool is_finite(const TagDetection& tag) {
  return std::isfinite(tag.decision_margin) && std::all_of(tag.corners_px.begin(), tag.corners_px.end(),
                                                           [](const auto& corner) { return corner.allFinite(); });
}

}  // namespace

struct TagDetector::Library {
  Library(const std::string& family_name, const TagDetectorConfig& config)
      : family(family_name), detector(apriltag_detector_create(), apriltag_detector_destroy) {
    if (!detector) throw std::bad_alloc();
    // Never more: the library's worker pool has a race between a worker's start and the first tasks (3.3.0
    // reads a list that is being reallocated; seen to crash on small pictures, in one of a few hundred first calls).
    detector->nthreads = 1;
    detector->quad_decimate = static_cast<float>(config.decimation);
    detector->quad_sigma = static_cast<float>(config.blur_sigma_px);
    detector->refine_edges = true;
    apriltag_detector_add_family_bits(detector.get(), family.get(), bits_to_recognise(family, config.max_hamming));
  }

  TagFamily family;  // before the detector, which frees what it attached to the family
  std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector;
  std::vector<std::uint8_t> scratch;  ///< the picture, when libapriltag must not be given the caller's
};

namespace {

void merge_tags(const std::vector<TagDetection>& from, const Eigen::Vector2d& origin_px,
                std::vector<TagDetection>& tags) {
  for (TagDetection tag : from) {
    for (Eigen::Vector2d& corner : tag.corners_px) corner += origin_px;
    const auto middle = [](const TagDetection& t) -> Eigen::Vector2d {
      return 0.25 * (t.corners_px[0] + t.corners_px[1] + t.corners_px[2] + t.corners_px[3]);
    };
    const double side_px = (tag.corners_px[2] - tag.corners_px[0]).norm();
    const auto same = std::find_if(tags.begin(), tags.end(), [&](const TagDetection& known) {
      return known.id == tag.id && (middle(known) - middle(tag)).norm() < 0.25 * side_px;
    });
    if (same != tags.end())
      *same = std::move(tag);
    else
      tags.push_back(std::move(tag));
  }
}

}  // namespace

bool Detections::is_unique(int id) const {
  return std::count_if(tags.begin(), tags.end(), [id](const TagDetection& tag) { return tag.id == id; }) == 1;
}

void Detections::merge(const Detections& other, const Eigen::Vector2d& origin_px) {
  merge_tags(other.tags, origin_px, tags);
  merge_tags(other.unsure, origin_px, unsure);
  for (int id : other.refused_ids)
    if (std::find(refused_ids.begin(), refused_ids.end(), id) == refused_ids.end()) refused_ids.push_back(id);
  std::sort(refused_ids.begin(), refused_ids.end());
  refused_hamming = std::max(refused_hamming, other.refused_hamming);
  refused_margin = std::max(refused_margin, other.refused_margin);
}

TagDetector::TagDetector(const std::string& family, const TagDetectorConfig& config) : config_(config) {
  check_ranges(config, "vision");
  if (config_.decimation == 0.0) config_.decimation = 1.0;
  if (std::find(std::begin(kDecimations), std::end(kDecimations), config_.decimation) == std::end(kDecimations))
    throw ConfigError("vision.decimation", std::to_string(config.decimation) + " is not one of 0, 1, 1.5, 2, 3, 4");
  library_ = std::make_unique<Library>(family, config_);
}

TagDetector::~TagDetector() = default;
TagDetector::TagDetector(TagDetector&&) noexcept = default;
TagDetector& TagDetector::operator=(TagDetector&&) noexcept = default;

int TagDetector::family_size() const { return library_->family.size(); }

Detections TagDetector::detect(const ImageView& image, double decimation) noexcept {
  Detections refused;
  refused.input = check(image);
  if (refused.input != Reason::none) return refused;
  try {
    return detect_checked(image, decimation);
  } catch (...) {  // only memory can run out here
    refused.input = Reason::frame_too_large;
    return refused;
  }
}

Detections TagDetector::detect_checked(const ImageView& image, double decimation) {
  library_->detector->quad_decimate = static_cast<float>(decimation);
  library_->detector->qtp.min_white_black_diff = least_contrast(image, config_.min_decision_margin);
  // libapriltag takes a non-const buffer. It only reads it, with two exceptions: its blur writes into it when
  // there is no decimation, and its `y * stride` is an int, which a very long stride would overflow.
  const bool would_be_written = config_.blur_sigma_px > 0.0 && decimation == 1.0;
  const bool would_overflow = static_cast<std::int64_t>(image.stride_bytes) * image.height > INT_MAX;
  std::uint8_t* pixels = const_cast<std::uint8_t*>(image.data);
  int stride_bytes = image.stride_bytes;
  if (would_be_written || would_overflow) {
    library_->scratch.resize(static_cast<std::size_t>(image.width) * image.height);
    for (int v = 0; v < image.height; ++v)
      std::copy_n(image.data + static_cast<std::size_t>(v) * image.stride_bytes, image.width,
                  library_->scratch.begin() + static_cast<std::ptrdiff_t>(v) * image.width);
    pixels = library_->scratch.data();
    stride_bytes = image.width;
  }
  image_u8_t wrapped = {image.width, image.height, stride_bytes, pixels};
  const std::unique_ptr<zarray_t, void (*)(zarray_t*)> found(
      apriltag_detector_detect(library_->detector.get(), &wrapped), apriltag_detections_destroy);

  Detections result;
  for (int i = 0; i < zarray_size(found.get()); ++i) {
    apriltag_detection_t* detection = nullptr;
    zarray_get(found.get(), i, &detection);
    TagDetection tag = to_tag_detection(*detection);
    if (!is_finite(tag)) continue;  // a degenerate quad
    if (tag.hamming > config_.max_hamming) {
      ++result.refused_hamming;
      result.refused_ids.push_back(tag.id);
      if (tag.decision_margin >= config_.min_decision_margin) result.unsure.push_back(std::move(tag));
    } else if (tag.decision_margin < config_.min_decision_margin) {
      ++result.refused_margin;
      result.refused_ids.push_back(tag.id);
    } else {
      result.tags.push_back(std::move(tag));
    }
  }
  // libapriltag's own order is by id only, with what its sort makes of equal ones.
  const auto key = [](const TagDetection& tag) {
    return std::make_tuple(tag.id, -tag.decision_margin, tag.corners_px[0].x(), tag.corners_px[0].y());
  };
  for (std::vector<TagDetection>* each : {&result.tags, &result.unsure})
    std::sort(each->begin(), each->end(),
              [&key](const TagDetection& a, const TagDetection& b) { return key(a) < key(b); });
  std::sort(result.refused_ids.begin(), result.refused_ids.end());
  return result;
}

double decimation_for(double cell_px) noexcept {
  double largest = kDecimations[0];
  for (double decimation : kDecimations)
    if (cell_px >= kMinCell_px * decimation) largest = decimation;
  return largest;
}

double coarser_decimation(double decimation) noexcept {
  for (double coarser : kDecimations)
    if (coarser >= 2.0 * decimation) return coarser;
  return *std::rbegin(kDecimations);
}

}  // namespace pilotfish::vision
