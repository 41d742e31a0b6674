"""The bus router: who may do what, and what it refused."""
