"""The API over HTTP: who may ask, the table of operations and its OpenAPI document, the page's files."""
