#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::sim {

/// The pictures of one exposure that were sent, and the robots that have not answered yet: the state of lock-step,
/// without a clock and without a bus. Times are seconds on any clock that only goes forward.
class AwaitedAnswers {
 public:
  /// Resends after resend_after_s without an answer, and gives up after give_up_after_s.
  AwaitedAnswers(double resend_after_s, double give_up_after_s)
      : resend_after_s_(resend_after_s), give_up_after_s_(give_up_after_s) {}

  /// A picture was sent: its answer is awaited.
  void sent(const std::string& robot, std::int64_t utime, double now_s);
  /// A command was received. True if it answers the picture that is awaited of this robot; it is then not awaited
  /// any more. A second answer, or one to an older picture, is false.
  bool answered(const std::string& robot, std::int64_t utime);

  bool complete() const { return awaited_.empty(); }  ///< no robot is awaited
  /// Whose picture is to be sent once more; the next time is resend_after_s later.
  std::vector<std::string> to_resend(double now_s);
  /// The robots that have been silent for too long.
  std::vector<std::string> overdue(double now_s) const;

 private:
  struct Awaited {
    std::int64_t utime = 0;
    double first_sent_s = 0.0, last_sent_s = 0.0;
  };
  double resend_after_s_, give_up_after_s_;
  std::map<std::string, Awaited> awaited_;
};

}  // namespace pilotfish::sim
PILOTFISH_API_END
