#include "allocation_counter.hpp"

#include <atomic>
#include <cerrno>
#include <cstddef>

namespace {
std::atomic<std::int64_t> count{0};
}  // namespace

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

bool pilotfish::probes::can_count_allocations() noexcept { return false; }

#else

bool pilotfish::probes::can_count_allocations() noexcept { return true; }

// What a program defines goes before what the C library has, for the program and for all its shared libraries. The
// doors behind are glibc's.
extern "C" {
void* __libc_malloc(std::size_t size);                       // NOLINT(bugprone-reserved-identifier)
void* __libc_calloc(std::size_t number, std::size_t size);   // NOLINT(bugprone-reserved-identifier)
void* __libc_realloc(void* old, std::size_t size);           // NOLINT(bugprone-reserved-identifier)
void* __libc_memalign(std::size_t where, std::size_t size);  // NOLINT(bugprone-reserved-identifier)

void* malloc(std::size_t size) {
  ++count;
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
  ++count;
  return __libc_calloc(number, size);
}
void* realloc(void* old, std::size_t size) {
  ++count;
  return __libc_realloc(old, size);
}
void* memalign(std::size_t where, std::size_t size) {
  ++count;
  return __libc_memalign(where, size);
}
void* aligned_alloc(std::size_t where, std::size_t size) {
  ++count;
  return __libc_memalign(where, size);
}
int posix_memalign(void** result, std::size_t where, std::size_t size) {
  ++count;
  *result = __libc_memalign(where, size);
  return *result != nullptr ? 0 : ENOMEM;
}
}

#endif

std::int64_t pilotfish::probes::allocations() noexcept { return count.load(); }
