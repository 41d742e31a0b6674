"""The laboratory's sub-commands of `aos`; each module has `register(app)`."""
