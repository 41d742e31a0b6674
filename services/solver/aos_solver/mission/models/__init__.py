"""The models of a mission: documents that change while it runs, and how a belief gets into them."""
