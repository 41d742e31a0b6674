"""Probabilities of documents, estimated from recorded missions."""
