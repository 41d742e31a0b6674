"""Policies computed before the mission: explicit models, their files, the SARSOP solver, and policies."""
