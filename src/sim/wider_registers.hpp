#pragma once

/// Before a function of integers: it is compiled twice, also for processors with 256-bit registers (AVX2), and the
/// dynamic linker takes the one that suits the processor. AVX2 alone fuses no multiplications with
/// additions, so that floating point is the same, too. Sanitizers cannot be called as early as the linker chooses.
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PILOTFISH_FOR_WIDER_REGISTERS __attribute__((target_clones("avx2", "default")))
#else
#define PILOTFISH_FOR_WIDER_REGISTERS
#endif
