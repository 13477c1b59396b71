// fuzzylite as an oracle: reads a controller in fuzzylite's own language and either answers each line "e ec" of
// standard input with U, at the resolution of the centroid that is asked for, or writes the controller again.
//
//   fuzzylite_oracle controller.fll 8192 < inputs > outputs
//   fuzzylite_oracle controller.fll export > again.fll

#include <fl/Headers.h>

#include <cstdio>
#include <memory>
#include <string>

int main(int argc, char** argv) {
  if (argc != 3) return 64;
  // fuzzylite takes numbers closer than this for equal, which moves its knees: ask for doubles as they are.
  fl::fuzzylite::setMachEps(1e-15);
  fl::fuzzylite::setDecimals(17);
  const std::unique_ptr<fl::Engine> engine(fl::FllImporter().fromFile(argv[1]));
  if (std::string(argv[2]) == "export") {
    std::printf("%s", fl::FllExporter().toString(engine.get()).c_str());
    return 0;
  }
  fl::OutputVariable* output = engine->getOutputVariable(0);
  dynamic_cast<fl::IntegralDefuzzifier&>(*output->getDefuzzifier()).setResolution(std::stoi(argv[2]));

  double e = 0.0, ec = 0.0;
  while (std::scanf("%lf %lf", &e, &ec) == 2) {
    engine->getInputVariable(0)->setValue(e);
    engine->getInputVariable(1)->setValue(ec);
    engine->process();
    std::printf("%.17g\n", output->getValue());
  }
  return 0;
}
