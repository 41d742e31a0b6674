"""The sub-commands of `aos`, marked in each module by `marked_commands.command`."""
