// What an emitted model needs. System headers are left out, since their macros could be names in a document.
#pragma once

#include "aos/base/fault.hpp"
#include "aos/model/blame.hpp"
#include "aos/model/containers.hpp"
#include "aos/model/correction.hpp"
#include "aos/model/grounding.hpp"
#include "aos/model/model_of.hpp"
#include "aos/model/model_table.hpp"
#include "aos/model/reflection.hpp"
#include "aos/model/reporting.hpp"
#include "aos/model/sorted.hpp"
#include "aos/model/state_text.hpp"
#include "aos/model/text.hpp"
#include "aos/model/transition.hpp"
#include "aos/model/violations.hpp"
