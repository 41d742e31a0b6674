"""The sandbox around compilers, engines and workers: Landlock for files, seccomp for system calls.

The guard puts a command into it (`confine`), and services ask for it (`confinement`). Modules that the guard
imports import little, as the guard itself.
"""
