"""The edits that make document code C++ in its function."""
