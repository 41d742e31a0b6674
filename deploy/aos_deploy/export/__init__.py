"""Records of runs to take home: journals as MCAP, as tables, and whole runs in one file."""
