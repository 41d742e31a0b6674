// The functions that models call; compiled once for all of them, whatever the size of their states.
#include "aos/model/support.hpp"
