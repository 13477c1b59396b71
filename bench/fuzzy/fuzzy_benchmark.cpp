// One evaluation of a controller, ours and fuzzylite's, timed in turns so that both see the same machine.
//
//   fuzzy_benchmark controller.fll ROUNDS
//
// Prints a line of JSON for each round: nanoseconds per evaluation of infer_output (u alone), infer (u and the 56
// strengths), and fuzzylite at its default resolution 100 and at 1000; and how far fuzzylite was from ours.

#include <fl/Headers.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <vector>

#include "pilotfish/config/files.hpp"
#include "pilotfish/fuzzy/mamdani.hpp"

namespace {

using pilotfish::fuzzy::Controller;

struct Input {
  double error, error_change;
};

// Fixed, so that every run asks the same: uniform over both universes.
std::vector<Input> make_inputs(std::size_t count) {
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Input> inputs(count);
  for (Input& input : inputs) input = {uniform(generator), uniform(generator)};
  return inputs;
}

class Fuzzylite {
 public:
  Fuzzylite(const std::string& file, int resolution) : engine_(fl::FllImporter().fromFile(file)) {
    dynamic_cast<fl::IntegralDefuzzifier&>(*output().getDefuzzifier()).setResolution(resolution);
  }
  double operator()(const Input& input) {
    engine_->getInputVariable(0)->setValue(input.error);
    engine_->getInputVariable(1)->setValue(input.error_change);
    engine_->process();
    return output().getValue();
  }

 private:
  fl::OutputVariable& output() { return *engine_->getOutputVariable(0); }
  std::unique_ptr<fl::Engine> engine_;
};

// Nanoseconds per call over all inputs. The sum is used, so that no call can be left out.
template <class Law>
double time_ns(Law& law, const std::vector<Input>& inputs, double& sum) {
  const auto begin = std::chrono::steady_clock::now();
  for (const Input& input : inputs) sum += law(input);
  const std::chrono::duration<double, std::nano> elapsed = std::chrono::steady_clock::now() - begin;
  return elapsed.count() / static_cast<double>(inputs.size());
}

template <class Law>
double greatest_difference(Law& law, const Controller& controller, const std::vector<Input>& inputs) {
  double greatest = 0.0;
  for (const Input& input : inputs)
    greatest = std::max(greatest, std::abs(law(input) - infer_output(controller, input.error, input.error_change)));
  return greatest;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 64;
  const Controller controller = pilotfish::config::load_fuzzy_controller(argv[1]);
  Fuzzylite coarse(argv[1], 100), fine(argv[1], 1000);
  auto output = [&](const Input& x) { return infer_output(controller, x.error, x.error_change); };
  auto explained = [&](const Input& x) {
    const auto inference = infer(controller, x.error, x.error_change);
    return inference.output + inference.strengths[28];
  };
  // Slices of well under a millisecond: short enough that what else runs on the machine slows all four of a round
  // alike.
  const std::vector<Input> many = make_inputs(4000), some = make_inputs(30), few = make_inputs(6);

  double sum = 0.0;
  for (int round = 0; round < std::stoi(argv[2]); ++round) {
    const double output_ns = time_ns(output, many, sum);
    const double coarse_ns = time_ns(coarse, some, sum);
    const double infer_ns = time_ns(explained, many, sum);
    const double fine_ns = time_ns(fine, few, sum);
    std::printf(
        "{\"infer_output_ns\": %.3f, \"infer_ns\": %.3f, \"fuzzylite_100_ns\": %.1f, \"fuzzylite_1000_ns\": %.1f}\n",
        output_ns, infer_ns, coarse_ns, fine_ns);
  }
  std::printf("{\"difference_100\": %.3e, \"difference_1000\": %.3e, \"sum\": %.17g}\n",
              greatest_difference(coarse, controller, make_inputs(500)),
              greatest_difference(fine, controller, make_inputs(500)), sum);
  return 0;
}
