"""Policies computed before the mission: enumerated models, the SARSOP solver, and policies."""
