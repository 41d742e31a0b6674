"""What every process needs: bus, journal, lifecycle, clock, child processes."""
