"""The deploy file: what it says of a robot, its documents, budgets and ends, read and checked.

Nothing is started here. A mistake is a finding with its place; all of them are told together.
"""
