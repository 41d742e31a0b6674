// What a thorough build of a model spends its time on.
#pragma once

// Before a function that is to have all that it calls inlined into it. A quick build (AOS_QUICK) calls.
#ifdef AOS_QUICK
#define AOS_INLINING_ALL
#else
#define AOS_INLINING_ALL [[gnu::flatten]]
#endif
