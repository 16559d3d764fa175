#pragma once

// What the levels have in common is called, not copied, where lanes are so many registers that all
// of it lies in memory anyway: tens of kilobytes for each level of each number type.
#if defined(WINNOW_ISA_IS_sse42)
#define WINNOW_SHARED_BY_LEVELS [[gnu::noinline]]
#else
#define WINNOW_SHARED_BY_LEVELS [[gnu::always_inline]] inline
#endif
