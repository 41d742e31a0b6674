"""The registry: takes bundles in, keeps them in a catalogue, and publishes them.

Not in here is what a document means: `aos_language` reads and checks it.
"""
