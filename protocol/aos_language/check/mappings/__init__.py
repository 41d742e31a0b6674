"""The rules of the Python of the mappings.

`mapping_code` looks at all of one mapping by the rules of the other files, and `python_parsed` has the trees.
"""
