"""A mission: the loop of decisions, what is chosen, what ends it, and models that change while it runs.

Start with `loop`. Nothing in here knows the bus or the disk; `aos_solver.bus_ports` gives it both.
"""
