"""Bundles as commands take them: their documents, the engine of their model, and what a look at it finds."""
