#pragma once

#include <visp3/core/vpCameraParameters.h>
#include <visp3/core/vpHomogeneousMatrix.h>
#include <visp3/core/vpImage.h>
#include <visp3/core/vpImagePoint.h>
#include <visp3/core/vpRect.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::visp {

/// Takes the place of ViSP's vpDetectorAprilTag: the same calls, the same tag frame, without visp_detection.
///
///     pilotfish::visp::TagTracker detector;  // vpDetectorAprilTag detector(vpDetectorAprilTag::TAG_36h11);
///     detector.detect(I, tag_size, cam, cMo_vec);
///
/// vpDetectorAprilTag looks for tags in every picture anew. This looks for them in the whole picture while there are
/// none, when one is lost and every setSearchPeriod() pictures; in between, each tag is tracked from where it was by
/// fitting its template. What differs for the caller:
///
/// - A tag that appears beside one that is being followed is found up to setSearchPeriod() pictures later.
/// - Pictures must come in order, about setFrameRate() of them a second, from one camera; after a gap, or for
///   unrelated pictures, call reset() before each.
/// - An id that occurs twice in one picture is not accepted, and neither is a tag with a wrong bit, partly outside the
///   picture, or without contrast (docs/vision.md). What is tracked already stays tracked.
/// - Tags come sorted by id.
/// - Of a camera with distortion k_ud is used, and k_du is not: the pose fits the distorted picture.
///
/// Pixel centres are at whole numbers, as everywhere in ViSP. vpDetectorAprilTag's corners have them at +0.5, so its
/// corners lie half a pixel farther right and down, and its poses accordingly.
///
/// ViSP gives no time with a picture: the motion between pictures is taken for that of 1 / setFrameRate() seconds.
/// One tracker serves one thread and starts none.
class TagTracker {
 public:
  /// `family`: one of vision::TagFamily's names. Throws ConfigError ("leader.family") if it is none.
  explicit TagTracker(const std::string& family = "tag36h11");
  ~TagTracker();
  TagTracker(TagTracker&&) noexcept;             ///< the tags that are followed move along
  TagTracker& operator=(TagTracker&&) noexcept;  ///< the tags that are followed move along

  /// The whole picture is searched on one that is this much smaller: 1 (default), 1.5, 2, 3 or 4. Throws ConfigError on
  /// others. Tags that are followed are always measured at full size.
  void setAprilTagQuadDecimate(float decimation);
  /// Every how many pictures the whole picture is searched although all tags are being followed; 1: every picture,
  /// 0: never. Default 10. Throws ConfigError if negative.
  void setSearchPeriod(int pictures);
  /// Pictures per second that are assumed, default 30 Hz. Throws ConfigError outside [0.1, 1000].
  void setFrameRate(double frame_rate_hz);
  /// false (default): the tag's frame is vpDetectorAprilTag's own, x right and y up as one reads the tag, z out of the
  /// paper towards the reader. true: x right, y down, z into the paper.
  void setZAlignedWithCameraAxis(bool aligned) { z_aligned_ = aligned; }

  /// tag_size [m]: side of the black square, the same for all tags. cMo_vec: per tag the pose of its frame in the
  /// camera's (x right, y down, z ahead) [m], in the order of getTagsId(). Whether a tag was seen. Throws ConfigError
  /// for a size that is not positive or an invalid camera (ViSP's Kannala-Brandt model, too). A picture of less
  /// than 16 or more than 16384 pixels a side has no tags.
  bool detect(const vpImage<unsigned char>& I, double tag_size, const vpCameraParameters& cam,
              std::vector<vpHomogeneousMatrix>& cMo_vec);
  /// Without poses; call getPose(), with the size of each tag. Tracks with the camera that detect() was last given,
  /// or else getPose() first. Until then every picture is searched as a whole, and the corners are libapriltag's.
  bool detect(const vpImage<unsigned char>& I);
  /// Of tag `i` in the last picture, for that size [m] and camera. false if there is no such tag or no pose explains
  /// its corners. Throws as detect() does.
  bool getPose(std::size_t i, double tag_size, const vpCameraParameters& cam, vpHomogeneousMatrix& cMo);

  /// Number of tags in the last picture.
  std::size_t getNbObjects() const;
  /// Their ids.
  std::vector<int> getTagsId() const;
  /// Per tag its corners [px]: bottom left, bottom right, top right, top left, as one reads it.
  std::vector<std::vector<vpImagePoint>> getTagsCorners() const;
  /// The corners of tag `i` [px], as in getTagsCorners(); std::out_of_range if there is no such tag.
  std::vector<vpImagePoint> getPolygon(std::size_t i) const;
  /// Its family and id, "36h11 id: 3"; std::out_of_range if there is no such tag.
  std::string getMessage(std::size_t i) const;
  /// The upright rectangle around its corners [px]; std::out_of_range if there is no such tag.
  vpRect getBBox(std::size_t i) const;
  /// The mean of its corners [px]; std::out_of_range if there is no such tag.
  vpImagePoint getCog(std::size_t i) const;

  /// Drops all tags and the camera: the next picture is searched as the first one.
  void reset();
  /// How often the whole picture was searched so far.
  std::int64_t wholePictureSearches() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
  bool z_aligned_ = false;
};

}  // namespace pilotfish::visp
PILOTFISH_API_END
