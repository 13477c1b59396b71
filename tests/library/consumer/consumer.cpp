#include <cstdio>
#include <pilotfish/fuzzy/membership.hpp>

int main() {
  const pilotfish::fuzzy::MembershipFunction set = pilotfish::fuzzy::Triangle{0.0, 1.0, 2.0};
  std::printf("%.2f\n", membership(set, 0.5));  // half way up
}
