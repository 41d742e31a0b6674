// The engine for models whose states have up to AOS_STATE_BYTES bytes, or any number where that is 0; linked with one
// of them.
#include "aos/child/child.hpp"
#include "aos/model/erased_model.hpp"
#include "aos/model/support.hpp"

int main(int argc, char** argv) { return aos::run_child<aos::ErasedModel<AOS_STATE_BYTES>>(argc, argv); }
