"""The documents' language: reading bundles in every dialect, checking them, and writing them.

In here are `reading` and `writing` of documents, `check` with every rule, `cpp` that reads the C++ in them,
JSON `schemas`, `templates` of emitted text, and `load`, the way from a folder to a checked project. Not in
here is what follows from a project: the typed structures themselves are in `aos_protocol.documents`, C++ is
emitted in `aos_solver.emission`, and Python in `aos_middleware`. Nothing in here knows the bus.
"""
