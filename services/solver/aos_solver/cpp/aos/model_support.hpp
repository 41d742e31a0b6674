// Everything an emitted model stands on. No system headers here: their macros could be names in a document.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "aos/blame.hpp"
#include "aos/containers.hpp"
#include "aos/correction.hpp"
#include "aos/fault.hpp"
#include "aos/grounding.hpp"
#include "aos/model_table.hpp"
#include "aos/reflection.hpp"
#include "aos/state_text.hpp"
#include "aos/step.hpp"
#include "aos/text.hpp"
#include "aos/trace.hpp"
#include "aos/transition.hpp"
