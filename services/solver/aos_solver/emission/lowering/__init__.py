"""The lowering of documents to the model that is emitted."""
