// Builds of a model: a thorough one compiles longer for faster code, a quick one (AOS_QUICK) does not.
#pragma once

#include "aos/draws/random.hpp"

// An attribute of functions: in a thorough build, everything that the function calls is inlined into it.
#ifdef AOS_QUICK
#define AOS_INLINING_ALL
#else
#define AOS_INLINING_ALL [[gnu::flatten]]
#endif

namespace aos {

#ifdef AOS_QUICK
constexpr bool is_quick_build = true;
#else
constexpr bool is_quick_build = false;
#endif

// What model code draws from. A thorough build is compiled for each kind of source, a quick build once for any source.
template <class Random>
using ModelSource = std::conditional_t<is_quick_build, AnySource, Random&>;

}
