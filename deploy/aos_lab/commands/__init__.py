"""The laboratory's sub-commands of `aos`."""
