"""Readers of the documents: SDL text, AOS 1.x JSON and the paper's GSDL JSON into one typed model.

`source` is a file's text with its places, `json_text` and `sdl_text` know the two syntaxes, and the
`json_*` and `sdl_*` readers give `aos_protocol.documents` structures. A reader never raises for what a user
wrote: it reports to `Findings` and reads on.
"""
