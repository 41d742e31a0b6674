"""The abilities of adapters and the middleware, in figures; see `python -m tests.adapter_numbers --help`."""
