// ViSP's position-based servo on a tag, picture by picture: visp_servo FOLDER PX TAG_SIZE_M

#include <visp3/core/vpIoTools.h>
#include <visp3/io/vpImageIo.h>
#include <visp3/visual_features/vpFeatureThetaU.h>
#include <visp3/visual_features/vpFeatureTranslation.h>
#include <visp3/vs/vpServo.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <pilotfish/visp/tag_tracker.hpp>

int main(int argc, char** argv) try {
  if (argc != 4) {
    std::fprintf(stderr, "visp_servo FOLDER PX TAG_SIZE_M\n");
    return 64;
  }
  const std::string folder = argv[1];
  const double px = std::atof(argv[2]), tag_size = std::atof(argv[3]);

  pilotfish::visp::TagTracker detector;  // the changed line; it was: vpDetectorAprilTag detector;

  // Stand ten tag sides in front of the tag, squarely: z of the tag's frame looks at the camera.
  const vpHomogeneousMatrix cdMo(vpTranslationVector(0, 0, 10 * tag_size),
                                 vpRotationMatrix({1, 0, 0, 0, -1, 0, 0, 0, -1}));
  vpFeatureTranslation t(vpFeatureTranslation::cdMc), td(vpFeatureTranslation::cdMc);
  vpFeatureThetaU tu(vpFeatureThetaU::cdRc), tud(vpFeatureThetaU::cdRc);
  vpServo task;
  task.addFeature(t, td);
  task.addFeature(tu, tud);
  task.setServo(vpServo::EYEINHAND_CAMERA);
  task.setInteractionMatrixType(vpServo::CURRENT);
  task.setLambda(0.5);

  for (const std::string& name : vpIoTools::getDirFiles(folder)) {
    if (vpIoTools::getFileExtension(name) == ".csv") continue;  // `pilotfish render` writes the poses, too
    vpImage<unsigned char> I;
    vpImageIo::read(I, vpIoTools::createFilePath(folder, name));
    const vpCameraParameters cam(px, px, (I.getWidth() - 1) / 2.0, (I.getHeight() - 1) / 2.0);
    std::vector<vpHomogeneousMatrix> cMo_vec;
    if (!detector.detect(I, tag_size, cam, cMo_vec)) {
      std::printf("%s: no tag\n", name.c_str());
      continue;
    }
    const vpHomogeneousMatrix& cMo = cMo_vec[0];
    const vpHomogeneousMatrix cdMc = cdMo * cMo.inverse();
    t.buildFrom(cdMc);
    tu.buildFrom(cdMc);
    const vpColVector v = task.computeControlLaw();
    std::printf("%s: %s at (%.4f, %.4f, %.4f) m, v = (%.3f, %.3f, %.3f) m/s, w = (%.3f, %.3f, %.3f) rad/s\n",
                name.c_str(), detector.getMessage(0).c_str(), cMo[0][3], cMo[1][3], cMo[2][3], v[0], v[1], v[2], v[3],
                v[4], v[5]);
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "visp_servo: %s\n", error.what());
  return 1;
}
