"""What is said on the bus, as pure data: keys, messages, codec, documents, diagnostics, errors.

Imports the standard library and msgspec only. Start with `messages`.
"""
