// The parts of the engine that know models as numbers only, compiled together: they read the same headers.
#include "numbers/cell_tables.cpp"
#include "numbers/compact_model.cpp"
#include "numbers/exact.cpp"
#include "numbers/observable_values.cpp"
#include "point_based.cpp"
