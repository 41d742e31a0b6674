"""Studies of missions: decisions made once more, explained and changed, by engines that no mission asks."""
