"""The control of a mission by people: who holds it, and what they want of it."""
