"""Metrics of missions, counted out of their records, in Prometheus' format."""
