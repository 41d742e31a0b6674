// The engine for models whose states have up to AOS_STATE_BYTES bytes; linked with one of them.
#include "aos/child.hpp"
#include "aos/erased_model.hpp"
#include "aos/support.hpp"

int main(int argc, char** argv) { return aos::run_child<aos::ErasedModel<AOS_STATE_BYTES>>(argc, argv); }
