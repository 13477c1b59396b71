#include "pilotfish/sim/recorder.hpp"

#include <initializer_list>
#include <limits>

namespace pilotfish::sim {

void write_recording_header(std::ostream& csv) {
  csv << "time_s,utime_us,robot,leader,x_m,y_m,heading_rad,linear_mps,angular_radps,leader_x_m,leader_y_m,"
         "leader_heading_rad,leader_linear_mps,true_distance_m,true_bearing_rad,true_heading_rad,"
         "command_linear_mps,command_angular_radps,status,delivered\n";
}

void write_recording_row(std::ostream& csv, const World& world, const std::string& robot, const Answer& answer) {
  const UnicycleState own = world.state(robot);  // checks the name
  const std::string& leader = world.scenario().find(robot)->follows;
  const UnicycleState other = world.state(leader);
  const RelativePose truth = world.true_relative_pose(robot);
  const std::streamsize precision = csv.precision(std::numeric_limits<double>::max_digits10);
  csv << world.time_s() << ',' << world.utime() << ',' << robot << ',' << leader;
  for (double value : {own.pose.x_m, own.pose.y_m, own.pose.heading_rad, own.twist.linear_mps, own.twist.angular_radps,
                       other.pose.x_m, other.pose.y_m, other.pose.heading_rad, other.twist.linear_mps, truth.distance_m,
                       truth.bearing_rad, truth.heading_rad, answer.command.linear_mps, answer.command.angular_radps})
    csv << ',' << value;
  csv << ',' << answer.status << ',' << (answer.delivered ? 1 : 0) << '\n';
  csv.precision(precision);
}

}  // namespace pilotfish::sim
