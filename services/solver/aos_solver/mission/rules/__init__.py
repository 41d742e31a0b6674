"""The rules that a mission and a simulation share: endings, failures, drift."""
