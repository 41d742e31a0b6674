"""Documents to C++ to decisions: lowering, emission, build, engine child, mission loop."""
