"""What is said on the bus, as pure data: keys, messages, codec, documents, diagnostics, errors.

Imports the standard library and msgspec only. Start with `messages`.
"""

__version__ = "0.1.0"
