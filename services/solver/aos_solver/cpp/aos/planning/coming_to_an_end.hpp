// Work of a search that a decision can do without.
#pragma once

#include "aos/base/fault.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/model/blame.hpp"

namespace aos {

// Whether the work comes to its end. Model code may fail in states and on paths that no mission comes to, and it may have
// too many outcomes.
bool comes_to_an_end(auto&& work) {
  bool has_ended = false;
  try {
    work();
    has_ended = true;
  } catch (const NotEnumerable&) {
  } catch (const ModelFault&) {
  }
  blame::at(0);
  return has_ended;
}

}
