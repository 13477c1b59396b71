#include <memory>

#include "arrays.hpp"
#include "avoidance.hpp"
#include "drive_identifier.hpp"
#include "exclusive.hpp"
#include "guard.hpp"
#include "parameters.hpp"
#include "pilotfish/control/follower.hpp"
#include "python_law.hpp"

namespace py = pybind11;
using namespace pilotfish;
using namespace pilotfish::control;
using namespace pilotfish::python;

namespace {

void bind_estimator(py::module_& m) {
  py::enum_<EgoMotionSource>(m, "EgoMotionSource", "Where the own motion is taken from.")
      .value("commanded", EgoMotionSource::commanded)
      .value("odometry", EgoMotionSource::odometry);
  py::class_<EgoMotion>(m, "EgoMotion", "Dead reckoning through a model of the drive, in an odometry frame.")
      .def(py::init<const DriveModelConfig&, const LimitsConfig&>(), py::arg("drive") = DriveModelConfig{},
           py::arg("limits") = LimitsConfig{},
           "drive: latency and lag of the wheels; limits: acceleration of the drive's ramp. The odometry frame begins "
           "where the robot stands.")
      .def("command", &EgoMotion::command, py::arg("twist"), py::arg("acts_utime"),
           "From acts_utime [us] on this Twist commands the wheels; commands come in the order in which they act.")
      .def("measured", &EgoMotion::measured, py::arg("utime"), py::arg("twist"),
           "What odometry says; False if it cannot be used.")
      .def("advance_to", &EgoMotion::advance_to, py::arg("utime"),
           "Moves on to utime [us]. The first call only sets the clock; a time in the past changes nothing.")
      .def_property_readonly("source", &EgoMotion::source, "EgoMotionSource of what is known about the present time")
      .def_property_readonly(
          "pose",
          [](const EgoMotion& own) {
            const Pose2& pose = own.pose();
            return py::make_tuple(pose.x_m, pose.y_m, pose.heading_rad);
          },
          "(x_m, y_m, heading_rad)")
      .def_property_readonly("twist", &EgoMotion::twist, "the real one, behind the commands");

  py::class_<LeaderEstimate>(m, "LeaderEstimate", "(x, y, vx, vy, heading, turn rate) in the odometry frame.")
      .def(py::init([](const std::array<double, 6>& mean, const DoubleArray& covariance) {
             return LeaderEstimate{Eigen::Map<const LeaderVector>(mean.data()),
                                   to_matrix<6, 6>(covariance, "covariance")};
           }),
           py::arg("mean"), py::arg("covariance"),
           "mean: (6,); covariance: (6, 6), both in the order x, y [m], vx, vy [m/s], heading [rad], turn rate "
           "[rad/s]. ValueError on another shape.")
      .def_property_readonly(
          "mean", [](const LeaderEstimate& e) { return py::array_t<double>(6, e.mean.data()); },
          "(6,): x, y [m], vx, vy [m/s], heading [rad], turn rate [rad/s]; the heading counts on beyond pi")
      .def_property_readonly(
          "covariance", [](const LeaderEstimate& e) { return to_array(e.covariance); }, "(6, 6)");
  m.def(
      "predict_leader",
      [](const std::array<double, 6>& mean, const DoubleArray& covariance, double velocity_sigma, double turn_sigma,
         double position_sigma, double dt_s) {
        const LeaderEstimate estimate{Eigen::Map<const LeaderVector>(mean.data()),
                                      to_matrix<6, 6>(covariance, "covariance")};
        return predict_leader(estimate, velocity_sigma, turn_sigma, position_sigma, dt_s);
      },
      py::arg("mean"), py::arg("covariance"), py::kw_only(), py::arg("velocity_sigma"), py::arg("turn_sigma"),
      py::arg("position_sigma"), py::arg("dt_s"), "LeaderEstimate after dt_s on a coordinated turn.");

  py::class_<LeaderMotion>(m, "LeaderMotion", "The leader as seen from a pose of the coordinator.")
      .def(py::init<>(), "All zeros.")
      .def_readwrite("distance_m", &LeaderMotion::distance_m, "distance between the base origins [m]")
      .def_readwrite("bearing_rad", &LeaderMotion::bearing_rad, "bearing of the leader [rad], positive: to the left")
      .def_readwrite("heading_rad", &LeaderMotion::heading_rad,
                     "the leader's heading relative to the coordinator's [rad]")
      .def_readwrite("radial_mps", &LeaderMotion::radial_mps, "the leader's own velocity along the line of sight")
      .def_readwrite("tangential_mps", &LeaderMotion::tangential_mps, "and across it, to the left")
      .def_readwrite("turn_rate_radps", &LeaderMotion::turn_rate_radps,
                     "the leader's own turn rate [rad/s], positive: to the left")
      .def_readwrite("distance_sigma_m", &LeaderMotion::distance_sigma_m, "standard deviation of distance_m [m]")
      .def_readwrite("radial_sigma_mps", &LeaderMotion::radial_sigma_mps, "standard deviation of radial_mps [m/s]")
      .def_readwrite("tangential_sigma_mps", &LeaderMotion::tangential_sigma_mps,
                     "standard deviation of tangential_mps [m/s]");

  py::class_<LeaderMotionEstimator> estimator(m, "LeaderMotionEstimator", "The leader's motion, by vision alone.");
  py::enum_<LeaderMotionEstimator::Outcome>(estimator, "Outcome", "What an update led to.")
      .value("started", LeaderMotionEstimator::Outcome::started)
      .value("updated", LeaderMotionEstimator::Outcome::updated)
      .value("position_only", LeaderMotionEstimator::Outcome::position_only)
      .value("outlier", LeaderMotionEstimator::Outcome::outlier)
      .value("restarted", LeaderMotionEstimator::Outcome::restarted)
      .value("unusable", LeaderMotionEstimator::Outcome::unusable);
  estimator
      .def(py::init<const LeaderMotionConfig&>(), py::arg("config") = LeaderMotionConfig{},
           "Three extended Kalman filters joined by the interacting multiple model method (Blom and Bar-Shalom, IEEE "
           "Trans. Automatic Control 33(8), 1988).")
      .def(
          "update",
          [](LeaderMotionEstimator& self, const Observation& seen, const std::array<double, 3>& own) {
            return self.update(seen, {own[0], own[1], own[2]});
          },
          py::arg("observation"), py::arg("own_pose"), "own_pose: (x_m, y_m, heading_rad) in the odometry frame")
      .def("reset", &LeaderMotionEstimator::reset, "Forgets the leader; the next update begins anew.")
      .def_property_readonly("started", &LeaderMotionEstimator::started, "True once there is an estimate")
      .def("at", &LeaderMotionEstimator::at, py::arg("utime"), "LeaderEstimate, not before the last update.")
      .def_property_readonly("probabilities", &LeaderMotionEstimator::probabilities,
                             "of the modes: quiescent, manoeuvre, abrupt")
      .def_property_readonly(
          "own_position_sigma", [](const LeaderMotionEstimator& self) { return self.own_noise().sigma(); },
          "dead-reckoning drift along the line of sight [m per sqrt(s)], as learned so far; "
          "0 until enough is known")
      .def_property_readonly(
          "excess_sigma",
          [](const LeaderMotionEstimator& self) { return DoubleArray(3, self.noise().excess_sigma().data()); },
          "(3,): what the measurements scatter beyond their covariance, as learned so far: along the line of sight "
          "[m], "
          "across it [m], of the heading [rad]");
  m.def(
      "seen_from",
      [](const std::array<double, 3>& own, const LeaderEstimate& leader) {
        return seen_from({own[0], own[1], own[2]}, leader);
      },
      py::arg("own_pose"), py::arg("leader"), "LeaderMotion of an estimate, from (x_m, y_m, heading_rad).");
}

void bind_leader_intent(py::module_& m) {
  bind_parameters<LeaderIntentConfig>(m, "LeaderIntentConfig", "How the leader intent is used.");
  py::enum_<LeaderIntentUse>(m, "LeaderIntentUse", "How the leader intent was used in this frame.")
      .value("silent", LeaderIntentUse::silent)
      .value("probation", LeaderIntentUse::probation)
      .value("agrees", LeaderIntentUse::agrees)
      .value("used", LeaderIntentUse::used)
      .value("suspended", LeaderIntentUse::suspended);
  py::class_<LeaderIntent>(m, "LeaderIntent", "The twist a leader announces of itself, and whether to use it.")
      .def(py::init<const LeaderIntentConfig&>(), py::arg("config") = LeaderIntentConfig{},
           "config: LeaderIntentConfig. No intent has been received yet.")
      .def("update", &LeaderIntent::update, py::arg("utime"), py::arg("twist"), "False if it cannot be used.")
      .def(
          "evaluate",
          [](LeaderIntent& self, const LeaderEstimate& seen, const std::array<double, 3>& own, std::int64_t utime) {
            return self.evaluate(seen, {own[0], own[1], own[2]}, utime);
          },
          py::arg("seen"), py::arg("own_pose"), py::arg("utime"), "Once a frame: LeaderIntentUse.")
      .def(
          "slowed",
          [](const LeaderIntent& self, const LeaderEstimate& seen) {
            return self.has_intent() ? self.slowed(seen) : seen;
          },
          py::arg("seen"), "The estimate as slow as announced.")
      .def("reset", &LeaderIntent::reset, "The leader was lost: probation begins anew, a suspension goes on.");
}

void bind_anticipation(py::module_& m) {
  py::class_<FieldOfView>(m, "FieldOfView", "Bearings at which the leader is in the picture.")
      .def(py::init([](double right_rad, double left_rad) {
             return FieldOfView{right_rad, left_rad};
           }),
           py::kw_only(), py::arg("right_rad"), py::arg("left_rad"),
           "Bearings of the picture's edges [rad], in the base frame, positive to the left.")
      .def_readwrite("right_rad", &FieldOfView::right_rad,
                     "bearing of the right edge [rad], negative in a forward-looking camera")
      .def_readwrite("left_rad", &FieldOfView::left_rad,
                     "bearing of the left edge [rad], positive in a forward-looking camera");
  py::class_<Anticipation>(m, "Anticipation", "Output of the law for a predicted leader, before limits.")
      .def_readonly("wanted", &Anticipation::wanted, "Twist: output of the law before limits")
      .def_readonly("velocity", &Anticipation::velocity, "VelocityCommand: the fuzzy law on the predicted error");
  m.def("feed_forward_weight", &feed_forward_weight, py::arg("config"), py::arg("leader"),
        "How much the leader's estimated velocity counts: 1 / (1 + (sigma / half_weight_sigma_mps)^2), in (0, 1].");
  m.def("anticipate", &anticipate, py::arg("controller"), py::arg("paper"), py::arg("config"), py::arg("leader"),
        py::arg("own"), py::arg("setpoint"), "The paper's law around the leader's motion; not yet limited.");
  m.def("eased_speed", &eased_speed, py::arg("config"), py::arg("limits"), py::arg("previous_mps"), py::arg("dt_s"),
        "Fastest speed a time dt_s after `previous_mps` that approaches the top speed without a step in acceleration.");
  m.def("keep_in_view", &keep_in_view, py::arg("config"), py::arg("view"), py::arg("limits"), py::arg("leader"),
        py::arg("wanted"), "The nearest twist that keeps the leader in the picture.");
}

const LawDescription& named(const FollowerConfig& config, const std::string& law) {
  for (const LawDescription& each : config.laws)
    if (each.name == law) return each;
  throw ConfigError("law", "'" + law + "' is not one of `laws`");
}

void set_laws(FollowerConfig& config, const std::vector<LawDescription>& laws) {
  FollowerConfig changed = config;
  changed.laws = laws;
  check_law_names(changed);
  config.laws = laws;
}

decltype(LawDescription::make) make_of_built_in(const std::string& name) {
  for (const LawDescription& law : built_in_laws())
    if (law.name == name) return law.make;
  throw ConfigError("control." + name, "is not built in: say how to make it");
}

void bind_laws(py::module_& m) {
  py::class_<LawParameter>(m, "LawParameter", "A number in the configuration's section control.<law>.")
      .def(py::init([](std::string key, double value, double min, double max, std::string text) {
             return LawParameter{std::move(key), value, min, max, std::move(text)};
           }),
           py::arg("key"), py::arg("value"), py::kw_only(), py::arg("min"), py::arg("max"), py::arg("text") = "",
           "min and max are inclusive; text is one sentence for the documentation.")
      .def_readonly("key", &LawParameter::key, "name in the configuration; it carries the unit")
      .def_readonly("value", &LawParameter::value, "the value, in the key's unit")
      .def_readonly("min", &LawParameter::min, "smallest value allowed, inclusive")
      .def_readonly("max", &LawParameter::max, "largest value allowed, inclusive")
      .def_readonly("text", &LawParameter::text, "one sentence for the documentation");
  py::class_<LawDescription>(m, "LawDescription",
                             "A law as the configuration, the command line and the documentation know it.")
      .def(py::init([](std::string name, std::string text, std::vector<LawParameter> parameters,
                       const std::optional<py::function>& make) {
             if (make) check_own_law_name(name);
             LawDescription law{name, std::move(text), std::move(parameters), nullptr};
             law.make = make ? PythonMaker{name, shared(*make)} : make_of_built_in(name);
             return law;
           }),
           py::kw_only(), py::arg("name"), py::arg("text"), py::arg("parameters") = std::vector<LawParameter>{},
           py::arg("make"),
           "make({parameter: value}, limits) returns the law: an object with follow(observation, setpoint, dt_s) -> "
           "Twist "
           "and, if it remembers anything, restart(). None: the built-in law of that name. ConfigError (key `law`) if "
           "the name is that of another law or of a section of the configuration's `control`.")
      .def_readonly("name", &LawDescription::name, "one word, as in `law: pid`")
      .def_readonly("text", &LawDescription::text, "one line for lists")
      .def_readonly("parameters", &LawDescription::parameters, "list of LawParameter, a copy")
      .def_property_readonly(
          "make",
          [](const LawDescription& law) -> std::optional<py::function> {
            const PythonMaker* const maker = law.make.target<PythonMaker>();
            return maker != nullptr ? std::optional(*maker->make) : std::nullopt;
          },
          "what makes it, or None of a law that is built in");
  m.def("built_in_laws", &built_in_laws, "The laws that come with Pilotfish, beside the fuzzy one.");
  m.attr("FUZZY_LAW") = kFuzzyLaw;
}

}  // namespace

