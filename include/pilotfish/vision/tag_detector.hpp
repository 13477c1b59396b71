#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/frame.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/parameter.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

/// libapriltag's blur writes before the first pixel of a row once half its kernel, int(4 sigma) | 1 wide, exceeds the
/// row. The shortest row is kMinFrameSide / 4 = 4 px, which allows 7 taps: sigma < 2.
inline constexpr double kMaxBlurSigmaPx = 1.9;

/// How tags are found and which are accepted.
struct TagDetectorConfig {
  PILOTFISH_PARAMETERS(TagDetectorConfig);
  /// Edges are measured at full size in any case. 0: chosen by the caller from the tags' size in the picture, see
  /// decimation_for(); a detector by itself takes 1.
  PILOTFISH_PARAMETER(double, decimation, 0.0, 0.0, 4.0,
                      "find quads on an image this much smaller: 1, 1.5, 2, 3 or 4; 0: as acquisition_range_m allows");
  PILOTFISH_PARAMETER(int, max_hamming, 0, 0, 2, "corrected bits that are still accepted");
  PILOTFISH_PARAMETER(double, min_decision_margin, 20.0, 0.0, 255.0,
                      "mean contrast of a tag's bits, in gray levels, below which it is refused");
  PILOTFISH_PARAMETER(
      double, blur_sigma_px, 0.0, 0.0, kMaxBlurSigmaPx,
      "Gaussian blur of the image in which quads are found, for very noisy cameras; below 0.5 it does nothing");
};

/// Tags found and what was refused, by gate.
struct Detections {
  Reason input = Reason::none;       ///< why the picture was not searched
  std::vector<TagDetection> tags;    ///< sorted by id, then by decision margin (best first)
  std::vector<TagDetection> unsure;  ///< refused for wrong bits alone: a closer look may read them, see LeaderObserver
  std::vector<int> refused_ids;      ///< of the tags that a gate refused, sorted
  int refused_hamming = 0;           ///< number of tags with more corrected bits than max_hamming
  int refused_margin = 0;            ///< number of tags with a decision margin below min_decision_margin

  /// Adds those of another search of the same picture, of which `origin_px` was the first pixel. A tag that both found
  /// counts once, with the corners of the finer search, `other`.
  void merge(const Detections& other, const Eigen::Vector2d& origin_px);
  bool is_unique(int id) const;  ///< whether it was found exactly once: two tags of one id are ambiguous
};

/// libapriltag behind a checked interface: sizes are checked before it is called (it asserts or crashes on tiny and
/// on huge images), its corners are converted to Pilotfish's pixel convention HERE and nowhere else, gates
/// are applied and counted. Owns scratch memory, so one detector serves one thread; it starts none of its own.
class TagDetector {
 public:
  /// `family`: one of TagFamily's names. Throws ConfigError on an unknown family or a parameter out of range.
  TagDetector(const std::string& family, const TagDetectorConfig& config);
  ~TagDetector();
  TagDetector(TagDetector&&) noexcept;             ///< moved, with its scratch memory
  TagDetector& operator=(TagDetector&&) noexcept;  ///< moved, with its scratch memory

  int family_size() const;  ///< ids run from 0 to family_size() - 1

  /// Never throws; a picture that cannot be used gives no tags and the reason in `input`. The pixels are only read.
  Detections detect(const ImageView& image) noexcept { return detect(image, config_.decimation); }
  /// The same with another of the decimations.
  Detections detect(const ImageView& image, double decimation) noexcept;

 private:
  struct Library;
  Detections detect_checked(const ImageView& image, double decimation);

  std::unique_ptr<Library> library_;
  TagDetectorConfig config_;
};

/// The largest decimation with which quads are still found whose cells are `cell_px` wide in the picture.
double decimation_for(double cell_px) noexcept;
/// The smallest decimation that is at least twice as large, else the largest there is.
double coarser_decimation(double decimation) noexcept;

}  // namespace pilotfish::vision
PILOTFISH_API_END
