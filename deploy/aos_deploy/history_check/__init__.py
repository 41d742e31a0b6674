"""The check of a run's history: a pure program over the rows of its journal and its ledgers.

`check` is the whole of it; `journal_rules` and `ledger_rules` go through the rows of one file. Every rule is
in `rules`, with the sentence that a history has to hold to. `replayed` has the one rule that needs an engine.
"""
