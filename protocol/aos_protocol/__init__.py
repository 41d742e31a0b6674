"""The language of the bus as pure data: keys, messages, codec, documents, diagnostics, errors.

Imports the standard library and msgspec only. Start with `messages`. How documents are read and checked is in
`aos_language`, how messages travel in `aos_runtime`.
"""

__version__ = "0.1.0"
