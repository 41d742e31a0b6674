"""The part of a mission that is on the disk: its journal and its folder."""
