"""Skills that are played by their own documents, where there is no robot: the adapter `model`."""
