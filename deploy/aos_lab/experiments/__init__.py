"""Experiments: many missions of several documents, and a report of which claims were seen."""
