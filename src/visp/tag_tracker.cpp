#include "pilotfish/visp/tag_tracker.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "pilotfish/vision/leader_observer.hpp"
#include "pilotfish/visp/conversions.hpp"

namespace pilotfish::visp {
namespace {

/// Tags are followed as if they had this size, and poses scaled to the requested size: a picture does not determine
/// size, translation is proportional to it, and rotation does not depend on it. So no gate in metres depends on the
/// caller's size. At this size the gates for range, 0.05 to 20 m, are 0.3 to 125 sides of the tag, which is more than
/// can be read.
constexpr double kNominalSize_m = 0.16;
constexpr double kForgetAfter_s = 1.0;  ///< a tag not seen for so long; its observer has dropped it by then

/// A tag as the observer's body. Its base frame o has its z axis up the tag; body_from_tag() leads on to the tag.
BodyTag body_tag(int id) {
  BodyTag tag;
  tag.id = id;
  tag.size_m = kNominalSize_m;
  return tag;
}

LeaderBody body_of(int id, const std::string& family) {
  LeaderBody body;
  body.name = "tag";
  body.family = family;
  body.tags = {body_tag(id)};
  return body;
}

/// The gates that are about how a robot moves are opened as far as they go: what carries a tag here may be anything.
vision::LeaderObserverConfig observer_config() {
  vision::LeaderObserverConfig config;
  config.track.max_relative_speed_mps = 100.0;
  config.track.max_turn_rate_radps = 100.0;
  return config;
}

/// From vpDetectorAprilTag's tag frame (x right, y up, z towards the reader) to Pilotfish's and libapriltag's (x right,
/// y down, z into the paper): x is the same axis, y and z are opposite, which is half a turn about x. It is its own
/// inverse: cMo = cMt diag(1, -1, -1).
const Eigen::Matrix3d& half_turn_about_x() {
  static const Eigen::Matrix3d rotation = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  return rotation;
}

/// vpDetectorAprilTag's name for a family: tag36h11 is "36h11", tagStandard41h12 is "STANDARD41h12".
std::string family_in_messages(const std::string& family) {
  std::string name = family.substr(3);
  for (std::size_t i = 0; i < name.size() && std::isalpha(static_cast<unsigned char>(name[i])) != 0; ++i)
    name[i] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[i])));
  return name;
}

bool is_same(const CameraModel& a, const CameraModel& b) {
  return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy &&
         a.k1 == b.k1;
}

void require_positive(double tag_size_m) {
  if (!(std::isfinite(tag_size_m) && tag_size_m > 0.0)) throw ConfigError("tag_size_m", "must be positive");
}

/// From corners alone, all known equally well; nothing if none fits.
std::optional<Eigen::Isometry3d> pose_from_corners(const CameraModel& camera, const LeaderBody& body,
                                                   const TagDetection& tag) {
  vision::TagMeasurement measurement;
  measurement.tag = tag;
  measurement.covariance_px2.setIdentity();
  vision::TagMeasurements measurements;
  measurements.push_back(measurement);
  const vision::LeaderPoseConfig config;
  const auto pose = estimate_leader_pose(camera, body, measurements, config);
  if (!pose || check_pose(pose->best, body, measurements, config).reason != Reason::none) return std::nullopt;
  return pose->best.cMo * body_from_tag(body.tags.front());
}

std::vector<vpImagePoint> points_of(const TagDetection& tag) {
  std::vector<vpImagePoint> points;
  for (const Eigen::Vector2d& corner : tag.corners_px) points.emplace_back(corner.y(), corner.x());
  return points;
}

}  // namespace

class TagTracker::Impl {
 public:
  explicit Impl(std::string family) : family_(std::move(family)), detector_(family_, {}) {}

  void set_decimation(double decimation) {
    vision::TagDetectorConfig config;
    config.decimation = decimation;
    if (!(decimation >= 1.0)) throw ConfigError("vision.decimation", "must be 1, 1.5, 2, 3 or 4");
    detector_ = vision::TagDetector(family_, config);
  }
  void set_search_period(int pictures) {
    if (pictures < 0) throw ConfigError("search_period", "must not be negative");
    search_period_ = pictures;
  }
  void set_frame_rate(double frame_rate_hz) {
    if (!(frame_rate_hz >= 0.1 && frame_rate_hz <= 1000.0))
      throw ConfigError("frame_rate_hz", "is outside [0.1, 1000]");
    period_us_ = std::llround(1e6 / frame_rate_hz);
  }
  void reset() {
    tracks_.clear();
    seen_.clear();
    camera_.reset();
  }
  /// Observers are made for one camera: another one begins anew.
  void set_camera(const CameraModel& camera) {
    if (camera_ && is_same(*camera_, camera)) return;
    tracks_.clear();
    camera_ = camera;
  }
  /// For a picture that was searched without one.
  void set_first_camera(const CameraModel& camera) {
    if (!camera_) camera_ = camera;
  }

