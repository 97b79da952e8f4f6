// Loops over long arrays, compiled for the vector registers of several processors.
#pragma once

/// RIGTWIN_WIDE: a function of plain loops, which is compiled several times; the program takes at its start what the
/// processor has. The bits are the same: each number is computed as the source says, and no product and sum become one
/// instruction (-ffp-contract=off). Under clang, whose sanitizers start later than this choice, and elsewhere: once.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define RIGTWIN_WIDE [[gnu::target_clones("default", "avx2", "avx512f")]]
#else
#define RIGTWIN_WIDE
#endif
