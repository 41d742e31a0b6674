"""The bus: typed questions, answers, streams and presence over Zenoh, and the names that may be on it."""