PYBIND11_MODULE(control, m) {
  py::module_::import("pilotfish.core");
  py::module_::import("pilotfish.fuzzy");
  m.doc() = "From an observation to a twist: the fuzzy velocity law, the heading controller, the limits.";

  bind_laws(m);
  py::enum_<Profile>(m, "Profile", "How the fuzzy law drives.")
      .value("paper", Profile::paper)
      .value("anticipate", Profile::anticipate);

  bind_parameters<FuzzyVelocityConfig>(m, "FuzzyVelocityConfig", "Physical meaning of the normalised universes.");
  bind_parameters<HeadingControllerConfig>(m, "HeadingControllerConfig", "Proportional heading controller.");
  bind_parameters<LimitsConfig>(m, "LimitsConfig", "Limits on speed, acceleration and turn rate.");
  bind_parameters<AnticipateConfig>(m, "AnticipateConfig", "The paper's law around the leader's motion.");
  bind_parameters<LeaderMotionConfig>(m, "LeaderMotionConfig", "How leaders move.");
  bind_avoidance(m);
  bind_parameters<DriveModelConfig>(m, "DriveModelConfig", "How late the wheels execute a command.");

  py::class_<VelocityCommand>(m, "VelocityCommand", "One evaluation of the law with all it went through.")
      .def_readonly("linear_mps", &VelocityCommand::linear_mps, "forward speed, output of the law before limits [m/s]")
      .def_readonly("error_m", &VelocityCommand::error_m, "e = d_p - d; positive: too close")
      .def_readonly("error_change_m", &VelocityCommand::error_change_m, "ec, per control period")
      .def_readonly("inference", &VelocityCommand::inference,
                    "Inference: output u* in [-1, 1] and the strengths of the 56 rules");

  bind_estimator(m);
  bind_leader_intent(m);
  bind_drive_identifier(m);
  bind_guard(m);
  bind_anticipation(m);

  py::class_<FollowerConfig> follower_config(m, "FollowerConfig", "Everything a Follower needs.");
  bind_attributes(m, follower_config);
  {
    py::options options;
    options.disable_function_signatures();
    const std::string signature = keyword_signature<FollowerConfig>(
        ", law: pilotfish.fuzzy.Controller, profile: Profile = Profile.anticipate, active_law: str = '" +
            std::string(kFuzzyLaw) + "', laws: list[LawDescription] = ...",
        ", view: FieldOfView = ...");
    follower_config.def(
        py::init([](const fuzzy::Controller& law, Profile profile, const std::string& active_law,
                    const std::vector<LawDescription>& laws, const py::kwargs& sections) {
          FollowerConfig made;
          made.law = law;
          made.profile = profile;
          set_laws(made, laws);
          set_active_law(made, active_law);
          set_attributes(py::cast(&made, py::return_value_policy::reference), sections, "FollowerConfig");
          return made;
        }),
        py::kw_only(), py::arg("law"), py::arg("profile") = Profile::anticipate, py::arg("active_law") = kFuzzyLaw,
        py::arg("laws") = built_in_laws(),
        (signature + " law: the fuzzy controller; laws: built_in_laws() and your own.").c_str());
  }
  follower_config.def_readwrite("profile", &FollowerConfig::profile, "Profile: how the fuzzy law drives")
      .def_readwrite("law", &FollowerConfig::law,
                     "fuzzy.Controller: the fuzzy law, by default the paper's 56 rules (Table I)")
      .def_property(
          "active_law", [](const FollowerConfig& of) { return of.active_law; }, &set_active_law,
          "\"fuzzy\" or the name of one of `laws`; ValueError lists them")
      .def_property(
          "laws", [](const FollowerConfig& of) { return of.laws; }, &set_laws,
          "what may drive instead of the fuzzy law; assign a new list to change it. ConfigError if a name is there "
          "twice")
      .def(
          "law_parameters",
          [](const FollowerConfig& config, const std::string& law) { return values_of(named(config, law)); },
          py::arg("law"), "{parameter: value} of a law, as in the section control.<law>")
      .def(
          "set_law_parameter",
          [](FollowerConfig& config, const std::string& law, const std::string& key, double value) {
            for (LawDescription& each : config.laws)
              if (each.name == law) return set_parameter(each, key, value);
            named(config, law);
          },
          py::arg("law"), py::arg("parameter"), py::arg("value"), "ValueError names what is out of range or unknown")
      .def_readwrite("view", &FollowerConfig::view, "a Coordinator fills it in from its camera")
      .def_readwrite("hold_s", &FollowerConfig::hold_s,
                     "how long a command acts, for the guard [s]; a Coordinator fills it in: safety.max_age_s");

  py::class_<FollowerOutput>(m, "FollowerOutput", "The command and what the fuzzy law said on the way.")
      .def_readonly("command", &FollowerOutput::command, "Twist within the limits; zero unless reason is none")
      .def_readonly("setpoint", &FollowerOutput::setpoint, "Setpoint that was kept: with the headway")
      .def_readonly(
          "reason", &FollowerOutput::reason,
          "Reason.law_not_finite if the law's twist, the measurement or the setpoint was no number, else none")
      .def_readonly(
          "velocity", &FollowerOutput::velocity,
          "VelocityCommand: the fuzzy law on the measured error or, where it anticipates, on the predicted one")
      .def_readonly("leader", &FollowerOutput::leader, "LeaderMotion as predicted, or None")
      .def_readonly("feed_forward_weight", &FollowerOutput::feed_forward_weight,
                    "share of the feed-forward in the command")
      .def_readonly("ego_motion", &FollowerOutput::ego_motion, "EgoMotionSource: where the own motion was taken from")
      .def_readonly("drive", &FollowerOutput::drive,
                    "DriveEstimate: the drive's delays as this command assumes them; None unless it anticipates")
      .def_readonly("avoidance", &FollowerOutput::avoidance, "AvoidanceOutput, or None where it is not enabled")
      .def_readonly("effect_utime", &FollowerOutput::effect_utime,
                    "when the command has taken effect [us], the time for which it is announced to robots that follow "
                    "this one; 0 with a reason")
      .def_readonly("leader_intent", &FollowerOutput::leader_intent, "LeaderIntentUse: how the leader intent was used");

  py::class_<Follower>(m, "Follower", "Observation in, Twist out; time comes from the observations.")
      .def(py::init<FollowerConfig>(), py::arg("config"), py::call_guard<py::gil_scoped_release>(),
           "ConfigError names the parameter that is out of range.")
      .def("follow", exclusive([](Follower& follower, const Observation& observation, const Setpoint& setpoint) {
             return raising_law_exceptions([&] {
               const py::gil_scoped_release unlocked;
               return follower.follow(observation, setpoint);
             });
           }),
           py::arg("observation"), py::arg("setpoint"),
           "FollowerOutput for an Observation and a Setpoint; the time since the last call is that between the "
           "observations. Of what a law written in Python raises, only what is no Exception (KeyboardInterrupt, "
           "SystemExit) comes out here.")
      .def("set_ego_motion", exclusive(&Follower::set_ego_motion), py::arg("utime"), py::arg("twist"),
           "The own Twist as odometry measured it at utime [us]. False, and nothing changes, if it cannot be used. "
           "Profile `anticipate` alone listens.")
      .def("set_leader_intent", exclusive(&Follower::set_leader_intent), py::arg("utime"), py::arg("twist"),
           "The Twist that the leader announces of itself at utime [us]. False, and nothing changes, if it cannot be "
           "used. Profile `anticipate` alone listens.")
      .def("set_ranges", exclusive(&Follower::set_ranges), py::arg("scan"),
           "What sonars or a laser measured. False, and nothing changes, if it cannot be used.")
      .def("pause", exclusive(&Follower::pause), py::arg("held_us"),
           "The last command was held for held_us [us] and has been zero since, because no measurement came. The "
           "leader's "
           "estimate goes on for leader_motion.memory_s.")
      .def("restart", exclusive([](Follower& follower, std::int64_t since_utime) {
             follower.restart(since_utime);
             raise_law_exception();
           }),
           py::arg("since_utime"), "Forget the past: from then on the robot is commanded to stand still.");

  m.def("heading_turn_rate", &heading_turn_rate, py::arg("config"), py::arg("bearing_rad"),
        py::arg("bearing_setpoint_rad"), "Turn rate [rad/s], positive to the left.");
  m.def("limit", &limit, py::arg("config"), py::arg("wanted"), py::arg("previous"), py::arg("dt_s"),
        "The nearest command to `wanted` within the limits.");
  m.def("fuzzy_velocity", &fuzzy_velocity, py::arg("controller"), py::arg("config"), py::arg("distance_setpoint_m"),
        py::arg("distance_m"), py::arg("previous_error_m"), py::arg("dt_s"), py::arg("distance_sigma_m") = 0.0,
        "The paper's law on one distance; previous_error_m may be None.");

  make_value(m, "LeaderEstimate", {"mean", "covariance"});
  make_value(m, "FieldOfView", {"right_rad", "left_rad"});
  make_value(m, "LeaderMotion");
  make_value(m, "LawParameter", {"key", "value", "min", "max", "text"});
  make_value(m, "LawDescription", {"name", "text", "parameters", "make"});
  make_value(m, "FollowerConfig", {"law", "laws", "active_law"});
  make_results<AvoidanceOutput, Anticipation, VelocityCommand, FollowerOutput>();
  add_reprs(m, {"AvoidanceOutput", "LeaderEstimate", "LeaderMotion", "Gap", "FieldOfView", "Anticipation",
                "LawParameter", "LawDescription", "VelocityCommand", "FollowerOutput"});
  add_repr(m, "EgoMotion", {"pose", "twist", "source"});
  add_repr(m, "FollowerConfig",
           {"profile", "active_law", "velocity", "heading", "limits", "guard", "spacing", "anticipate", "leader_motion",
            "drive", "leader_intent", "avoidance", "search", "view"});
}