  void detect(const vpImage<unsigned char>& image);
  /// Of the tag's own frame, at that size; nothing if the corners fit no pose.
  std::optional<Eigen::Isometry3d> pose_of(std::size_t i, double tag_size_m, const CameraModel& camera) const;

  const std::string& family() const { return family_; }
  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t count() const { return seen_.size(); }
  const TagDetection& tag(std::size_t i) const { return seen_.at(i).tag; }
  std::int64_t searches() const { return searches_; }

 private:
  struct Track {
    vision::LeaderObserver observer;
    std::int64_t seen_utime = 0;
    std::optional<Observation> now;  ///< in this picture
  };
  struct Seen {
    TagDetection tag;
    std::optional<Eigen::Isometry3d> cMt;  ///< at kNominalSize_m, for camera_; nothing: from the corners
  };

  bool follow(const Frame& frame);
  void search(const Frame& frame);
  Track& track_of(int id);

  std::string family_;
  vision::TagDetector detector_;
  std::optional<CameraModel> camera_;
  int width_ = 0, height_ = 0;  ///< [px] of the last picture
  int search_period_ = 10;
  std::int64_t period_us_ = 33'333;
  std::int64_t utime_ = 0;  ///< assumed
  std::int64_t searches_ = 0;
  int since_search_ = 0;  ///< pictures
  std::map<int, Track> tracks_;
  std::vector<Seen> seen_;
};

void TagTracker::Impl::detect(const vpImage<unsigned char>& image) {
  utime_ += period_us_;
  const Frame frame = frame_of(image, utime_);
  width_ = frame.image.width;
  height_ = frame.image.height;
  seen_.clear();
  if (check(frame.image) != Reason::none) return;
  // The camera of detect(I) is that of the pictures before: it does not fit pictures of another size.
  if (camera_ && (camera_->width != width_ || camera_->height != height_)) {
    tracks_.clear();
    camera_.reset();
  }
  ++since_search_;
  const bool all_followed = follow(frame);
  if (!all_followed || (search_period_ > 0 && since_search_ >= search_period_)) search(frame);
  for (auto each = tracks_.begin(); each != tracks_.end();) {
    const Track& track = each->second;
    if (track.now) seen_.push_back({track.now->tags.front(), track.now->cMo * body_from_tag(body_tag(each->first))});
    const bool forgotten = static_cast<double>(utime_ - track.seen_utime) > 1e6 * kForgetAfter_s;
    each = forgotten ? tracks_.erase(each) : std::next(each);
  }
}

/// Whether a search can add nothing but tags that are new: some tag is seen, and none that was seen in the last picture
/// is missing.
bool TagTracker::Impl::follow(const Frame& frame) {
  bool any = false, lost = false;
  for (auto& [id, track] : tracks_) {
    const bool was_seen = track.now.has_value();
    track.now = track.observer.observe_detected(frame, {}).observation;
    any = any || track.now;
    lost = lost || (was_seen && !track.now);
    if (track.now) track.seen_utime = frame.utime;
  }
  return any && !lost;
}

void TagTracker::Impl::search(const Frame& frame) {
  ++searches_;
  since_search_ = 0;
  const vision::Detections found = detector_.detect(frame.image);
  for (const TagDetection& tag : found.tags) {
    if (!found.is_unique(tag.id)) continue;
    if (!camera_) {
      seen_.push_back({tag, std::nullopt});
      continue;
    }
    Track& track = track_of(tag.id);
    if (track.now) continue;
    // It is not where its motion led, so that motion, and a new one between there and here, would lead astray.
    track.observer.forget();
    track.now = track.observer.observe_detected(frame, found).observation;
    if (track.now) track.seen_utime = frame.utime;
  }
}

