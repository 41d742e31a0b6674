// A mistake of model code that shows while the code runs.
#pragma once

#include <string>

namespace aos {

// `code` is one of the codes AOS211, AOS214 and AOS215 of aos_protocol.errors; the document place comes from blame.hpp.
struct ModelFault {
  std::string code;
  std::string text;
};

}
