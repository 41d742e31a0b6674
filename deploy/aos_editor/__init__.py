"""Documents in an editor: the language server (findings, meanings, outline) and the TextMate grammar."""