TagTracker::Impl::Track& TagTracker::Impl::track_of(int id) {
  const auto known = tracks_.find(id);
  if (known != tracks_.end()) return known->second;
  Track track{vision::LeaderObserver(*camera_, {}, body_of(id, family_), observer_config()), utime_, std::nullopt};
  return tracks_.emplace(id, std::move(track)).first->second;
}

std::optional<Eigen::Isometry3d> TagTracker::Impl::pose_of(std::size_t i, double tag_size_m,
                                                           const CameraModel& camera) const {
  const Seen& seen = seen_.at(i);
  const bool followed = seen.cMt && camera_ && is_same(*camera_, camera);
  std::optional<Eigen::Isometry3d> cMt =
      followed ? seen.cMt : pose_from_corners(camera, body_of(seen.tag.id, family_), seen.tag);
  if (cMt) cMt->translation() *= tag_size_m / kNominalSize_m;
  return cMt;
}

TagTracker::TagTracker(const std::string& family) : impl_(std::make_unique<Impl>(family)) {}
TagTracker::~TagTracker() = default;
TagTracker::TagTracker(TagTracker&&) noexcept = default;
TagTracker& TagTracker::operator=(TagTracker&&) noexcept = default;

void TagTracker::setAprilTagQuadDecimate(float decimation) { impl_->set_decimation(decimation); }
void TagTracker::setSearchPeriod(int pictures) { impl_->set_search_period(pictures); }
void TagTracker::setFrameRate(double frame_rate_hz) { impl_->set_frame_rate(frame_rate_hz); }

bool TagTracker::detect(const vpImage<unsigned char>& I, double tag_size, const vpCameraParameters& cam,
                        std::vector<vpHomogeneousMatrix>& cMo_vec) {
  require_positive(tag_size);
  cMo_vec.clear();
  if (check(frame_of(I, 0).image) == Reason::none)  // of others camera_model_of() would make no camera
    impl_->set_camera(camera_model_of(cam, static_cast<int>(I.getWidth()), static_cast<int>(I.getHeight())));
  impl_->detect(I);
  cMo_vec.resize(getNbObjects());
  for (std::size_t i = 0; i < cMo_vec.size(); ++i) getPose(i, tag_size, cam, cMo_vec[i]);
  return !cMo_vec.empty();
}

bool TagTracker::detect(const vpImage<unsigned char>& I) {
  impl_->detect(I);
  return getNbObjects() > 0;
}

bool TagTracker::getPose(std::size_t i, double tag_size, const vpCameraParameters& cam, vpHomogeneousMatrix& cMo) {
  require_positive(tag_size);
  if (i >= getNbObjects()) return false;
  const CameraModel camera = camera_model_of(cam, impl_->width(), impl_->height());
  std::optional<Eigen::Isometry3d> cMt = impl_->pose_of(i, tag_size, camera);
  impl_->set_first_camera(camera);
  if (!cMt) return false;
  if (!z_aligned_) cMt->linear() = (cMt->linear() * half_turn_about_x()).eval();
  cMo = homogeneous_of(*cMt);
  return true;
}

std::size_t TagTracker::getNbObjects() const { return impl_->count(); }

std::vector<int> TagTracker::getTagsId() const {
  std::vector<int> ids;
  for (std::size_t i = 0; i < getNbObjects(); ++i) ids.push_back(impl_->tag(i).id);
  return ids;
}

std::vector<std::vector<vpImagePoint>> TagTracker::getTagsCorners() const {
  std::vector<std::vector<vpImagePoint>> corners;
  for (std::size_t i = 0; i < getNbObjects(); ++i) corners.push_back(getPolygon(i));
  return corners;
}

std::vector<vpImagePoint> TagTracker::getPolygon(std::size_t i) const { return points_of(impl_->tag(i)); }

std::string TagTracker::getMessage(std::size_t i) const {
  return family_in_messages(impl_->family()) + " id: " + std::to_string(impl_->tag(i).id);
}

vpRect TagTracker::getBBox(std::size_t i) const { return vpRect(getPolygon(i)); }

vpImagePoint TagTracker::getCog(std::size_t i) const {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& corner : impl_->tag(i).corners_px) sum += corner;
  return {sum.y() / 4.0, sum.x() / 4.0};
}

void TagTracker::reset() { impl_->reset(); }
std::int64_t TagTracker::wholePictureSearches() const { return impl_->searches(); }

}  // namespace pilotfish::visp
