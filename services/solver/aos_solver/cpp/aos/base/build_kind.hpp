// What a thorough build of a model spends its time on, and a quick one (AOS_QUICK) does not.
#pragma once

#include <type_traits>

#include "aos/base/random.hpp"

// Before a function that is to have all that it calls inlined into it.
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

// What model code draws from, made of a source: the source itself, to which the code then is compiled, or any source.
template <class Random>
using ModelSource = std::conditional_t<is_quick_build, AnySource, Random&>;

}  // namespace aos
