"""Reading the C++ in documents: tokens, trees, what code reads and writes, loops, and ways through it."""
