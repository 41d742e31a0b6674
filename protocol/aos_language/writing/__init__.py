"""Writers of the documents: the typed model as SDL or as JSON that, read again, gives the same model."""
