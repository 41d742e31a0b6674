"""Documents in an editor: the language server (findings, meanings, outline) and the TextMate grammar.

Not in here is what is right in a document: `aos_language` reads and checks it.
"""
