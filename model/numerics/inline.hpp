// Inlining of the functions of a step.
#pragma once

/// RIGTWIN_INLINE: part of every step. A step is straight code: its parts are inlined even where a compiler's estimate
/// says no, because passing a dozen numbers through memory costs more than the arithmetic.
/// RIGTWIN_NOINLINE: used by some steps of some rigs only. Kept apart, it takes no registers of the straight code.
#if defined(__GNUC__)
#define RIGTWIN_INLINE [[gnu::always_inline]] inline
#define RIGTWIN_NOINLINE [[gnu::noinline]]
#else
#define RIGTWIN_INLINE inline
#define RIGTWIN_NOINLINE
#endif
