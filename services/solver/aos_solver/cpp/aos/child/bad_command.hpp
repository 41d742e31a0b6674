// What an engine child answers with when it is asked for something that there is not.
#pragma once

#include <string>

namespace aos {

// A command that cannot be carried out as it was given.
struct BadCommand {
  std::string text;
};

}  // namespace aos
