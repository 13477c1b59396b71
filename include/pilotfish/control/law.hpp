#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/control/limits.hpp"
#include "pilotfish/core/checkpoint.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/setpoint.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// A law that drives instead of the fuzzy one: a measurement in, a twist out. Follower limits its output, turns the
/// robot to a leader that is beside it, and stops it; a law need not do so.
class Law {
 public:
  virtual ~Law() = default;
  /// The wanted twist, not yet limited; dt_s [s] since the last call, one control period at the first after a restart.
  /// A law that fails returns a twist that is not finite, and the robot stops.
  virtual Twist follow(const Observation& observation, const Setpoint& setpoint, double dt_s) noexcept = 0;
  /// Resets the law: the robot stands still from now on.
  virtual void restart() noexcept {}
  /// Its state between two calls, for recordings that are replayed from their middle (core/checkpoint.hpp).
  virtual void remember(CheckpointWriter&) const {}
  virtual void remember(CheckpointReader&) {}  ///< as it was written
};

/// A number in the configuration's section control.NAME of the law NAME.
struct LawParameter {
  std::string key;     ///< carries the unit
  double value = 0.0;  ///< the value, in the key's unit
  /// Both inclusive.
  double min = 0.0, max = 0.0;  ///< inclusive
  std::string text;             ///< one sentence for the documentation
};

/// A law's description for the configuration, the command line, the documentation and Python.
struct LawDescription {
  std::string name;                      ///< one word, as in `law: pid`
  std::string text;                      ///< one line for lists
  std::vector<LawParameter> parameters;  ///< list of LawParameter, a copy
  /// Makes the law from the values of its parameters, in their order, and the limits.
  std::function<std::unique_ptr<Law>(const std::vector<LawParameter>&, const LimitsConfig&)> make;
};

/// Sets a parameter. Throws ConfigError, key "control.LAW.PARAMETER", if there is none of that name or the value is
/// out of its range.
void set_parameter(LawDescription& law, std::string_view key, double value);

/// The description of a law that is made from a struct of doubles with a table of parameters, and the limits.
/// Throws ConfigError naming a parameter that is no double.
template <class LawType, class Config>
LawDescription describe_law(std::string name, std::string text) {
  LawDescription law{std::move(name), std::move(text), {}, nullptr};
  const Config defaults;
  for (const Parameter<Config>& each : Config::parameters()) {
    const auto* const number = std::get_if<double Config::*>(&each.member);
    if (number == nullptr) throw ConfigError(dotted(law.name, each.key), "a law's parameters are doubles");
    law.parameters.push_back({std::string(each.key), defaults.**number, each.min, each.max, std::string(each.text)});
  }
  law.make = [](const std::vector<LawParameter>& values, const LimitsConfig& limits) -> std::unique_ptr<Law> {
    Config config;
    for (std::size_t i = 0; i < values.size(); ++i)
      config.*std::get<double Config::*>(Config::parameters()[i].member) = values[i].value;
    return std::make_unique<LawType>(config, limits);
  };
  return law;
}

/// The laws that come with Pilotfish, beside the fuzzy one: a new one is its own file and a line in laws.cpp. A
/// program's own law goes into FollowerConfig::laws by add_law().
std::vector<LawDescription> built_in_laws();

}  // namespace pilotfish::control
PILOTFISH_API_END
