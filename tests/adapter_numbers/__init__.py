"""What adapters and the middleware can do, in figures; see `python -m tests.adapter_numbers --help`."""
