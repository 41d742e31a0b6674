"""The sub-commands of `aos`; each module has `register(app)`."""
