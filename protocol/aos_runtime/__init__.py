"""Processes on the bus: the bus, the journal, lives and children of processes, and the side of adapters.

Not in here is what the messages say, which is in `aos_protocol`, and what any one service does with them.
"""
