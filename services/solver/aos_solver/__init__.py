"""The solver: from a project to decisions.

Data flows through `emission` (documents to C++), `building` (C++ to an executable), `child` (the running
engine and its answers) and `mission` (the loop of decisions and what ends it). `offline` computes policies
before a mission, `study` explains decisions and makes them once more, `cpp` holds the engine itself. Not in
here is who carries an action out: that is the middleware.
"""
