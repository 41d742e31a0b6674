"""The search for document code that fails or is slow."""
