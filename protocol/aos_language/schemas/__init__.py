"""JSON Schemas of the JSON dialects, for editors."""
