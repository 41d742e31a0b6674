"""Reads bundles, checks them, keeps them in a catalogue and publishes them."""
