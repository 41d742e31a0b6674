// The engine for models whose states have up to AOS_STATE_BYTES bytes; 0 stands for any number. It is linked
// with one of these models.
#include "aos/child/child.hpp"
#include "aos/model/erased_model.hpp"

int main(int argc, char** argv) { return aos::run_child<aos::ErasedModel<AOS_STATE_BYTES>>(argc, argv); }
