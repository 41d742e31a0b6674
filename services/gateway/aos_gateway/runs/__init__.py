"""Runs and systems as the gateway knows them: found, followed, started, and rows of their steps."""
