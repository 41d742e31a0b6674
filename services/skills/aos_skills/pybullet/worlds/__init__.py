"""Worlds, one folder each: the form of its world files, the room, and a file for each skill.

A folder's name is the `kind` that world files give; nothing else lists them.
"""
