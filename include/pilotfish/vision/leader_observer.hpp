#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/frame.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/vision/heading_filter.hpp"
#include "pilotfish/vision/leader_pose.hpp"
#include "pilotfish/vision/leader_track.hpp"
#include "pilotfish/vision/tag_detector.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

struct SearchRegion;

/// How a leader is looked for and followed.
struct LeaderObserverConfig {
  PILOTFISH_PARAMETERS(LeaderObserverConfig);
  PILOTFISH_PARAMETER(
      double, acquisition_range_m, 5.0, 0.1, 100.0,
      "a leader that nobody follows yet is looked for up to this distance; farther needs a finer, slower search");
  TagDetectorConfig detector;   ///< how tags are found
  TagGates gates;               ///< which of them are accepted
  LeaderPoseConfig pose;        ///< which poses are accepted
  HeadingFilterConfig heading;  ///< which of two solutions
  LeaderTrackConfig track;      ///< how a leader can move

  template <class Visit>
  static void sections(Visit&& visit) {  ///< see core/sections.hpp
    using C = LeaderObserverConfig;
    visit("", &C::detector);
    visit("", &C::gates);
    visit("", &C::pose);
    visit("heading", &C::heading);
    visit("track", &C::track);
  }
};

/// Everything that was turned away since the start, by reason.
struct RejectionCounters {
  std::int64_t frames_invalid = 0;  ///< frames that cannot be read or are not of the calibration's size
  std::int64_t hamming = 0;         ///< tags that read as something else
  std::int64_t margin = 0;          ///< tags with too little contrast
  std::int64_t residual = 0;        ///< tags of which something else explains too much
  std::int64_t foreign_id = 0;      ///< tags of the family that the leader does not wear
  std::int64_t duplicate_id = 0;    ///< an id seen twice in one picture: none of the two is accepted
  std::int64_t outside_frame = 0;   ///< tags partly outside the picture
  std::int64_t too_small = 0;       ///< tags too small to be read
  std::int64_t too_blurred = 0;     ///< tags too blurred to be accepted
  std::int64_t size = 0;            ///< tags with a size that they cannot have at any range
  std::int64_t behind = 0;          ///< poses behind the camera, or that show a tag's back
  std::int64_t jump = 0;            ///< leaders farther from where they were than anything can have moved
  std::int64_t pose = 0;            ///< corners that no credible pose explains

  /// A counter and its name.
  struct Named {
    const char* name;                        ///< on the wire
    std::int64_t RejectionCounters::*count;  ///< which one
  };
  /// All of them, by name.
  static const std::array<Named, 13>& all() noexcept;
};

/// What one picture says about the leader: an observation, or the reason why there is none.
struct ObservationResult {
  std::optional<Observation> observation;  ///< Observation of this frame, or nothing
  Reason reason = Reason::none;            ///< Reason.none with an observation, else why there is none
};

/// The way into this module: Frame in, Observation out.
///
///     the motion so far --> look at each tag where it must be -----+
///          | nothing                                               |
///          v                                                       +--> one pose --> plausible? --> heading filter
///     detect in the region, then in the frame --> look there ------+
///
/// However a tag was found, it is an observation only after its template was fitted to this very frame and every bit of
/// it read. Remembers where the leader was (for 0.5 s) and how it was heading; time comes from the frames. One observer
/// serves one thread. While it tracks it asks for no memory.
class LeaderObserver {
 public:
  /// Throws ConfigError if any part is not usable.
  LeaderObserver(const CameraModel& camera, const CameraMounting& mounting, const LeaderBody& body,
                 const LeaderObserverConfig& config);

  /// Never throws. A frame whose size differs from the calibration's is refused, not scaled.
  ObservationResult observe(const Frame& frame) noexcept;
  /// The same for whoever searches pictures for several observers at once: `found`, what a detector of the same family
  /// found in this very frame [px of it], takes the place of the search of the whole picture; empty if nobody searched.
  ObservationResult observe_detected(const Frame& frame, const Detections& found) noexcept;

  /// The next frame is looked at as if nothing had been seen before. The counters stay.
  void forget() noexcept;

  const RejectionCounters& rejected() const { return rejected_; }  ///< since the start
  /// How often a whole picture had to be searched, which takes a hundred times longer than to follow.
  std::int64_t whole_picture_searches() const { return whole_picture_searches_; }

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp; counters decide nothing
    archive(self.track_, self.heading_);
  }

 private:
  /// What became of the tags in one attempt at one frame.
  struct Attempt {
    TagMeasurements tags;
    Reason reason = Reason::no_tag_found;  ///< why there is nothing more
    RejectionCounters rejected;
    void add(const TagResult& look);
  };
  ObservationResult try_to_look(const Frame& frame, const Detections* found) noexcept;
  ObservationResult look(const Frame& frame, const Detections* found);
  Attempt follow_tags(const ImageView& image, const Eigen::Isometry3d& predicted_cMo) const;
  Attempt detect_tags(const ImageView& image, const SearchRegion& region, double decimation);
  /// `origin_px`: where the part of the picture begins that the detections count from.
  Attempt verify_tags(const ImageView& image, const Detections& detections, const Eigen::Vector2d& origin_px) const;
  /// Counts what the attempt refused, if it is the frame's last word.
  ObservationResult conclude(const Frame& frame, Attempt& attempt, FoundBy found_by,
                             const std::optional<Eigen::Isometry3d>& predicted_cMo);
  ObservationResult measure(const Frame& frame, const TagMeasurements& tags, FoundBy found_by,
                            const std::optional<Eigen::Isometry3d>& predicted_cMo);
  BitGates bit_gates() const;

  CameraModel camera_;
  Eigen::Isometry3d bMc_;
  LeaderBody body_;
  std::vector<TagPattern> patterns_;  ///< of body_.tags, in their order
  LeaderObserverConfig config_;
  double decimation_ = 1.0;  ///< for the whole frame
  TagDetector detector_;
  LeaderTrack track_;
  HeadingFilter heading_;
  RejectionCounters rejected_;
  std::int64_t whole_picture_searches_ = 0;
};

}  // namespace pilotfish::vision
PILOTFISH_API_END
