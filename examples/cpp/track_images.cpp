// Where is the tag, picture by picture? track_images FOLDER FOCAL_LENGTH_PX TAG_SIZE_M [ID]

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <pilotfish/capture/frame_source.hpp>
#include <pilotfish/core/angles.hpp>
#include <pilotfish/vision/leader_observer.hpp>

int main(int argc, char** argv) try {
  if (argc < 4) {
    std::fprintf(stderr, "track_images FOLDER FOCAL_LENGTH_PX TAG_SIZE_M [ID]\n");
    return 64;
  }
  const auto source = pilotfish::capture::open_images(argv[1], 30.0);
  auto frame = source->next();
  if (!frame) return 66;

  // Without a calibration: square pixels, the optical axis through the middle of the picture, no distortion.
  pilotfish::CameraModel camera;
  camera.width = frame->image.width;
  camera.height = frame->image.height;
  camera.fx = camera.fy = std::atof(argv[2]);
  camera.cx = (camera.width - 1) / 2.0;
  camera.cy = (camera.height - 1) / 2.0;
  // A body of one tag, whose origin is the tag.
  pilotfish::BodyTag tag;
  tag.size_m = std::atof(argv[3]);
  tag.id = argc > 4 ? std::atoi(argv[4]) : 0;
  pilotfish::LeaderBody body;
  body.tags = {tag};
  pilotfish::vision::LeaderObserver observer(camera, pilotfish::CameraMounting{}, body, {});

  for (int index = 0; frame; ++index, frame = source->next()) {
    const auto seen = observer.observe(*frame);
    if (const auto& o = seen.observation)
      std::printf("%4d: %.4f m, bearing %+.2f deg, heading %+.2f deg, %.3f px, by %s\n", index, o->distance_m,
                  pilotfish::degrees(o->bearing_rad), pilotfish::degrees(o->heading_rad), o->reprojection_error_px,
                  std::string(pilotfish::to_string(o->found_by)).c_str());
    else
      std::printf("%4d: %s\n", index, std::string(pilotfish::to_string(seen.reason)).c_str());
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "track_images: %s\n", error.what());
  return 1;
}
