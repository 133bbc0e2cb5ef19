// Compiles a function once for every x86-64 and once for those with AVX2; the loader picks. For
// plain loops that the compiler vectorises. Integer results are the same either way, and so are
// floating-point ones without reductions: AVX2 alone brings no fused multiply-add.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define VPSLAM_MULTIVERSION [[gnu::target_clones("avx2", "default")]]
#else
#define VPSLAM_MULTIVERSION
#endif
