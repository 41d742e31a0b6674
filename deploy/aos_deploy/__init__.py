"""Running AOS: the command line, the deploy file, the supervisor, and what a person watches.

Not in here is what a laboratory does with AOS, which is `aos_lab`, and the language server, which is
`aos_editor`.
"""
