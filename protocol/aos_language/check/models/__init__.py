"""The rules of model code, the C++ of environment and skills.

`blocks` lists its pieces, each with what it may read and write, and every other file has one rule.
"""
