"""The sub-commands of `aos`, marked in each module by `options.command`."""
