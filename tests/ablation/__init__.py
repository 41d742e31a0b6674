"""Ablations: what planners lose where one of their mechanisms is switched off."""
