// Which functions are part of a step.
#pragma once

/// RIGTWIN_INLINE: part of every step. A step is one straight piece of code; its parts are inlined even where a
/// compiler's estimate says no, because passing a dozen numbers through memory costs more than the arithmetic.
/// RIGTWIN_APART: only some steps of some rigs; kept out of that code so that it does not take its registers.
#if defined(__GNUC__)
#define RIGTWIN_INLINE [[gnu::always_inline]] inline
#define RIGTWIN_APART [[gnu::noinline]]
#else
#define RIGTWIN_INLINE inline
#define RIGTWIN_APART
#endif
