"""The engine process of one model: starting it, asking it, and telling where it failed."""
