#pragma once

// Marks code that all levels share. On SSE4.2 it is called, not inlined: with few registers its
// data is in memory anyway, and inlining would add tens of kilobytes of code per level and number
// type.
#if defined(WINNOW_ISA_IS_sse42)
#define WINNOW_SHARED_BY_LEVELS [[gnu::noinline]]
#else
#define WINNOW_SHARED_BY_LEVELS [[gnu::always_inline]] inline
#endif
