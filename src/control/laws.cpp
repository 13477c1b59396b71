#include "pilotfish/control/law.hpp"
#include "pilotfish/control/pbvs_law.hpp"
#include "pilotfish/control/pid_law.hpp"

namespace pilotfish::control {

std::vector<LawDescription> built_in_laws() {
  return {
#ifdef PILOTFISH_WITH_VISP
      describe_law<PbvsLaw, PbvsConfig>("pbvs", "ViSP's position-based visual servo, to compare with"),
#endif
      describe_law<PidLaw, PidConfig>("pid", "PID on distance and bearing, to compare with"),
  };
}

void set_parameter(LawDescription& law, std::string_view key, double value) {
  for (LawParameter& parameter : law.parameters) {
    if (parameter.key != key) continue;
    if (const auto problem = outside(value, parameter.min, parameter.max))
      throw ConfigError("control." + law.name + "." + parameter.key, *problem);
    parameter.value = value;
    return;
  }
  throw ConfigError("control." + law.name + "." + std::string(key), "is not a parameter of this law");
}

}  // namespace pilotfish::control
