#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/frame.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/refused_value.hpp"
#include "pilotfish/vision/heading_filter.hpp"
#include "pilotfish/vision/leader_pose.hpp"
#include "pilotfish/vision/leader_track.hpp"
#include "pilotfish/vision/rejection_counters.hpp"
#include "pilotfish/vision/stage_stopwatch.hpp"
#include "pilotfish/vision/tag_detector.hpp"
#include "pilotfish/vision/tag_tracker.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

struct SearchRegion;

/// How a leader is searched for and tracked.
struct LeaderObserverConfig {
  PILOTFISH_PARAMETERS(LeaderObserverConfig);
  PILOTFISH_PARAMETER(
      double, acquisition_range_m, 5.0, 0.1, 100.0,
      "a leader that is not tracked yet is searched for up to this distance; farther needs a finer, slower search");
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

/// What one picture says about the leader: an observation, or the reason why there is none.
struct ObservationResult {
  std::optional<Observation> observation;  ///< Observation of this frame, or nothing
  Reason reason = Reason::none;            ///< Reason.none with an observation, else why there is none
  RefusedValue refused;                    ///< what the gate compared that refused it, if it compared numbers
};

/// The entry point of this module: Frame in, Observation out.
///
///     predict --> track each tag at its prediction -----------------------+
///        | nothing                                                       |
///        v                                                               +--> one pose --> plausible? --> heading
///        filter
///     detect in the region, then in the frame --> track each tag there --+
///
/// However a tag was found, it is used only after its template was fitted to this very frame and every bit of
/// it read. Keeps the leader's last motion (for 0.5 s) and its headings; time comes from the frames. One observer
/// serves one thread. It does not allocate while it tracks. The stages can be used alone: TagTracker,
/// TagDetector, estimate_leader_pose() and HeadingFilter.
class LeaderObserver {
 public:
  /// Throws ConfigError if any part is invalid.
  LeaderObserver(const CameraModel& camera, const CameraMounting& mounting, const LeaderBody& body,
                 const LeaderObserverConfig& config);

  /// Never throws. A frame whose size differs from the calibration's is refused, not scaled.
  ObservationResult observe(const Frame& frame) noexcept;
  /// The same for one search that serves several observers: `found`, the detections of a detector of the same family
  /// in this very frame [px of it], replaces the search of the whole picture; empty if there was no search.
  ObservationResult observe_detected(const Frame& frame, const Detections& found) noexcept;

  /// What the search of the whole picture found in the last frame, tags of other bodies as well; nullptr if it was not
  /// searched. For observe_detected() of others.
  const Detections* searched() const { return searched_ ? &*searched_ : nullptr; }
  /// Whether a leader at `utime` would be looked for at its prediction, without a search.
  bool tracks_at(std::int64_t utime) const noexcept { return track_.predict(utime).has_value(); }

  /// The next frame is treated as the first. The counters stay.
  void forget() noexcept;

  const TagTracker& tracker() const { return tracker_; }           ///< of this camera and this leader
  const RejectionCounters& rejected() const { return rejected_; }  ///< since the start
  /// How often a whole picture had to be searched, which takes a hundred times longer than to follow.
  std::int64_t whole_picture_searches() const { return whole_picture_searches_; }
  /// Tags of the family that the leader does not wear, as of the last whole picture that was searched; each id once, 8
  /// at most.
  const std::vector<int>& foreign_ids() const { return foreign_ids_; }

  /// From the next frame on each stage is timed with that clock; nullptr, the default: not timed.
  void time_stages(StageStopwatch::Clock clock) noexcept { stopwatch_ = StageStopwatch(clock); }
  const StageStopwatch& stages() const { return stopwatch_; }  ///< of the last frame that could be used

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp; without counters and times
    archive(self.track_, self.heading_, self.fruitless_searches_);
  }

 private:
  /// What became of the tags in one attempt at one frame.
  struct Attempt {
    FoundBy found_by = FoundBy::frame;
    TagMeasurements tags;
    Reason reason = Reason::no_tag_found;  ///< why there is no more
    RefusedValue refused;                  ///< what goes with the reason
    RejectionCounters rejected;
    void add(const TagOutcome<TagMeasurement>& outcome);
  };
  ObservationResult observe_or_refuse(const Frame& frame, const Detections* found) noexcept;
  ObservationResult observe_frame(const Frame& frame, const Detections* found);
  Reason why_unusable(const ImageView& image) const;
  Attempt track_tags(const ImageView& image, const Eigen::Isometry3d& predicted_cMo);
  Attempt detect_tags(const ImageView& image, const SearchRegion& region, double decimation, FoundBy found_by);
  Detections search_whole(const ImageView& image, bool coarse);
  /// `origin_px`: the origin, in the picture, of the part that the detections refer to.
  Attempt track_detections(const ImageView& image, const Detections& detections, const Eigen::Vector2d& origin_px,
                           FoundBy found_by);
  void track_unsure(const ImageView& image, const Detections& detections, const Eigen::Vector2d& origin_px,
                    Attempt& attempt);
  bool search_finely(const ImageView& image, bool coarse);
  void note_foreign(int id);
  ObservationResult conclude(const Frame& frame, Attempt& attempt,
                             const std::optional<Eigen::Isometry3d>& predicted_cMo);
  ObservationResult measure(const Frame& frame, const Attempt& attempt,
                            const std::optional<Eigen::Isometry3d>& predicted_cMo);

  TagTracker tracker_;
  Eigen::Isometry3d bMc_;
  LeaderObserverConfig config_;
  TagDetector detector_;
  double decimation_ = 1.0;  ///< for the whole frame
  LeaderTrack track_;
  HeadingFilter heading_;
  RejectionCounters rejected_;
  std::int64_t whole_picture_searches_ = 0;
  std::int64_t fruitless_searches_ = 0;  ///< since the leader was last seen
  std::vector<int> foreign_ids_;
  std::optional<Detections> searched_;  ///< of the last frame
  StageStopwatch stopwatch_;
};

}  // namespace pilotfish::vision
PILOTFISH_API_END
