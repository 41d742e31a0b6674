"""The command line, the deploy file, and the supervisor that brings the system up and down."""
