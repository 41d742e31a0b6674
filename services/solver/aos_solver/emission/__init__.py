"""The emission of models: a documented project is lowered, its document code rewritten, and the C++ text
written."""
