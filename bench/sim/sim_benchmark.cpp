// A simulated robot that follows another, closed loop: render, see, decide, move.
//
//   sim_benchmark follow SCENARIO FRAMES    Pilotfish beside vpImageSimulator with vpDetectorAprilTag
//   sim_benchmark crowd SCENARIO FRAMES THREADS    all robots of a scenario
//
// follow: a line of JSON a loop and frame: {"loop", "row", "frame", "move_ns", "render_ns", "see_decide_ns", "seen",
// "distance_error_m", "bearing_error_rad", "measured_..."}; times are processor time of the one thread. The loops play
// in turns of 15 frames, in a random order, so that each finds the caches full of another's data now and then, as a
// program does beside which others run, and a disturbance of the computer affects all. crowd: see crowd.hpp.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <opencv2/core.hpp>
#include <random>
#include <string>

#include "crowd.hpp"
#include "our_loop.hpp"
#include "pilotfish/config/scenario_file.hpp"
#include "visp_loop.hpp"

namespace {

using namespace pilotfish::bench;

constexpr int kTurn = 15;

void follow(const pilotfish::sim::Scenario& scenario, int frames) {
  std::vector<std::unique_ptr<Loop>> loops;
  loops.push_back(std::make_unique<OurLoop>(scenario));
  for (const bool bilinear : {false, true})
    for (const int decimation : {1, 2}) {
      const std::string name = "ViSP, 1:" + std::to_string(decimation) + (bilinear ? ", bilinear" : "");
      loops.push_back(std::make_unique<VispLoop>(name, scenario, decimation, bilinear));
    }
  std::vector<std::size_t> order(loops.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::mt19937 random(1);
  for (int first = 0; first < frames; first += kTurn) {
    std::shuffle(order.begin(), order.end(), random);
    for (const std::size_t row : order)
      for (int frame = first; frame < std::min(first + kTurn, frames); ++frame) {
        const FrameFigures figures = loops[row]->play(frame);
        const nlohmann::json line = {{"loop", loops[row]->name()},
                                     {"row", row},
                                     {"frame", frame},
                                     {"move_ns", figures.move_ns},
                                     {"render_ns", figures.render_ns},
                                     {"see_decide_ns", figures.see_decide_ns},
                                     {"seen", figures.seen},
                                     {"distance_error_m", figures.distance_error_m},
                                     {"bearing_error_rad", figures.bearing_error_rad},
                                     {"measured_error_m", figures.measured_error_m},
                                     {"measured_bearing_rad", figures.measured_bearing_rad},
                                     {"measured_heading_rad", figures.measured_heading_rad}};
        std::puts(line.dump().c_str());
      }
  }
}

int usage() {
  std::fputs("sim_benchmark follow SCENARIO FRAMES\nsim_benchmark crowd SCENARIO FRAMES THREADS\n", stderr);
  return 64;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return usage();
  const std::string what = argv[1];
  const int frames = std::atoi(argv[3]);
  cv::setNumThreads(1);  // threads are given to robots, not to parts of one picture
  try {
    const pilotfish::sim::Scenario scenario = pilotfish::config::load_scenario(argv[2]);
    if (what == "follow" && argc == 4 && frames > 0) {
      follow(scenario, frames);
    } else if (what == "crowd" && argc == 5 && frames > 0 && std::atoi(argv[4]) > 0) {
      std::puts(play_crowd(scenario, frames, std::atoi(argv[4])).dump().c_str());
    } else {
      return usage();
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
