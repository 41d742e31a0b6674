"""Missions as OpenTelemetry's spans, made of their journals and sent to a collector."""
