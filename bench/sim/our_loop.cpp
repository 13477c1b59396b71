#include "our_loop.hpp"

namespace pilotfish::bench {

OurLoop::OurLoop(const sim::Scenario& scenario)
    : Loop("Pilotfish"), world_(scenario), follower_(world_.scenario()), coordinator_(follower_.config) {}

FrameFigures OurLoop::play(int frame) {
  FrameFigures figures;
  const Clock::time_point begin = Clock::now();
  world_.advance_to(frame / world_.scenario().frame_rate_hz);
  const Clock::time_point moved = Clock::now();
  const std::optional<Frame> picture = world_.capture(follower_.name);
  const Clock::time_point rendered = Clock::now();
  std::optional<Observation> seen;
  if (picture) {
    const StepResult result = coordinator_.step(*picture, {picture->utime});
    world_.command(follower_.name, result.command, world_.time_s() + world_.latency_s(follower_.name));
    seen = result.observation;
  }
  const Clock::time_point commanded = Clock::now();
  figures.move_ns = elapsed_ns(begin, moved);
  figures.render_ns = elapsed_ns(moved, rendered);
  figures.see_decide_ns = elapsed_ns(rendered, commanded);
  judge(world_, follower_, seen, figures);
  return figures;
}

}  // namespace pilotfish::bench
