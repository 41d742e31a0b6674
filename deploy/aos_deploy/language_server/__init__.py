"""The language server: the linter, the meaning of words and the outline of documents, for editors."""
