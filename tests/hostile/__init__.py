"""Documents whose code reaches for what it may not: models, mappings, and code for the compiler."""
