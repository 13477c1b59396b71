#include "pilotfish/sim/awaited_answers.hpp"

namespace pilotfish::sim {

void AwaitedAnswers::sent(const std::string& robot, std::int64_t utime, double now_s) {
  awaited_[robot] = {utime, now_s, now_s};
}

bool AwaitedAnswers::answered(const std::string& robot, std::int64_t utime) {
  const auto found = awaited_.find(robot);
  if (found == awaited_.end() || found->second.utime != utime) return false;
  awaited_.erase(found);
  return true;
}

std::vector<std::string> AwaitedAnswers::to_resend(double now_s) {
  std::vector<std::string> robots;
  for (auto& [robot, awaited] : awaited_) {
    if (now_s - awaited.last_sent_s < resend_after_s_) continue;
    awaited.last_sent_s = now_s;
    robots.push_back(robot);
  }
  return robots;
}

std::vector<std::string> AwaitedAnswers::overdue(double now_s) const {
  std::vector<std::string> robots;
  for (const auto& [robot, awaited] : awaited_)
    if (now_s - awaited.first_sent_s >= give_up_after_s_) robots.push_back(robot);
  return robots;
}

}  // namespace pilotfish::sim
