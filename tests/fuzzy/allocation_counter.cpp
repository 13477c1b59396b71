// Counts what the heap is asked for while a controller infers.
//
//   allocation_counter ordered | gaussians   ->  "<evaluations> <allocations> <a sum, so that nothing is left out>"
//
// malloc is replaced by one that counts and passes on; operator new comes here as well.

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "pilotfish/fuzzy/mamdani.hpp"

static long allocations = 0;

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* malloc(std::size_t size) { return ++allocations, __libc_malloc(size); }
void* calloc(std::size_t count, std::size_t size) { return ++allocations, __libc_calloc(count, size); }
void* realloc(void* memory, std::size_t size) { return ++allocations, __libc_realloc(memory, size); }
}

namespace {

using namespace pilotfish::fuzzy;

static_assert(noexcept(infer(std::declval<const Controller&>(), 0.0, 0.0)));
static_assert(noexcept(infer_output(std::declval<const Controller&>(), 0.0, 0.0)));

// Shoulders at the ends and, between them, triangles or Gaussians.
LinguisticVariable partition(const char* name, int count, bool gaussians) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  LinguisticVariable variable{name, -1.0, 1.0, {}};
  const double step = 2.0 / (count - 1);
  for (int k = 0; k < count; ++k) {
    const double peak = -1.0 + k * step;
    MembershipFunction set = Triangle{peak - step, peak, peak + step};
    if (gaussians) set = Gaussian{peak, 0.5 * step};
    if (k == 0) set = Trapezoid{-kInfinity, -kInfinity, peak, peak + step};
    if (k == count - 1) set = Trapezoid{peak - step, peak, kInfinity, kInfinity};
    variable.terms.push_back({"T" + std::to_string(k), set});
  }
  return variable;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 64;
  const bool gaussians = std::strcmp(argv[1], "Gaussians") == 0;
  Controller controller{
      "", partition("E", 8, gaussians), partition("EC", 7, gaussians), partition("U", 7, gaussians), {8, 7, {}}};
  for (std::size_t rule = 0; rule < kPaperRules; ++rule) controller.rules.consequents.push_back((rule * 5) % 7);
  validate(controller);

  const InputWidths wide[] = {{}, {0.1, 0.3, WidthShape::triangle}, {0.1, 0.3, WidthShape::gaussian}};
  long evaluations = 0;
  double sum = 0.0;
  const long before = allocations;
  for (int i = 0; i < 100'000; ++i) {
    const double e = -1.1 + 2.2e-5 * i, ec = 1.1 - 2.2e-3 * (i % 1000);
    const InputWidths& widths = wide[i % 20 == 0 ? 1 + i / 20 % 2 : 0];
    const Inference inference = infer(controller, e, ec, widths);
    sum += inference.output + inference.strengths[17] + infer_output(controller, e, ec, widths);
    evaluations += 2;
  }
  const long after = allocations;
  std::printf("%ld %ld %g %ld\n", evaluations, after - before, sum, before);
  return 0;
}
