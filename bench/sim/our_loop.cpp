#include "our_loop.hpp"

namespace pilotfish::bench {

OurLoop::OurLoop(const sim::Scenario& scenario)
    : Loop("Pilotfish"), world_(scenario), follower_(world_.scenario()), coordinator_(follower_.config) {}

FrameFigures OurLoop::play(int frame) {
  FrameFigures figures;
  const std::int64_t begin = thread_ns();
  world_.advance_to(frame / world_.scenario().frame_rate_hz);
  const std::int64_t moved = thread_ns();
  const std::optional<Frame> picture = world_.capture(follower_.name);
  const std::int64_t rendered = thread_ns();
  std::optional<Observation> seen;
  if (picture) {
    const StepResult result = coordinator_.step(*picture, {picture->utime});
    world_.command(follower_.name, result.command, world_.time_s() + world_.latency_s(follower_.name));
    seen = result.observation;
  }
  const std::int64_t commanded = thread_ns();
  figures.move_ns = moved - begin;
  figures.render_ns = rendered - moved;
  figures.see_decide_ns = commanded - rendered;
  judge(world_, follower_, seen, figures);
  return figures;
}

}  // namespace pilotfish::bench
