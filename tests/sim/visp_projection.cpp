// ViSP's opinion on where a point is in the picture. One line in, "px py u0 v0 kud  X Y Z" with the point in
// the camera's frame; one line out, "u v".

#include <visp3/core/vpCameraParameters.h>
#include <visp3/core/vpHomogeneousMatrix.h>
#include <visp3/core/vpMeterPixelConversion.h>
#include <visp3/core/vpPoint.h>

#include <cstdio>
#include <iostream>

int main() {
  double px, py, u0, v0, kud, X, Y, Z;
  while (std::cin >> px >> py >> u0 >> v0 >> kud >> X >> Y >> Z) {
    vpCameraParameters camera;
    if (kud == 0.0) {
      camera.initPersProjWithoutDistortion(px, py, u0, v0);
    } else {
      camera.initPersProjWithDistortion(px, py, u0, v0, kud, -kud);
    }
    vpPoint point(X, Y, Z);
    point.track(vpHomogeneousMatrix());
    double u, v;
    vpMeterPixelConversion::convertPoint(camera, point.get_x(), point.get_y(), u, v);
    std::printf("%.12f %.12f\n", u, v);
  }
}
